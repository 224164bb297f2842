// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/host/shm_leftovers.hpp"

#include <dirent.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <map>
#include <memory>
#include <thread>

#include "common/bus/host/shm_users.hpp"

namespace rtd::bus {
namespace {

/// Fast DDS's transport and data sharing, the management segment of iceoryx (its pools bear the name of a user group).
const std::vector<std::string> kNameParts = {"fastrtps_", "fastdds_", "fast_datasharing_", "iceoryx_mgmt"};

struct Candidate {
  std::string name;
  FileId id;
  uid_t owner = 0;
  mode_t mode = 0;
  std::time_t changed = 0;
  std::uint64_t bytes = 0;
};
using Group = std::vector<Candidate>;

class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor() {
    if (number_ >= 0) close(number_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return number_; }

 private:
  int number_;
};

/// One cleaner at a time: another one's list would be out of date.
bool lock_folder(const Descriptor& folder) {
  constexpr int kAttempts = 50;
  for (int i = 0; i < kAttempts; ++i) {
    if (flock(folder.get(), LOCK_EX | LOCK_NB) == 0) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return false;
}

std::map<std::string, Group> list_groups(const Descriptor& folder, const std::string& path) {
  std::map<std::string, Group> groups;
  const std::unique_ptr<DIR, int (*)(DIR*)> entries(opendir(path.c_str()), closedir);
  if (entries == nullptr) return groups;
  while (const dirent* entry = readdir(entries.get())) {
    struct stat file {};
    if (!is_vendor_shm_name(entry->d_name)) continue;
    if (fstatat(folder.get(), entry->d_name, &file, AT_SYMLINK_NOFOLLOW) != 0 || !S_ISREG(file.st_mode)) continue;
    const std::time_t changed = std::max(file.st_mtime, file.st_ctime);
    groups[shm_group(entry->d_name)].push_back({entry->d_name,
                                                {file.st_dev, file.st_ino},
                                                file.st_uid,
                                                file.st_mode,
                                                changed,
                                                static_cast<std::uint64_t>(file.st_blocks) * 512});
  }
  return groups;
}

/// Locks are seen where processes are not: across PID namespaces.
bool is_locked(const Descriptor& folder, const Candidate& file) {
  const Descriptor opened(openat(folder.get(), file.name.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW));
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
std::string reason_to_stay(const Group& group, const ShmUsers& users, const Descriptor& folder,
                           const CleanOptions& options) {
  for (const Candidate& file : group) {
    if (users.in_use.count(file.id) > 0) return "in use";
  }
  for (const Candidate& file : group) {
    if (is_young(file, options.min_age)) return "younger than " + std::to_string(options.min_age.count()) + " s";
    if (const UnreadableProcess* process = hidden_user(file, users)) {
      return "process " + std::to_string(process->pid) + " may use it, but its files cannot be inspected";
    }
    if (is_locked(folder, file)) return "locked by a process";
  }
  return {};
}

/// Removes the file unless another one has taken its name.
std::string remove_file(const Descriptor& folder, const Candidate& file) {
  struct stat now {};
  if (fstatat(folder.get(), file.name.c_str(), &now, AT_SYMLINK_NOFOLLOW) != 0) return {};  // already removed
  if (FileId(now.st_dev, now.st_ino) != file.id) return "replaced meanwhile";
  if (unlinkat(folder.get(), file.name.c_str(), 0) == 0 || errno == ENOENT) return {};
  return errno == EPERM || errno == EACCES ? "belongs to user " + std::to_string(file.owner) : std::strerror(errno);
}

void clean_group(const Group& group, std::string reason, const Descriptor& folder, const CleanOptions& options,
                 CleanReport& report) {
  for (const Candidate& file : group) {
    std::string why = reason;
    if (why.empty() && !options.dry_run) why = remove_file(folder, file);
    (why.empty() ? report.removed : report.left).push_back({file.name, file.bytes, why});
  }
}

bool any_may_go(const std::map<std::string, Group>& groups, const CleanOptions& options) {
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

bool is_vendor_shm_name(const std::string& name) {
  return std::any_of(kNameParts.begin(), kNameParts.end(), [&](const std::string& part) {
    return name.rfind(part, 0) == 0 || name.rfind("sem." + part, 0) == 0;
  });
}

std::string shm_group(const std::string& name) {
  std::string group = name.rfind("sem.", 0) == 0 ? name.substr(4) : name;
  for (const std::string suffix : {"_mutex", "_el", "_sl"}) {
    const std::size_t at = group.size() - std::min(group.size(), suffix.size());
    if (group.compare(at, std::string::npos, suffix) == 0) return group.substr(0, at);
  }
  return group;
}

CleanReport remove_shm_leftovers(const CleanOptions& options) {
  CleanReport report;
  const Descriptor folder(open(options.shm_dir.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (folder.get() < 0 || !lock_folder(folder)) return report;
  const auto groups = list_groups(folder, options.shm_dir);
  if (groups.empty()) return report;
  const bool blind = in_first_ipc_namespace(options.proc_dir) && !in_first_pid_namespace(options.proc_dir);
  // Listed before users are looked for: a file that is made later on is not in the list.
  const ShmUsers users =
      blind || !any_may_go(groups, options) ? ShmUsers{} : find_shm_users(kNameParts, options.proc_dir);
  for (const auto& [name, group] : groups) {
    const std::string reason = blind ? "processes outside this container may use it, run 'rtd doctor --clean' there"
                                     : reason_to_stay(group, users, folder, options);
    clean_group(group, reason, folder, options, report);
  }
  return report;
}

}  // namespace rtd::bus
