// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "common/io/bytes.hpp"

namespace rtd::io {

/// Where a reader gets its bytes. Const members may be called from several threads.
class ByteSource {
 public:
  virtual ~ByteSource() = default;
  virtual std::uint64_t size() const = 0;
  /// Fills `into` from `offset`; fewer bytes than asked only at the end or where the disk cannot be read.
  virtual std::size_t read(std::uint64_t offset, std::span<std::byte> into) const = 0;
};

/// Bytes that the caller keeps alive.
class MemorySource final : public ByteSource {
 public:
  explicit MemorySource(ByteView bytes) : bytes_(bytes) {}
  std::uint64_t size() const override { return bytes_.size(); }
  std::size_t read(std::uint64_t offset, std::span<std::byte> into) const override;

 private:
  ByteView bytes_;
};

/// Whether a symbolic link in place of a file is followed. Not where the name came over the network.
enum class Links { kFollow, kRefuse };

/// Opens a regular file for reading, without waiting for a pipe, and returns its descriptor. `below`: a folder that the
/// path may not leave, neither by ".." or as an absolute path nor by links; empty: it may. Throws IoError
/// (byte_sink.hpp) with path, cause and fix; what leads out gives EXDEV and one text, whether or not a file is there.
int open_regular(const std::filesystem::path& path, Links links = Links::kFollow,
                 const std::filesystem::path& below = {});

/// The same for anything that a path may name; `flags` of open(2) are added. Returns -1 and sets errno where it fails.
int open_below(const std::filesystem::path& path, const std::filesystem::path& below, int flags);

/// Bytes of an open file. Throws IoError.
std::uint64_t size_of(int fd);

/// A file, read with pread(2): a file that is cut while it is read gives short reads, where a mapping would give
/// SIGBUS. Its size is that at the time of opening.
class FileSource final : public ByteSource {
 public:
  /// Opens it as open_regular() does. Throws IoError.
  explicit FileSource(const std::filesystem::path& path, Links links = Links::kFollow,
                      const std::filesystem::path& below = {});
  ~FileSource() override;
  FileSource(const FileSource&) = delete;
  FileSource& operator=(const FileSource&) = delete;

  std::uint64_t size() const override { return size_; }
  std::size_t read(std::uint64_t offset, std::span<std::byte> into) const override;
  /// True while a FileSink of any process has it open: more may come.
  bool being_written() const;

 private:
  int fd_ = -1;
  std::uint64_t size_ = 0;
};

}  // namespace rtd::io
