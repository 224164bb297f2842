// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/io/folder_walk.hpp"

#include <dirent.h>
#include <fcntl.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <memory>
#include <optional>

#include "common/io/byte_sink.hpp"
#include "common/io/byte_source.hpp"
#include "common/io/fd_writing.hpp"

namespace rtd::io {
namespace fs = std::filesystem;
namespace {

std::optional<struct stat> status_of(const Descriptor& file) {
  struct stat status {};
  if (file.get() < 0 || ::fstat(file.get(), &status) != 0) return std::nullopt;
  return status;
}

}  // namespace

const std::vector<FolderEntry>& FolderWalk::entries(const fs::path& folder) {
  const std::vector<FolderEntry>*& listed = by_name_[folder.native()];
  if (listed == nullptr) listed = &read_once(folder);
  return *listed;
}

const std::vector<FolderEntry>& FolderWalk::read_once(const fs::path& folder) {
  static const std::vector<FolderEntry> kNone;
  const Descriptor opened(open_below(folder, below_, O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  const auto status = status_of(opened);
  if (!status) return kNone;
  const auto [known, is_new] = folders_.try_emplace({status->st_dev, status->st_ino});
  if (is_new) known->second = read(folder, opened.get());
  return known->second;
}

std::vector<fs::path> FolderWalk::paths(const fs::path& folder) {
  std::vector<fs::path> paths;
  for (const FolderEntry& entry : entries(folder)) paths.push_back(folder / entry.name);
  return paths;
}

bool FolderWalk::enter(const fs::path& folder) {
  const auto status = status_of(Descriptor(open_below(folder, below_, O_PATH | O_DIRECTORY | O_CLOEXEC)));
  return status && entered_.emplace(status->st_dev, status->st_ino).second;
}

std::vector<FolderEntry> FolderWalk::read(const fs::path& folder, int fd) {
  std::vector<FolderEntry> found;
  const std::unique_ptr<DIR, int (*)(DIR*)> listing(::fdopendir(::fcntl(fd, F_DUPFD_CLOEXEC, 0)), ::closedir);
  while (const dirent* entry = listing ? ::readdir(listing.get()) : nullptr) {
    const std::string name = static_cast<const char*>(entry->d_name);
    if (name == "." || name == "..") continue;
    if (++seen_ > most_entries_)
      throw IoError(EOVERFLOW, folder.string() + ": more than " + std::to_string(most_entries_) +
                                   " files and folders were looked at: name the folder of the data itself");
    const bool unclear = entry->d_type == DT_LNK || entry->d_type == DT_UNKNOWN;
    found.push_back({name, unclear ? leads_to_folder(folder / name) : entry->d_type == DT_DIR});
  }
  std::ranges::sort(found, {}, &FolderEntry::name);
  return found;
}

bool FolderWalk::leads_to_folder(const fs::path& link) {
  const Descriptor target(open_below(link, below_, O_PATH | O_CLOEXEC));
  if (target.get() < 0 && errno == EXDEV && led_out_.empty()) led_out_ = link;
  const auto status = status_of(target);
  return status && S_ISDIR(status->st_mode);
}

}  // namespace rtd::io
