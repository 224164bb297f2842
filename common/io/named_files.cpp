// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/io/named_files.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

#include "common/io/fd_writing.hpp"

namespace rtd::io {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kLongest = 100;

bool is_plain(char c) {  // in any locale
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_' || c == '.';
}

bool is_name(std::string_view name) {
  return !name.empty() && name.size() <= kLongest && name.front() != '.' && name.front() != '-' &&
         std::ranges::all_of(name, is_plain);
}

}  // namespace

Found look_at(const fs::path& path, std::string_view magic) {
  // Relative to its folder: links on the operator's way to the folder are the operator's own.
  const Descriptor folder(::open(folder_of(path).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (folder.get() < 0) return errno == ENOENT ? Found::kNothing : Found::kOther;
  const std::string name = path.filename().string();
  const Descriptor file(::openat(folder.get(), name.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
  if (file.get() < 0) return errno == ENOENT ? Found::kNothing : Found::kOther;
  struct stat status {};
  if (::fstat(file.get(), &status) != 0 || !S_ISREG(status.st_mode)) return Found::kOther;
  if (status.st_size == 0) return Found::kEmpty;
  std::string head(magic.size(), '\0');
  const ssize_t read = ::pread(file.get(), head.data(), head.size(), 0);
  return read == static_cast<ssize_t>(magic.size()) && head == magic ? Found::kOfThisKind : Found::kOther;
}

fs::path NamedFiles::path(const std::string& name) const {
  const std::string what(kind_.what), extension(kind_.extension), option(kind_.option);
  if (folder_.empty())
    throw NameError("there is no folder for a named " + what + ": start this service with " + option + " FOLDER");
  const std::string full = name.ends_with(extension) ? name : name + extension;
  if (!is_name(full))
    throw NameError("this is not a name of a " + what + ": give a name, not a path: letters, digits, '-', '_' and " +
                    "'.', at most 100; the folder is that of " + option);
  return folder_ / full;
}

fs::path NamedFiles::to_write(const std::string& name) const {
  fs::path file = path(name);
  if (look_at(file, kind_.magic) == Found::kOther)
    throw NameError(file.filename().string() + " exists and is not a " + std::string(kind_.what) +
                    ", so it is not replaced: give another name");
  return file;
}

fs::path NamedFiles::to_read(const std::string& name) const {
  fs::path file = path(name);
  if (look_at(file, kind_.magic) != Found::kOfThisKind)
    throw NameError("there is no readable " + std::string(kind_.what) + " " + file.filename().string() +
                    " in the folder of " + std::string(kind_.option));
  return file;
}

}  // namespace rtd::io
