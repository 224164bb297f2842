// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/core/skip_log.hpp"

namespace rtd::camera {

void SkipLog::add(SkippedInput input) {
  ++counters_.skipped[static_cast<std::size_t>(input.reason)];
  skipped_.push_back(std::move(input));
}

std::string SkipLog::summary() const {
  if (skipped_.empty()) return {};
  std::string text = ":";
  for (std::size_t i = 0; i < kSkipReasons; ++i) {
    if (counters_.skipped[i] == 0) continue;
    text += ' ' + std::to_string(counters_.skipped[i]) + " x " + to_string(static_cast<SkipReason>(i)) + ',';
  }
  return text + " first: " + skipped_.front().detail;
}

}  // namespace rtd::camera
