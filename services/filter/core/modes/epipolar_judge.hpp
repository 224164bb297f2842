// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "common/geometry/camera_model.hpp"
#include "services/filter/core/config/filter_config.hpp"
#include "services/filter/core/modes/mode_judge.hpp"

namespace rtd::filter {

/// A corner of the image before, found again in the current one by optical flow. Raw pixels.
struct FlowMatch {
  cv::Point2f before, now;
};

/// Corners followed by pyramidal Lucas-Kanade flow. Left out: corners that leave the image or end near its border, and
/// those that no longer look the same (3x3 patch). Both images CV_8UC1 of one size.
std::vector<FlowMatch> follow_corners(const cv::Mat& before, const cv::Mat& now);

/// DS-SLAM's moving consistency check (Yu et al., IROS 2018, section III-C): the fundamental matrix of most matches by
/// RANSAC; where a match ends farther from its epipolar line than 1 px, it has moved. Returns the
/// current raw pixels of those; none when there are too few matches for a matrix. Motion along the epipolar line is not
/// seen: this is the weakness of the check, as is the freedom of the matrix when the camera only turns.
std::vector<cv::Point2f> find_moving_points(const std::vector<FlowMatch>& matches, const geometry::CameraModel& camera);

/// DS-SLAM's rule (Yu et al., IROS 2018): people with enough moving points on them are removed whole, everything else
/// stays. Its SegNet mask is our depth mask in the box.
class EpipolarJudge final : public ModeJudge {
 public:
  explicit EpipolarJudge(const FilterConfig& config)
      : config_(config.epipolar), dilate_cells_(config.masks.dilate_cells) {}
  Verdict judge(const Scene& scene, std::vector<msg::Feature> features, StageClock& clock) override;
  void reset() override { grey_before_.release(); }

 private:
  EpipolarConfig config_;
  int dilate_cells_;
  cv::Mat grey_before_;
};

/// The masks with more than `min_points` of these raw pixels on them, together.
CellMask moving_masks(const Scene& scene, const std::vector<cv::Point2f>& moving_points, int min_points,
                      int dilate_cells);

}  // namespace rtd::filter
