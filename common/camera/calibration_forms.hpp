// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>

#include "common/camera/lens_models.hpp"

namespace rtd::camera {

/// What a calibration of another program says, in the keys of calibration.yaml; fy may be negative (ICL-NUIM).
struct CalibrationValues {
  std::string form;  ///< "ORB-SLAM3 settings"
  std::map<std::string, double> values;
  LensModel lens = LensModel::kBrownConrady;  ///< of k1 k2 ...
};

/// For messages.
inline constexpr const char* kCalibrationForms =
    "calibration.yaml, ORB-SLAM2 and ORB-SLAM3 settings, stella_vslam, ROS camera_info, OpenCV, Kalibr camchain, EuRoC "
    "sensor.yaml, OpenLORIS sensors.yaml, Open3D and other JSON, COLMAP cameras.txt, ScanNet, BundleFusion, "
    "'fx fy cx cy', a 3 x 3 or 4 x 4 matrix";

/// Recognises the form by what only that form has. Empty: none of them, or calibration.yaml. Throws SourceError naming
/// `origin` for a lens that no model fits.
std::optional<CalibrationValues> read_calibration_form(const std::string& text, const std::string& origin);

}  // namespace rtd::camera
