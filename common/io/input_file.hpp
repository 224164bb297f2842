// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ext/stdio_filebuf.h>

#include <cstdint>
#include <filesystem>
#include <istream>
#include <memory>
#include <optional>
#include <string>

#include "common/io/byte_source.hpp"

/// The one way in which files from outside are opened: regular files only, without waiting for a pipe, and no more of
/// one than its kind may have. Folders below which a file must lie are those of byte_source.hpp.
namespace rtd::io {

/// What a file is read as: its name in messages, and the bytes that one has at most.
struct ReadAs {
  const char* what;
  std::uint64_t most_bytes;
};

inline constexpr std::uint64_t kMegabyte = 1'000'000;
inline constexpr ReadAs kFrameList{"a list of frames", 32 * kMegabyte};
inline constexpr ReadAs kImage{"an image", 128 * kMegabyte};
inline constexpr ReadAs kCalibration{"a calibration", 16 * kMegabyte};
inline constexpr ReadAs kPoses{"a list of poses", 256 * kMegabyte};
inline constexpr ReadAs kSettings{"settings", 4 * kMegabyte};
inline constexpr ReadAs kKeys{"keys", kMegabyte};
inline constexpr ReadAs kLabels{"labels", 4 * kMegabyte};
inline constexpr ReadAs kNetwork{"a network", 1000 * kMegabyte};
inline constexpr ReadAs kResults{"results of a run", 256 * kMegabyte};
inline constexpr ReadAs kKernelText{"text of the kernel", kMegabyte};

/// The whole content of a regular file. A descriptor that the user has handed over, /dev/stdin or /dev/fd/N as the
/// shell's <(...) names it, may be a pipe. Throws IoError (byte_sink.hpp) naming path, cause and fix: not there, not a
/// regular file, more than `as` allows, or leading out of `below`.
std::string read_file(const std::filesystem::path& path, const ReadAs& as, const std::filesystem::path& below = {});

/// The same; empty where it throws.
std::optional<std::string> try_read_file(const std::filesystem::path& path, const ReadAs& as);

/// A regular file of any size, as a stream that can seek. Throws IoError as above. Its lines may have
/// no end: io::get_line(). For one thread.
class InputStream final : public std::istream {
 public:
  explicit InputStream(const std::filesystem::path& path)
      : std::istream(nullptr), buffer_(open_regular(path), std::ios::in | std::ios::binary) {
    rdbuf(&buffer_);
  }

 private:
  __gnu_cxx::stdio_filebuf<char> buffer_;  // closes the file
};

/// The same; null where it throws.
std::unique_ptr<std::istream> try_open(const std::filesystem::path& path);

}  // namespace rtd::io
