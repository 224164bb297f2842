// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

namespace rtd::io {

/// What a folder holds under a name, links followed. What is no folder may be anything, and not there.
struct FolderEntry {
  std::string name;
  bool is_folder = false;
};

/// Looks through folders that others made. It reads each folder once, whatever names lead to it, follows no link out of
/// the folder in which it stays, and gives up, with a message, before it has seen more than a data set has. For one
/// thread.
class FolderWalk {
 public:
  static constexpr std::uint64_t kMostEntries = 1'000'000;

  /// `below`: the folder that it does not leave; empty: it may.
  explicit FolderWalk(std::filesystem::path below = {}, std::uint64_t most_entries = kMostEntries)
      : below_(std::move(below)), most_entries_(most_entries) {}

  /// What is in a folder, by name; nothing where it cannot be read. The reference stays valid. Throws IoError
  /// (byte_sink.hpp): too many entries in all.
  const std::vector<FolderEntry>& entries(const std::filesystem::path& folder);
  /// Files and what else is in a folder, as paths, by name. Throws as above.
  std::vector<std::filesystem::path> paths(const std::filesystem::path& folder);
  /// For who looks into all folders below one: false where there is no folder, or it was entered before under any name.
  bool enter(const std::filesystem::path& folder);
  /// The first link that was not followed because it leads out; empty: none.
  const std::filesystem::path& led_out() const { return led_out_; }
  std::uint64_t seen() const { return seen_; }

 private:
  using Id = std::pair<std::uint64_t, std::uint64_t>;  ///< device and inode

  const std::vector<FolderEntry>& read_once(const std::filesystem::path& folder);
  std::vector<FolderEntry> read(const std::filesystem::path& folder, int fd);
  bool leads_to_folder(const std::filesystem::path& link);

  const std::filesystem::path below_;
  const std::uint64_t most_entries_;
  std::uint64_t seen_ = 0;
  std::filesystem::path led_out_;
  std::map<Id, std::vector<FolderEntry>> folders_;
  std::unordered_map<std::string, const std::vector<FolderEntry>*> by_name_;
  std::set<Id> entered_;
};

}  // namespace rtd::io
