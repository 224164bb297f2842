// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/synthetic/scene_camera.hpp"

#include "common/camera/synthetic/texture.hpp"

namespace rtd::camera::synthetic {
namespace {

constexpr std::array<double, 8> kFreiburg1 = {0.262383, -0.953104, -0.005358, 0.002628, 1.163314};
constexpr double kMs = 1e-3;

cv::Size size_of(const geometry::CameraModel& camera) {
  return {camera.parameters().width, camera.parameters().height};
}

}  // namespace

std::array<double, 8> lens_distortion(double factor) {
  if (factor == 0) return {};  // a product would be -0, which calibration.yaml shows
  std::array<double, 8> distortion = kFreiburg1;
  for (double& coefficient : distortion) coefficient *= factor;
  return distortion;
}

geometry::CameraModel miscalibrated(const geometry::CameraModel& camera, double error, std::uint64_t seed) {
  geometry::CameraModel::Parameters parameters = camera.parameters();
  SeededRandom random(seed ^ 0xCA11BULL);
  const auto off = [&] { return random.unit() < 0.5F ? -error : error; };
  const double focal = off();  // both focal lengths: their ratio is known better
  parameters.fx *= 1 + focal;
  parameters.fy *= 1 + focal;
  parameters.cx += off() * parameters.width;
  parameters.cy += off() * parameters.height;
  return geometry::CameraModel(parameters);
}

SceneCamera::SceneCamera(const Scene& scene, const Options& options)
    : scene_(scene),
      faults_(options.faults),
      lens_(options.camera),
      renderer_(lens_.pinhole()),
      color_sensor_(options.sensor, options.seed),
      color_faults_(options.faults, size_of(options.camera), options.fps, options.seed),
      depth_faults_(options.faults, options.sensor, size_of(options.camera), options.seed) {}

Shot SceneCamera::shoot(std::uint64_t index, double t_s) {
  Rendering seen = look(t_s, {faults_.rolling_shutter_ms * kMs, faults_.blur_ms * kMs});
  cv::Mat lit_bgr = seen.color_bgr.clone();
  scene_.lighting().apply(lit_bgr, t_s);
  color_faults_.expose(lit_bgr, t_s);
  Shot shot;
  shot.color_bgr = color_faults_.compressed(color_sensor_.measure_color(lit_bgr, index));
  shot.moving_mask = seen.moving_mask.clone();  // the renderer draws the depth, and the next frame, into the same one
  shot.objects = seen.objects;
  if (depth_is_missing(index)) {
    shot.depth = cv::Mat::zeros(shot.color_bgr.size(), CV_16UC1);
    return shot;
  }
  if (depth_apart()) seen = look(t_s + faults_.depth_lag_ms * kMs, {faults_.depth_shutter_ms * kMs, 0});
  shot.depth = depth_faults_.measure({seen.inverse_depth, seen.material, seen.color_bgr}, index);
  return shot;
}

Rendering SceneCamera::look(double t_s, const Shutter& shutter) {
  return lens_.bent(take_picture(renderer_, scene_, t_s, shutter));
}

bool SceneCamera::depth_is_missing(std::uint64_t index) const {
  const auto every = static_cast<std::uint64_t>(faults_.depth_missing_every);
  return every > 0 && index % every == every - 1;
}

/// Whether depth is seen at other times than colour.
bool SceneCamera::depth_apart() const {
  return faults_.depth_lag_ms != 0 || faults_.depth_shutter_ms != faults_.rolling_shutter_ms;
}

}  // namespace rtd::camera::synthetic
