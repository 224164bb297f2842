// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/host/shm_users.hpp"

#include <dirent.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <string_view>

namespace rtd::bus {
namespace {

using NameParts = std::vector<std::string>;

bool has_one_of(std::string_view text, const NameParts& parts) {
  return std::any_of(parts.begin(), parts.end(),
                     [&](const std::string& part) { return text.find(part) != std::string_view::npos; });
}

/// Names in a folder without `.` and `..`; errno says why there are none.
std::vector<std::string> list_folder(const std::string& path) {
  std::vector<std::string> names;
  const std::unique_ptr<DIR, int (*)(DIR*)> folder(opendir(path.c_str()), closedir);
  if (folder == nullptr) return names;
  errno = 0;
  while (const dirent* entry = readdir(folder.get())) {
    if (entry->d_name[0] != '.') names.emplace_back(entry->d_name);
  }
  return names;
}

bool is_number(const std::string& text) {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
}

/// False: not permitted.
bool add_open_files(const std::string& process, const NameParts& parts, std::set<FileId>& files) {
  errno = 0;
  const std::vector<std::string> descriptors = list_folder(process + "/fd");
  if (descriptors.empty() && errno == EACCES) return false;
  for (const std::string& descriptor : descriptors) {
    const std::string path = process + "/fd/" + descriptor;
    char target[4096];
    const ssize_t length = readlink(path.c_str(), target, sizeof(target));
    if (length <= 0 || !has_one_of({target, static_cast<std::size_t>(length)}, parts)) continue;
    struct stat file {};
    if (stat(path.c_str(), &file) == 0) files.emplace(file.st_dev, file.st_ino);
  }
  return true;
}

/// False: not permitted. A line: "address perms offset major:minor inode path".
bool add_mapped_files(const std::string& process, const NameParts& parts, std::set<FileId>& files) {
  const std::unique_ptr<FILE, int (*)(FILE*)> maps(fopen((process + "/maps").c_str(), "re"), fclose);
  if (maps == nullptr) return errno != EACCES && errno != EPERM;
  char* line = nullptr;
  std::size_t capacity = 0;
  while (getline(&line, &capacity, maps.get()) > 0) {
    if (!has_one_of(line, parts)) continue;
    unsigned device_major = 0, device_minor = 0;
    unsigned long long inode = 0;
    if (std::sscanf(line, "%*s %*s %*s %x:%x %llu", &device_major, &device_minor, &inode) == 3) {
      files.emplace(makedev(device_major, device_minor), inode);
    }
  }
  std::free(line);
  return true;
}

/// The value of "Key:\tvalue" in /proc/PID/status.
long status_value(const std::string& process, const std::string& key) {
  std::ifstream status(process + "/status");
  std::string token;
  long value = 0;
  while (status >> token) {
    if (token == key) return status >> value ? value : 0;
  }
  return 0;
}

bool has_inode(const std::string& path, ino_t inode) {
  struct stat file {};
  return stat(path.c_str(), &file) == 0 && file.st_ino == inode;
}

}  // namespace

// The kernel's fixed inodes: include/linux/proc_ns.h.
bool in_first_pid_namespace(const std::string& proc_dir) {
  return has_inode(proc_dir + "/self/ns/pid", 0xEFFFFFFCU);
}

bool in_first_ipc_namespace(const std::string& proc_dir) {
  return has_inode(proc_dir + "/self/ns/ipc", 0xEFFFFFFFU);
}

ShmUsers find_shm_users(const std::vector<std::string>& name_parts, const std::string& proc_dir) {
  ShmUsers users;
  for (const std::string& name : list_folder(proc_dir)) {
    if (!is_number(name)) continue;
    const std::string process = proc_dir + '/' + name;
    const bool open_known = add_open_files(process, name_parts, users.in_use);
    const bool maps_known = add_mapped_files(process, name_parts, users.in_use);
    if (open_known && maps_known) continue;
    if (name == "1" && in_first_pid_namespace(proc_dir)) continue;
    if (status_value(process, "Threads:") > 1) {
      users.unreadable.push_back(
          {static_cast<pid_t>(std::atoi(name.c_str())), static_cast<uid_t>(status_value(process, "Uid:"))});
    }
  }
  return users;
}

}  // namespace rtd::bus
