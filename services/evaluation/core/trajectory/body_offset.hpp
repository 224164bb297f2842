// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "services/evaluation/core/trajectory/trajectory_error.hpp"

namespace rtd::eval {

/// Where the camera is in the body whose poses the ground truth has, when they are two: the markers of a motion capture
/// have their own axes.
struct BodyOffset {
  Eigen::Isometry3d T_body_camera = Eigen::Isometry3d::Identity();
  bool of_bonn = false;  ///< the turn is that of the Bonn RGB-D Dynamic Dataset
};

/// The constant transform X with A X = X B for the motions A of the body and B of the camera over a second (hand-eye
/// calibration; docs/evaluation.md Eq. (11)). Empty unless it is plainly there: the body turns about more than one
/// axis, X turns by more than 2 degrees or moves by more than 2 cm, and the median error of these motions in rotation
/// or in translation falls below half with it. `scale` multiplies the estimate's translations.
std::optional<BodyOffset> find_body_offset(const Trajectory& estimate, const Trajectory& groundtruth, double offset_s,
                                           double scale = 1);

/// Ground truth of the camera; as it is where there is no offset.
Trajectory camera_truth(const Trajectory& groundtruth, const std::optional<BodyOffset>& offset);

/// "the ground truth is of another body: the camera is turned by 127.3 degrees and 0.019 m away from it ...".
std::string explain(const BodyOffset& offset);

}  // namespace rtd::eval
