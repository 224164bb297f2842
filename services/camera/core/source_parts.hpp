// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "services/camera/core/frame_source.hpp"

namespace rtd::camera {

/// Ground truth is given this far beyond the first and last frame, so that an evaluator can interpolate.
inline constexpr std::int64_t kGroundtruthMarginNs = 500'000'000;

/// Why colour, depth and calibration do not make a frame; empty when they do. `name` is the colour image's.
std::optional<SkippedInput> size_mismatch(const std::string& name, const cv::Mat& color, const cv::Mat& depth,
                                          const geometry::CameraModel& camera);

/// The frame that a pair of images makes; seq is given when it is handed out.
SourceFrame to_frame(std::int64_t stamp_ns, cv::Mat color_bgr, cv::Mat depth, const SourceInfo& info);

/// The poses between these stamps and kGroundtruthMarginNs around them.
geometry::Trajectory poses_of_span(geometry::Trajectory poses, std::int64_t from_ns, std::int64_t to_ns);

/// "640 x 480".
std::string size_text(cv::Size size_px);

}  // namespace rtd::camera
