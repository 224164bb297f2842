// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/io/input_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

#include "common/io/byte_sink.hpp"
#include "common/io/fd_writing.hpp"

namespace rtd::io {
namespace fs = std::filesystem;
namespace {

constexpr std::uint64_t kPageBytes = 4096;

/// A name of a descriptor that this process was started with: whoever started it has chosen what is behind it.
bool was_handed_over(const fs::path& path) {
  return path == "/dev/stdin" || path.parent_path() == "/dev/fd" || path.parent_path() == "/proc/self/fd";
}

std::string size_text(std::uint64_t bytes) {
  return bytes < 1000 * kMegabyte ? std::to_string(bytes / kMegabyte) + " MB"
                                  : std::to_string(bytes / (1000 * kMegabyte)) + " GB";
}

[[noreturn]] void fail_too_large(const fs::path& path, const std::string& size, const ReadAs& as) {
  throw IoError(EOVERFLOW, path.string() + ": has " + size + ", at most " + size_text(as.most_bytes) + " are read as " +
                               as.what + ": check that it is the right file");
}

/// To the end, also of what the kernel makes up and says has 0 bytes.
std::string read_to_end(int fd, std::uint64_t expected_bytes, const fs::path& path, const ReadAs& as) {
  std::string content(std::max(expected_bytes, kPageBytes) + 1, '\0');  // one more: the end is seen at once
  std::size_t filled = 0;
  while (const ssize_t n = ::read(fd, content.data() + filled, content.size() - filled)) {
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) throw IoError(errno, path.string() + " cannot be read");
    filled += static_cast<std::size_t>(n);
    if (filled > as.most_bytes) fail_too_large(path, "more than that", as);
    if (filled == content.size()) content.resize(2 * filled);
  }
  content.resize(filled);
  return content;
}

}  // namespace

std::string read_file(const fs::path& path, const ReadAs& as, const fs::path& below) {
  if (below.empty() && was_handed_over(path)) {
    const Descriptor given(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOCTTY));
    if (given.get() < 0) throw IoError(errno, path.string() + " cannot be read");
    return read_to_end(given.get(), 0, path, as);
  }
  const Descriptor file(open_regular(path, Links::kFollow, below));
  const std::uint64_t bytes = size_of(file.get());
  if (bytes > as.most_bytes) fail_too_large(path, size_text(bytes), as);
  return read_to_end(file.get(), bytes, path, as);
}

std::optional<std::string> try_read_file(const fs::path& path, const ReadAs& as) {
  try {
    return read_file(path, as);
  } catch (const IoError&) {
    return std::nullopt;
  }
}

std::unique_ptr<std::istream> try_open(const fs::path& path) {
  try {
    return std::make_unique<InputStream>(path);
  } catch (const IoError&) {
    return nullptr;
  }
}

}  // namespace rtd::io
