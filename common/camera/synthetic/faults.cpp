// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/synthetic/faults.hpp"

namespace rtd::camera::synthetic {

const std::vector<FaultParameter>& fault_parameters() {
  using F = SensorFaults;
  static const std::vector<FaultParameter> parameters = {
      {"disparity_step_px", &F::disparity_step_px, 0.01, 1, "step of the measured disparity, 43.5 px m / depth"},
      {"disparity_noise_px", &F::disparity_noise_px, 0, 2, "standard deviation of the disparity before rounding"},
      {"noise_correlation_px", &F::noise_correlation_px, 0, 50, "distance at which its correlation falls to 1/e"},
      {"holes", &F::holes, 0, 0.9, "share of the depth pixels without measurement; speckle makes up what is missing"},
      {"dark_holes", &F::dark_holes, 0, 1, "share of hair, dark cloth and dark paint without measurement"},
      {"monitor_holes", &F::monitor_holes, 0, 1, "share of monitors without measurement"},
      {"flying_px", &F::flying_px, 0, 12, "width of the pixels between near and far at a depth edge"},
      {"wrong_side_px", &F::wrong_side_px, 0, 12, "how far a depth edge is off its place, to and fro along the edge"},
      {"shadow_px", &F::shadow_px, 0, 100, "width of the projector's shadow that 2 m casts on 4 m; left side"},
      {"registration_px", &F::registration_px, 0, 20, "shift of depth against colour; direction from the seed"},
      {"parallax_px_m", &F::parallax_px_m, -50, 50, "shift to the right by this times (1/depth - 1/2 m)"},
      {"depth_error", &F::depth_error, -0.2, 0.2, "systematic, relative"},
      {"rolling_shutter_ms", &F::rolling_shutter_ms, 0, 100, "colour: from the first row to the last"},
      {"depth_shutter_ms", &F::depth_shutter_ms, 0, 100, "depth: from the first row to the last"},
      {"blur_ms", &F::blur_ms, 0, 100, "exposure time of colour"},
      {"depth_lag_ms", &F::depth_lag_ms, -100, 100, "depth is seen so much later than colour"},
      {"depth_missing_every", &F::depth_missing_every, 0, 1000, "every n-th frame has no depth; 0 = none"},
      {"drops", &F::drops, 0, 0.9, "share of the frames that are lost"},
      {"exposure_ev", &F::exposure_ev, 0, 4, "the light changes, the image is up to so many stops wrong"},
      {"exposure_lag_frames", &F::exposure_lag_frames, 0, 100, "time constant of the automatic exposure"},
      {"vignetting", &F::vignetting, 0, 0.9, "loss of brightness in the corners"},
      {"jpeg", &F::jpeg, 0, 100, "quality; 0 = not compressed"},
      {"distortion", &F::distortion, 0, 2, "of the lens, times that of TUM's freiburg1"},
      {"calibration_error", &F::calibration_error, 0, 0.1,
       "focal lengths, principal point (of the image size): off by this share; signs from the seed"}};
  return parameters;
}

namespace {

/// Structured light, colour and depth rolling; lens and calibration as TUM's freiburg1.
SensorFaults kinect() {
  SensorFaults faults;
  faults.noise_correlation_px = 5;
  faults.holes = 0.2;
  faults.dark_holes = 0.75;
  faults.monitor_holes = 0.9;
  faults.flying_px = 2;
  faults.wrong_side_px = 2;
  faults.shadow_px = 14;
  faults.registration_px = 1.5;
  faults.parallax_px_m = 2;
  faults.depth_error = 0.015;
  faults.rolling_shutter_ms = 21;
  faults.depth_shutter_ms = 26;
  faults.blur_ms = 10;
  faults.depth_lag_ms = 9;
  faults.exposure_ev = 0.75;
  faults.vignetting = 0.25;
  faults.distortion = 1;
  faults.calibration_error = 0.01;
  return faults;
}

/// Active stereo: global shutter and fine steps, but noisier, with wide flying edges; colour as JPEG by USB.
SensorFaults d435() {
  SensorFaults faults;
  faults.disparity_step_px = 0.05;
  faults.disparity_noise_px = 0.13;
  faults.noise_correlation_px = 7;
  faults.holes = 0.15;
  faults.dark_holes = 0.6;
  faults.monitor_holes = 0.7;
  faults.flying_px = 4;
  faults.wrong_side_px = 3;
  faults.shadow_px = 8;
  faults.registration_px = 1;
  faults.parallax_px_m = 1;
  faults.depth_error = 0.01;
  faults.rolling_shutter_ms = 15;
  faults.blur_ms = 8;
  faults.depth_lag_ms = -5;
  faults.exposure_ev = 0.75;
  faults.vignetting = 0.2;
  faults.jpeg = 80;
  faults.calibration_error = 0.005;
  return faults;
}

}  // namespace

const std::vector<SensorPreset>& sensor_presets() {
  static const std::vector<SensorPreset> presets = {{"kinect", kinect()}, {"d435", d435()}};
  return presets;
}

}  // namespace rtd::camera::synthetic
