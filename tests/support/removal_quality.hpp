// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <opencv2/core.hpp>
#include <vector>

#include "common/msg/features.hpp"

namespace rtd::test_support {

/// How well moving features were told from static ones where the moving pixels are known. A feature counts as removed
/// rightly on the mask grown by 3 px, as kept wrongly on the mask itself.
struct RemovalQuality {
  std::size_t removed_rightly = 0, removed_wrongly = 0, kept_wrongly = 0, kept_rightly = 0;

  double precision() const { return ratio(removed_rightly, removed_wrongly); }
  double recall() const { return ratio(removed_rightly, kept_wrongly); }
  /// Adds the features of one frame. `moving`: CV_8UC1, not 0 = moving pixel; empty = nothing moves.
  void count(const std::vector<msg::Feature>& features, const cv::Mat& moving);

 private:
  static double ratio(std::size_t good, std::size_t bad) {
    return good + bad == 0 ? 1.0 : static_cast<double>(good) / static_cast<double>(good + bad);
  }
};

}  // namespace rtd::test_support
