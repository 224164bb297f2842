// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/corrections.hpp"

#include <iterator>

namespace rtd::slam {

void KeyframeChangeQueue::add(const std::vector<KeyframeChange>& changes) {
  for (const KeyframeChange& change : changes) {
    if (change.kind == KeyframeChange::Kind::kCorrected) {
      corrected_[change.id] = change;
    } else {
      corrected_.erase(change.id);
      in_order_.push_back(change);
    }
  }
}

std::vector<KeyframeChange> KeyframeChangeQueue::take(std::size_t count) {
  std::vector<KeyframeChange> changes;
  while (changes.size() < count && !in_order_.empty()) {
    changes.push_back(in_order_.front());
    in_order_.pop_front();
  }
  while (changes.size() < count && !corrected_.empty()) {
    const auto newest = std::prev(corrected_.end());
    changes.push_back(newest->second);
    corrected_.erase(newest);
  }
  return changes;
}

}  // namespace rtd::slam
