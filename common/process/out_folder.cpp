// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/process/out_folder.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <system_error>

#include "common/io/byte_sink.hpp"
#include "common/service/config.hpp"

namespace rtd::process {
namespace fs = std::filesystem;
namespace {

constexpr const char* kName = ".rtd.lock";

/// "process 1234" as the file says; it is empty for the moment between the lock and the number.
std::string owner(int fd) {
  std::array<char, 32> text{};
  const ssize_t read = ::pread(fd, text.data(), text.size(), 0);
  std::string number;
  for (ssize_t i = 0; i < read && text[static_cast<std::size_t>(i)] >= '0' && text[static_cast<std::size_t>(i)] <= '9';
       ++i)
    number += text[static_cast<std::size_t>(i)];
  return number.empty() ? "another process" : "process " + number;
}

}  // namespace

FolderLock::FolderLock(const fs::path& folder) {
  const fs::path path = folder / kName;
  file_.reset(::open(path.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC, 0644));
  struct stat status {};
  if (file_.get() < 0 || ::fstat(file_.get(), &status) != 0) io::fail_writing(path, errno);
  if (!S_ISREG(status.st_mode)) io::fail_writing(path, ENOTSUP);
  if (::flock(file_.get(), LOCK_EX | LOCK_NB) != 0) {
    if (errno != EWOULDBLOCK) io::fail_writing(path, errno);
    throw io::IoError(EWOULDBLOCK, folder.string() + " is in use by " + owner(file_.get()) +
                                       ": wait for its end, end it, or name another folder");
  }
  const std::string number = std::to_string(::getpid()) + '\n';
  if (::ftruncate(file_.get(), 0) != 0 || io::write_parts(file_.get(), {io::bytes_of(number)}) != 0)
    io::fail_writing(path, errno);
}

void make_out_folder(const std::string& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw service::ConfigError("--out " + folder + ": cannot be created: " + error.message());
}

FolderLock take_out_folder(const std::string& folder) {
  make_out_folder(folder);
  try {
    return FolderLock(folder);
  } catch (const io::IoError& failure) {
    throw service::ConfigError(std::string("--out ") + failure.what());
  }
}

}  // namespace rtd::process
