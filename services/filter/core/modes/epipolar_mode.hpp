// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/filter/core/modes/published_mode.hpp"

namespace rtd::filter {

/// DS-SLAM's rule (Yu et al., IROS 2018): people with enough moving points on them are removed whole, everything else
/// stays. Its SegNet mask is our depth mask in the box.
class EpipolarMode final : public PublishedMode {
 public:
  explicit EpipolarMode(const FilterConfig& config)
      : config_(config.epipolar), dilate_cells_(config.masks.dilate_cells) {}
  PublishedVerdict judge(const PublishedInput& input, std::vector<msg::Feature>& features) override;
  void reset() override { grey_before_.release(); }

 private:
  EpipolarConfig config_;
  int dilate_cells_;
  cv::Mat grey_before_;
};

/// The masks with more than `min_points` of these raw pixels on them, together.
CellMask moving_masks(const PublishedInput& input, const std::vector<cv::Point2f>& moving_points, int min_points,
                      int dilate_cells);

}  // namespace rtd::filter
