// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <unordered_map>

namespace rtd::viewer {

/// Keys in the order of their last change. Any number of followers each keep the revision up to which they know all,
/// and continue from there; a key that changed several times meanwhile comes once.
template <class Key>
class ChangeLog {
 public:
  void touch(const Key& key) {
    const auto [place, added] = revisions_.try_emplace(key, newest_ + 1);
    if (!added) keys_.erase(place->second);
    place->second = ++newest_;
    keys_.emplace(newest_, key);
  }
  void clear() {
    keys_.clear();
    revisions_.clear();
  }
  /// Calls visit(key, revision) for each key that changed after `revision`, oldest change first, until it says false.
  void after(std::uint64_t revision, auto visit) const {
    for (auto entry = keys_.upper_bound(revision); entry != keys_.end(); ++entry)
      if (!visit(entry->second, entry->first)) return;
  }
  std::uint64_t newest() const { return newest_; }

 private:
  std::map<std::uint64_t, Key> keys_;
  std::unordered_map<Key, std::uint64_t> revisions_;
  std::uint64_t newest_ = 0;
};

}  // namespace rtd::viewer
