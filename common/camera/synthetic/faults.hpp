// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace rtd::camera::synthetic {

/// What is wrong with a sensor; the defaults are the plain sensor of sensor.hpp. fault_parameters() has the ranges and
/// what each member means. All px are of the image as it is handed out.
struct SensorFaults {
  double disparity_step_px = 0.125, disparity_noise_px = 0.05, noise_correlation_px = 0;
  double holes = 0, dark_holes = 0, monitor_holes = 0;
  double flying_px = 0, wrong_side_px = 0, shadow_px = 10.875;
  double registration_px = 0, parallax_px_m = 0, depth_error = 0;

  double rolling_shutter_ms = 0, depth_shutter_ms = 0, blur_ms = 0;
  double depth_lag_ms = 0, depth_missing_every = 0, drops = 0;

  double exposure_ev = 0, exposure_lag_frames = 5, vignetting = 0, jpeg = 0;
  double distortion = 0, calibration_error = 0;
};

/// One key of a source's URI.
struct FaultParameter {
  const char* key;
  double SensorFaults::*value;
  double min, max;
  const char* help;
};
const std::vector<FaultParameter>& fault_parameters();

/// A sensor with a name: `sensor=NAME`.
struct SensorPreset {
  std::string name;
  SensorFaults faults;
};
const std::vector<SensorPreset>& sensor_presets();

}  // namespace rtd::camera::synthetic
