// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <deque>
#include <map>
#include <vector>

#include "services/slam/core/mapping/mapper.hpp"

namespace rtd::slam {

/// Keyframe changes that wait to be told. A closed loop moves thousands of keyframes at once: they are told in portions
/// that no reader's history overflows from, newest keyframes first, and a keyframe that moves again meanwhile is told
/// once, where it stands then. New and removed keyframes never wait behind corrections.
class KeyframeNews {
 public:
  void add(const std::vector<KeyframeChange>& changes);
  std::vector<KeyframeChange> take(std::size_t count);
  bool empty() const { return told_in_order_.empty() && corrected_.empty(); }

 private:
  std::deque<KeyframeChange> told_in_order_;  ///< created and removed
  std::map<KeyframeId, KeyframeChange> corrected_;
};

}  // namespace rtd::slam
