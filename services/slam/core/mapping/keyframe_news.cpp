// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/mapping/keyframe_news.hpp"

#include <iterator>

namespace rtd::slam {

void KeyframeNews::add(const std::vector<KeyframeChange>& changes) {
  for (const KeyframeChange& change : changes) {
    if (change.kind == KeyframeChange::Kind::kCorrected) {
      corrected_[change.id] = change;
    } else {
      corrected_.erase(change.id);
      told_in_order_.push_back(change);
    }
  }
}

std::vector<KeyframeChange> KeyframeNews::take(std::size_t count) {
  std::vector<KeyframeChange> news;
  while (news.size() < count && !told_in_order_.empty()) {
    news.push_back(told_in_order_.front());
    told_in_order_.pop_front();
  }
  while (news.size() < count && !corrected_.empty()) {
    const auto newest = std::prev(corrected_.end());
    news.push_back(newest->second);
    corrected_.erase(newest);
  }
  return news;
}

}  // namespace rtd::slam
