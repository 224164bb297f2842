// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <utility>
#include <vector>

namespace rtd::camera::synthetic {

/// Light that changes with time for the whole room: lamps that flicker, are dimmed and switched, and a camera whose
/// exposure follows. A pure function of seed and time.
class Lighting {
 public:
  /// `unrest`: 0 = constant light, 1 = full flicker.
  Lighting(double unrest, std::uint64_t seed);
  /// What becomes of a brightness in [0, 1]: gain * brightness^gamma.
  struct Curve {
    double gain = 1, gamma = 1;
  };
  Curve at(double t_s) const;
  /// Applies the curve to an 8-bit image in place.
  void apply(cv::Mat& color_bgr, double t_s) const;

 private:
  double unrest_, dim_rate_rad_s_, dim_phase_rad_, flicker_rate_rad_s_;
  std::uint64_t seed_;
};

/// A structured-light RGB-D sensor of the Kinect's kind.
struct SensorModel {
  bool noise = true;  ///< false: ideal sensor, only the quantisation of the depth unit remains
  float depth_units_per_m = 5000;
  float min_depth_m = 0.45F, max_depth_m = 6.0F;
  float baseline_px_m = 43.5F;  ///< projector baseline 7.5 cm x focal length 580 px: disparity = this / z
  float shadow_px_m = 43.5F;    ///< width of the projector's shadow = this x difference of 1/z
  float disparity_step_px = 0.125F;
  float disparity_noise_steps = 0.4F;  ///< standard deviation; with the rounding sigma_z is about 0.0014 z^2 m
  float max_relative_slope = 0.025F;   ///< of 1/z over two pixels: steeper is grazing incidence or a depth edge
  float color_noise_levels = 2.0F;     ///< standard deviation, grey levels
};

/// Turns ideal images into measured ones. The same seed and frame index give the same noise. Not thread-safe.
class Sensor {
 public:
  static constexpr int kWidestRowPx = 4096;  ///< wider images throw std::invalid_argument

  Sensor(const SensorModel& model, std::uint64_t seed);

  /// 16-bit depth, 0 = no measurement: out of range, grazing, next to a depth edge, or hidden from the projector.
  /// `noise`: CV_32FC1, variance 1, instead of the sensor's own white noise when not empty.
  cv::Mat measure_depth(const cv::Mat& inverse_depth, std::uint64_t frame_index, const cv::Mat& noise = {}) const;
  /// Rounded; 0 out of range.
  std::uint16_t to_units(float depth_m) const;
  /// The image with noise, in its own buffer.
  cv::Mat measure_color(const cv::Mat& ideal_bgr, std::uint64_t frame_index) const;

 private:
  void measure_depth_row(const cv::Mat& inverse_depth, int row, const float* noise, std::uint16_t* depth) const;

  SensorModel model_;
  std::uint64_t seed_;
  std::vector<std::int8_t> color_noise_;           ///< grey levels
  std::vector<float> depth_noise_;                 ///< disparity steps
  std::vector<std::uint16_t> units_of_disparity_;  ///< index: disparity in steps
};

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

/// Sensors with a name: `sensor=NAME`.
const std::vector<std::pair<std::string, SensorFaults>>& sensor_presets();

}  // namespace rtd::camera::synthetic
