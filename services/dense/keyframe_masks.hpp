// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <set>

#include "common/msg/tracking.hpp"
#include "services/dense/core/depth_view.hpp"

namespace rtd::dense {

/// Finds the filter's masks of slam's keyframes: in real time slam names a keyframe when later frames have come.
/// Bounded: the oldest are dropped first. Thread-safe.
class KeyframeMasks {
 public:
  static constexpr std::size_t kRecent = 256;  ///< frames, about 19 kB each

  void put(std::int64_t stamp_ns, const DynamicMask& mask);
  void put(const msg::KeyframeEvent& event);
  /// Those found since the last call, by stamp.
  std::map<std::int64_t, DynamicMask> take();

 private:
  std::mutex mutex_;
  std::map<std::int64_t, DynamicMask> recent_, found_;
  std::set<std::int64_t> awaited_;  ///< keyframes whose masks have not come
};

}  // namespace rtd::dense
