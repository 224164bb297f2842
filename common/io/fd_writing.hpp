// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <unistd.h>

#include <filesystem>
#include <initializer_list>

#include "common/io/bytes.hpp"

/// Descriptors, and what the sinks of this folder share.
namespace rtd::io {

/// Closes a descriptor at its end.
class Descriptor {
 public:
  explicit Descriptor(int fd = -1) : fd_(fd) {}
  ~Descriptor() { reset(); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return fd_; }
  void reset(int fd = -1) {
    if (fd_ >= 0) ::close(fd_);
    fd_ = fd;
  }

 private:
  int fd_;
};

/// Throws IoError: "PATH: cause and fix" of an errno.
[[noreturn]] void fail_writing(const std::filesystem::path& path, int error_number);

/// Writes all parts, at most 16, to a descriptor. Returns 0 or the errno.
int write_parts(int fd, std::initializer_list<ByteView> parts);

/// Bytes of all parts.
std::uint64_t size_of(std::initializer_list<ByteView> parts);

/// The folder of a file; "." for a bare name.
std::filesystem::path folder_of(const std::filesystem::path& path);

/// Opens the folder of a file, to make, rename and sync files in it. Throws IoError naming the file.
int open_folder_of(const std::filesystem::path& path);

/// The name of a new file lives in its folder, which fdatasync(2) of the file does not cover. Throws IoError.
void sync_folder(int folder_fd, const std::filesystem::path& folder);

}  // namespace rtd::io
