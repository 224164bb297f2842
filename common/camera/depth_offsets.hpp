// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

namespace rtd::camera {

/// How far the stamps of depth and colour lie apart in the newest frames.
class DepthOffsets {
 public:
  static constexpr std::size_t kNewest = 301;

  void add(std::int64_t depth_after_color_ns) {
    offsets_ns_.push_back(depth_after_color_ns);
    if (offsets_ns_.size() > kNewest) offsets_ns_.pop_front();
  }
  std::size_t size() const { return offsets_ns_.size(); }
  /// Depth minus colour, ms; empty without frames.
  std::optional<double> median_ms() const {
    if (offsets_ns_.empty()) return std::nullopt;
    std::vector<std::int64_t> sorted(offsets_ns_.begin(), offsets_ns_.end());
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::ranges::nth_element(sorted, middle);
    return static_cast<double>(*middle) * 1e-6;
  }

 private:
  std::deque<std::int64_t> offsets_ns_;
};

}  // namespace rtd::camera
