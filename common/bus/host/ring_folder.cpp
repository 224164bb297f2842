// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/host/ring_folder.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>

namespace rtd::bus {
namespace {

std::string folder_of_user() {
  return std::string(kShmFolder) + '/' + kRingsPrefix + std::to_string(geteuid());
}

}  // namespace

std::string ring_folder(const std::string& asked) {
  const std::string path = asked.empty() ? folder_of_user() : asked;
  mkdir(path.c_str(), S_IRWXU);
  const io::Descriptor folder(open(path.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
  struct stat status {};
  const bool ours = fstat(folder.get(), &status) == 0 && status.st_uid == geteuid();
  if (!ours || (status.st_mode & (S_IRWXG | S_IRWXO)) != 0) return {};
  futimens(folder.get(), nullptr);  // in use: an empty one that is old is removed as a leftover
  return path;
}

RingsOfRun::RingsOfRun() {
  std::string name = folder_of_user() + "_XXXXXX";
  if (mkdtemp(name.data()) == nullptr) return;
  folder_ = name;
  setenv(kRingsVariable, folder_.c_str(), 1);
}

RingsOfRun::~RingsOfRun() {
  if (folder_.empty()) return;
  unsetenv(kRingsVariable);
  std::error_code left;  // to be removed as a leftover
  std::filesystem::remove_all(folder_, left);
}

}  // namespace rtd::bus
