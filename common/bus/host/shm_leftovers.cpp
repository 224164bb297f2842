// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/host/shm_leftovers.hpp"

#include <dirent.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <fstream>
#include <map>
#include <memory>
#include <set>
#include <string_view>
#include <utility>

#include "common/bus/host/ring_folder.hpp"
#include "common/bus/host/shm_names.hpp"

namespace rtd::bus {
namespace {

/// A file, whatever its name is now: device and inode.
using FileId = std::pair<std::uint64_t, std::uint64_t>;

/// A process whose files may not be seen, and which has the threads that a DDS process has.
struct UnreadableProcess {
  pid_t pid = 0;
  uid_t user = 0;
};

/// Who uses the files of shared memory on this host.
struct ShmUsers {
  std::set<FileId> in_use;                    ///< mapped or open
  std::vector<UnreadableProcess> unreadable;  ///< what these use is not known
};

using Folder = std::shared_ptr<const io::Descriptor>;

struct Candidate {
  Folder folder;
  std::string name;   ///< in the folder
  std::string shown;  ///< in the folder of shared memory
  FileId id;
  uid_t owner = 0;
  mode_t mode = 0;
  std::time_t changed = 0;
  std::uint64_t bytes = 0;
};
using Group = std::vector<Candidate>;
using Groups = std::map<std::string, Group>;

bool has_vendor_name(std::string_view text) {
  return std::ranges::any_of(kShmNames,
                             [&](std::string_view part) { return text.find(part) != std::string_view::npos; });
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
bool add_open_files(const std::string& process, std::set<FileId>& files) {
  errno = 0;
  const std::vector<std::string> descriptors = list_folder(process + "/fd");
  if (descriptors.empty() && errno == EACCES) return false;
  for (const std::string& descriptor : descriptors) {
    const std::string path = process + "/fd/" + descriptor;
    char target[4096];
    const ssize_t length = readlink(path.c_str(), target, sizeof(target));
    if (length <= 0 || !has_vendor_name({target, static_cast<std::size_t>(length)})) continue;
    struct stat file {};
    if (stat(path.c_str(), &file) == 0) files.emplace(file.st_dev, file.st_ino);
  }
  return true;
}

/// False: not permitted. A line: "address perms offset major:minor inode path".
bool add_mapped_files(const std::string& process, std::set<FileId>& files) {
  const std::unique_ptr<FILE, int (*)(FILE*)> maps(fopen((process + "/maps").c_str(), "re"), fclose);
  if (maps == nullptr) return errno != EACCES && errno != EPERM;
  char* line = nullptr;
  std::size_t capacity = 0;
  while (getline(&line, &capacity, maps.get()) > 0) {
    if (!has_vendor_name(line)) continue;
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

/// The namespaces of the host itself; a container has others. The kernel's fixed inodes: include/linux/proc_ns.h.
bool in_first_pid_namespace(const std::string& proc_dir) {
  return has_inode(proc_dir + "/self/ns/pid", 0xEFFFFFFCU);
}

bool in_first_ipc_namespace(const std::string& proc_dir) {
  return has_inode(proc_dir + "/self/ns/ipc", 0xEFFFFFFFU);
}

/// Looks in all processes for the vendors' files that they map or hold open. A file that was listed before the call and
/// whose maker lives is found: descriptors are read before maps, and a maker maps the file before it closes the
/// descriptor. About 5 ms for 100 processes. The init of the host never counts as a user, even where it may not be
/// read.
ShmUsers find_shm_users(const std::string& proc_dir) {
  ShmUsers users;
  for (const std::string& name : list_folder(proc_dir)) {
    if (!is_number(name)) continue;
    const std::string process = proc_dir + '/' + name;
    const bool open_known = add_open_files(process, users.in_use);
    const bool maps_known = add_mapped_files(process, users.in_use);
    if (open_known && maps_known) continue;
    if (name == "1" && in_first_pid_namespace(proc_dir)) continue;
    if (status_value(process, "Threads:") > 1) {
      users.unreadable.push_back(
          {static_cast<pid_t>(std::atoi(name.c_str())), static_cast<uid_t>(status_value(process, "Uid:"))});
    }
  }
  return users;
}

/// Whether a file has a name that our vendors give.
bool is_vendor_shm_name(std::string_view name) {
  if (name.starts_with(kSemaphore)) name.remove_prefix(kSemaphore.size());
  return std::ranges::any_of(kShmNames, [&](std::string_view part) { return name.starts_with(part); });
}

/// What belongs together: the lock and semaphore of a port or segment have its name with a prefix or suffix.
std::string shm_group(const std::string& name) {
  const std::string group = name.starts_with(kSemaphore) ? name.substr(kSemaphore.size()) : name;
  for (const std::string_view suffix : {kMakingLock, kPortLock, kSegmentLock})
    if (group.ends_with(suffix)) return group.substr(0, group.size() - suffix.size());
  return group;
}

/// A folder in another, which is not a link elsewhere; a bad descriptor when it may not be read.
Folder open_folder(int parent, const std::string& name) {
  return std::make_shared<io::Descriptor>(
      openat(parent, name.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
}

/// Those of the folder, and of the folders of rings in it. `within`: its name and '/'.
void add_groups(const Folder& folder, const std::string& within, Groups& groups) {
  for (const std::string& name : list_folder("/proc/self/fd/" + std::to_string(folder->get()))) {
    if (within.empty() && name.starts_with(kRingsPrefix)) {
      add_groups(open_folder(folder->get(), name), name + '/', groups);
      continue;
    }
    struct stat file {};
    if (!is_vendor_shm_name(name)) continue;
    if (fstatat(folder->get(), name.c_str(), &file, AT_SYMLINK_NOFOLLOW) != 0 || !S_ISREG(file.st_mode)) continue;
    const std::time_t changed = std::max(file.st_mtime, file.st_ctime);
    const auto bytes = static_cast<std::uint64_t>(file.st_blocks) * 512;
    groups[within + shm_group(name)].push_back(
        {folder, name, within + name, {file.st_dev, file.st_ino}, file.st_uid, file.st_mode, changed, bytes});
  }
}

/// Those that runs have left.
void remove_empty_ring_folders(const Folder& folder, const CleanOptions& options) {
  for (const std::string& name : list_folder(options.shm_dir)) {
    struct stat status {};
    if (!name.starts_with(kRingsPrefix) || fstat(open_folder(folder->get(), name)->get(), &status) != 0) continue;
    if (std::time(nullptr) - status.st_mtime >= options.min_age.count())
      unlinkat(folder->get(), name.c_str(), AT_REMOVEDIR);
  }
}

/// Locks are seen where processes are not: across PID namespaces.
bool is_locked(const Candidate& file) {
  const io::Descriptor opened(openat(file.folder->get(), file.name.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW));
  return opened.get() >= 0 && flock(opened.get(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
}

bool is_young(const Candidate& file, std::chrono::seconds min_age) {
  return std::time(nullptr) - file.changed < min_age.count();
}

/// A process that may have made the file or can use it, but cannot be inspected.
const UnreadableProcess* hidden_user(const Candidate& file, const ShmUsers& users) {
  const bool open_to_all = (file.mode & S_IWOTH) != 0;
  for (const UnreadableProcess& process : users.unreadable) {
    if (process.user == file.owner || open_to_all) return &process;
  }
  return nullptr;
}

/// Why a group must stay; empty: no process needs it.
std::string reason_to_stay(const Group& group, const ShmUsers& users, const CleanOptions& options) {
  for (const Candidate& file : group) {
    if (users.in_use.count(file.id) > 0) return "in use";
  }
  for (const Candidate& file : group) {
    if (is_young(file, options.min_age)) return "younger than " + std::to_string(options.min_age.count()) + " s";
    if (const UnreadableProcess* process = hidden_user(file, users)) {
      return "process " + std::to_string(process->pid) + " may use it, but its files cannot be inspected";
    }
    if (is_locked(file)) return "locked by a process";
  }
  return {};
}

/// Removes the file unless another one has taken its name.
std::string remove_file(const Candidate& file) {
  struct stat now {};
  if (fstatat(file.folder->get(), file.name.c_str(), &now, AT_SYMLINK_NOFOLLOW) != 0) return {};  // already removed
  if (FileId(now.st_dev, now.st_ino) != file.id) return "replaced meanwhile";
  if (unlinkat(file.folder->get(), file.name.c_str(), 0) == 0 || errno == ENOENT) return {};
  return errno == EPERM || errno == EACCES ? "belongs to user " + std::to_string(file.owner) : std::strerror(errno);
}

void clean_group(const Group& group, const std::string& reason, const CleanOptions& options, CleanReport& report) {
  for (const Candidate& file : group) {
    std::string why = reason;
    if (why.empty() && !options.dry_run) why = remove_file(file);
    (why.empty() ? report.removed : report.left).push_back({file.shown, file.bytes, why});
  }
}

bool any_may_go(const Groups& groups, const CleanOptions& options) {
  return std::any_of(groups.begin(), groups.end(), [&](const auto& entry) {
    return std::none_of(entry.second.begin(), entry.second.end(),
                        [&](const Candidate& file) { return is_young(file, options.min_age); });
  });
}

}  // namespace

std::uint64_t CleanReport::removed_bytes() const {
  std::uint64_t bytes = 0;
  for (const ShmFile& file : removed) bytes += file.bytes;
  return bytes;
}

CleanReport remove_shm_leftovers(const CleanOptions& options) {
  CleanReport report;
  const ShmFolder locked(options.shm_dir, std::chrono::milliseconds(100));
  if (!locked.locked()) return report;  // another one's list would be out of date
  const Folder folder(Folder(), &locked.descriptor());
  Groups groups;
  add_groups(folder, "", groups);
  const bool blind = in_first_ipc_namespace(options.proc_dir) && !in_first_pid_namespace(options.proc_dir);
  // Listed before users are looked for: a file that is made later on is not in the list.
  const ShmUsers users = blind || !any_may_go(groups, options) ? ShmUsers{} : find_shm_users(options.proc_dir);
  for (const auto& [name, group] : groups) {
    const std::string reason = blind ? "processes outside this container may use it, run 'rtd doctor --clean' there"
                                     : reason_to_stay(group, users, options);
    clean_group(group, reason, options, report);
  }
  if (!blind && !options.dry_run) remove_empty_ring_folders(folder, options);
  return report;
}

}  // namespace rtd::bus
