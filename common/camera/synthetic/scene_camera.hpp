// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "common/camera/synthetic/depth_faults.hpp"
#include "common/camera/synthetic/renderer.hpp"
#include "common/camera/synthetic/scene.hpp"
#include "common/camera/synthetic/sensor.hpp"
#include "common/geometry/camera_model.hpp"

namespace rtd::camera::synthetic {

/// How an image comes about over time.
struct Shutter {
  double readout_s = 0;   ///< from the first row to the last; 0 = all at once
  double exposure_s = 0;  ///< of each row; 0 = a moment
};

/// What the camera of a scene sees, its middle row exposed about `t_s`. Camera and moving objects continue while the
/// rows are read: every 8 rows are drawn for a moment of their own. Colour is the mean over the exposure; depth, mask
/// and objects are those in its middle. Costs one rendering per 4 ms of exposure; the readout costs next to nothing.
Rendering take_picture(Renderer& renderer, const Scene& scene, double t_s, const Shutter& shutter);

/// Bends what a pinhole camera sees into the image of a camera with distortion: one table for colour (bilinear), depth,
/// mask, material and objects (nearest). Immutable.
class Lens {
 public:
  explicit Lens(const geometry::CameraModel& camera);

  /// Sees all that the lens shows. The same as the camera when that has no distortion.
  const geometry::CameraModel& pinhole() const { return pinhole_; }
  /// What `rendering`, made by the pinhole camera, becomes; without distortion `rendering` itself.
  Rendering bent(const Rendering& rendering) const;

 private:
  geometry::CameraModel pinhole_;
  cv::Mat from_u_, from_v_;  ///< CV_32FC1, px of the pinhole image; empty without distortion
};

/// The faults of a colour image at one instant. A pure function of seed and time; immutable.
class ColorFaults {
 public:
  ColorFaults(const SensorFaults& faults, cv::Size size_px, double fps, std::uint64_t seed);

  /// Vignetting, and light that changes before the exposure follows; in place. Before the sensor's noise.
  void expose(cv::Mat& color_bgr, double t_s) const;
  /// What JPEG leaves of an image; the image itself when it is not compressed.
  cv::Mat compressed(const cv::Mat& color_bgr) const;
  /// How much too bright the image is, in stops.
  double exposure_error_ev(double t_s) const;

 private:
  double light_ev(std::int64_t span) const;
  double change_s(std::int64_t span) const;

  SensorFaults faults_;
  double lag_s_;
  std::uint64_t seed_;
  cv::Mat falloff_;  ///< CV_32FC3, factor per pixel; empty without vignetting
};

/// One exposure. Mask and objects are those of the colour image.
struct Shot {
  cv::Mat color_bgr;    ///< CV_8UC3
  cv::Mat depth;        ///< CV_16UC1, 0 = no measurement
  cv::Mat moving_mask;  ///< CV_8UC1, 255 = moving object
  std::vector<ObjectView> objects;
};

/// The camera in a scene: lens, shutter and sensor with their faults. Without faults: an ideal pinhole camera with the
/// noise of SensorModel. A shot is a pure function of seed, index and time. Not thread-safe.
class SceneCamera {
 public:
  struct Options {
    geometry::CameraModel camera;  ///< the true one, with distortion
    SensorModel sensor;
    SensorFaults faults;
    double fps = 30;
    std::uint64_t seed = 1;
  };
  /// `scene` must outlive the camera.
  SceneCamera(const Scene& scene, const Options& options);

  /// `t_s`: when the middle row of the colour image is in the middle of its exposure.
  Shot shoot(std::uint64_t index, double t_s);

 private:
  Rendering look(double t_s, const Shutter& shutter);
  bool depth_is_missing(std::uint64_t index) const;
  bool depth_apart() const;

  const Scene& scene_;
  SensorFaults faults_;
  Lens lens_;
  Renderer renderer_;
  Sensor color_sensor_;
  ColorFaults color_faults_;
  DepthFaults depth_faults_;
};

/// What a calibration finds that is wrong by SensorFaults::calibration_error; signs from the seed.
geometry::CameraModel miscalibrated(const geometry::CameraModel& camera, double error, std::uint64_t seed);

/// TUM freiburg1's distortion times a factor.
std::array<double, 8> lens_distortion(double factor);

}  // namespace rtd::camera::synthetic
