// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "common/camera/synthetic/sensor.hpp"

namespace rtd::camera::synthetic {

/// Normal noise, mean 0, variance 1, whose correlation falls to 1/e at a distance. The same arguments give the same
/// field; immutable.
class NoiseField {
 public:
  /// `correlation_px`: 0 = white. `window_px`: size of the windows.
  NoiseField(double correlation_px, cv::Size window_px, std::uint64_t seed);

  /// The part of the field that belongs to an index, CV_32FC1; not to be written to.
  cv::Mat window(std::uint64_t index) const;
  /// The value that this share of the field is below; -inf for 0, +inf for 1.
  float quantile(double share) const;

 private:
  cv::Size window_px_;
  std::uint64_t seed_;
  cv::Mat field_;
  std::vector<float> sorted_;
};

/// What the depth camera looks at.
struct DepthScene {
  cv::Mat inverse_depth;  ///< CV_32FC1, 1/m, 0 = nothing there
  cv::Mat material;       ///< CV_8UC1, Material
  cv::Mat color_bgr;      ///< CV_8UC3; dark paint returns little infrared light
};

/// The faults of a depth image at one instant, on top of the sensor's own. The same seed and frame index give the same
/// faults. Immutable.
class DepthFaults {
 public:
  DepthFaults(const SensorFaults& faults, const SensorModel& model, cv::Size size_px, std::uint64_t seed);

  /// What the sensor measures of a view, in its units.
  cv::Mat measure(const DepthScene& view, std::uint64_t frame_index) const;

 private:
  void fly(cv::Mat& depth, const cv::Mat& inverse_depth, std::uint64_t frame_index) const;
  cv::Mat wrong_sided(const cv::Mat& depth, const cv::Mat& inverse_depth, std::uint64_t frame_index) const;
  void lose_by_material(cv::Mat& depth, const DepthScene& view, std::uint64_t frame_index) const;
  void lose_speckle(cv::Mat& depth, std::uint64_t frame_index) const;
  void scale(cv::Mat& depth) const;
  cv::Mat registered(const cv::Mat& depth) const;
  void register_row(const cv::Mat& depth, int row, cv::Mat& moved) const;

  SensorFaults faults_;
  SensorModel model_;
  Sensor sensor_;
  std::optional<NoiseField> disparity_noise_, blobs_, ragged_, mixing_;  ///< those that some fault needs
  cv::Point2f offset_px_;                                                ///< of the registration
};

}  // namespace rtd::camera::synthetic
