// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "common/camera/synthetic/color_faults.hpp"
#include "common/camera/synthetic/depth_faults.hpp"
#include "common/camera/synthetic/faults.hpp"
#include "common/camera/synthetic/lens.hpp"
#include "common/camera/synthetic/renderer.hpp"
#include "common/camera/synthetic/scene.hpp"
#include "common/camera/synthetic/sensor.hpp"
#include "common/camera/synthetic/shutter.hpp"
#include "common/geometry/camera_model.hpp"

namespace rtd::camera::synthetic {

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
