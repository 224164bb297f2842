// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "common/camera/calibration.hpp"

namespace rtd::camera {

/// What the parameters of a source say about its camera: ?calibration=FILE, ?intrinsics=fx,fy,cx,cy[,width,height],
/// ?depth_factor=UNITS_PER_METRE, ?fps=HZ.
struct CalibrationRequest {
  std::string file;
  std::map<std::string, double> intrinsics;  ///< keys of calibration.yaml; empty: none given
  std::optional<double> depth_factor, fps;

  /// Whether they give the camera itself.
  bool has_camera() const { return !file.empty() || !intrinsics.empty(); }
};

/// For messages.
inline constexpr const char* kCalibrationParameters = "calibration, depth_factor, intrinsics";

/// Takes a parameter that is one of these; false for another. Throws SourceError naming `uri`, value and what is
/// allowed.
bool take_calibration_parameter(CalibrationRequest& request, const std::string& uri, const std::string& key,
                                const std::string& value);

/// The camera that is asked for; its file may lie in `folder`. Throws SourceError, also when has_camera() is false.
Calibration requested_calibration(const CalibrationRequest& request, const std::filesystem::path& folder,
                                  std::optional<cv::Size> image_px);

}  // namespace rtd::camera
