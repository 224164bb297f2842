// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cerrno>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <stdexcept>
#include <string>
#include <system_error>

#include "common/io/bytes.hpp"

namespace rtd::io {

/// A sink or source failed: what() names the path and the system's reason, code() is the errno. The system's words are
/// left out where they say less than the given text, of a folder in place of a file for example.
class IoError : public std::system_error {
 public:
  IoError(int error_number, const std::string& what)
      : std::system_error(error_number, std::generic_category(), what),
        text_(speaks_for_itself(error_number) ? what : std::system_error::what()) {}
  const char* what() const noexcept override { return text_.what(); }

 private:
  static bool speaks_for_itself(int error_number) {
    return error_number == EISDIR || error_number == EWOULDBLOCK || error_number == ESPIPE ||
           error_number == EOVERFLOW || error_number == EXDEV;
  }

  std::runtime_error text_;  ///< unlike a string, copied without throwing
};

/// Where a writer puts its bytes, in order. append() is for one thread; sync() and the positions for any.
class ByteSink {
 public:
  virtual ~ByteSink() = default;
  /// Appends all parts or, when it throws IoError, nothing: the sink then still ends with a whole record.
  virtual void append(std::initializer_list<ByteView> parts) = 0;
  /// Bytes appended so far.
  virtual std::uint64_t position() const = 0;
  /// Makes everything appended before the call survive a power cut, and returns how many bytes that is: the durable
  /// watermark. May block for long; other threads may append meanwhile. Throws IoError.
  virtual std::uint64_t sync() = 0;
};

/// Keeps the bytes: tests, and small files made to be sent.
class MemorySink final : public ByteSink {
 public:
  void append(std::initializer_list<ByteView> parts) override {
    for (const ByteView part : parts) bytes_.insert(bytes_.end(), part.begin(), part.end());
  }
  std::uint64_t position() const override { return bytes_.size(); }
  std::uint64_t sync() override { return bytes_.size(); }
  const Bytes& bytes() const { return bytes_; }

 private:
  Bytes bytes_;
};

enum class IfExists { kFail, kReplace };

/// What becomes of the kernel's copy in memory of what is on disk. A recorder that drops it leaves other files in
/// memory and saves the processor the work of getting ever new pages.
enum class Cached { kKeep, kDrop };

/// A file, written with writev(2) from where the caller has the bytes: no copy of its own. It is locked (flock) while
/// open, so that a second writer fails and a reader can see that it grows (FileSource::being_written). For what grows
/// for long and may be read meanwhile: recordings, logs. Results that are whole or nothing: AtomicFile.
class FileSink final : public ByteSink {
 public:
  /// Creates the file. Throws IoError: it exists (kFail), it is a symbolic link, another process writes it, no such
  /// folder, read-only, ...
  explicit FileSink(std::filesystem::path path, IfExists if_exists = IfExists::kFail, Cached cached = Cached::kKeep);
  ~FileSink() override;  ///< closes, does not sync
  FileSink(const FileSink&) = delete;
  FileSink& operator=(const FileSink&) = delete;

  void append(std::initializer_list<ByteView> parts) override;
  std::uint64_t position() const override { return position_.load(std::memory_order_acquire); }
  std::uint64_t sync() override;
  const std::filesystem::path& path() const { return path_; }

 private:
  void sync_own_folder();

  const std::filesystem::path path_;
  const Cached cached_;
  int fd_ = -1;
  bool broken_ = false;
  std::atomic<std::uint64_t> position_{0};
  std::atomic<bool> folder_synced_{false};
};

}  // namespace rtd::io
