// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/synthetic/shutter.hpp"

#include <algorithm>
#include <cmath>

namespace rtd::camera::synthetic {
namespace {

constexpr int kBandRows = 8;
constexpr double kExposureStepS = 0.004;  ///< walkers near the camera move 2 px, the room 1 px

Rendering read_rows(Renderer& renderer, const Scene& scene, double t_s, double readout_s) {
  const int rows = renderer.height_px();
  const int band_rows = readout_s > 0 ? kBandRows : rows;
  Rendering rendering;
  for (int begin = 0; begin < rows; begin += band_rows) {
    const cv::Range band(begin, std::min(begin + band_rows, rows));
    const double middle = (band.start + band.end - 1) / 2.0 - (rows - 1) / 2.0;
    const double band_s = t_s + readout_s * middle / (rows - 1);
    rendering = renderer.render_rows(scene.geometry_at(band_s), scene.textures(), scene.T_world_camera(band_s), band);
  }
  return rendering;
}

}  // namespace

Rendering take_picture(Renderer& renderer, const Scene& scene, double t_s, const Shutter& shutter) {
  const int before = static_cast<int>(std::ceil(shutter.exposure_s / 2 / kExposureStepS));  // and as many after
  const int moments = 2 * before + 1;
  cv::Mat sum;
  for (int i = -before; i <= before; ++i) {
    if (i == 0) continue;  // last: the renderer keeps what it draws
    const double moment_s = t_s + shutter.exposure_s * i / moments;
    const cv::Mat color = read_rows(renderer, scene, moment_s, shutter.readout_s).color_bgr;
    if (sum.empty()) sum = cv::Mat::zeros(color.size(), CV_16UC3);
    cv::add(sum, color, sum, cv::noArray(), CV_16U);
  }
  Rendering rendering = read_rows(renderer, scene, t_s, shutter.readout_s);
  if (sum.empty()) return rendering;
  cv::add(sum, rendering.color_bgr, sum, cv::noArray(), CV_16U);
  cv::Mat mean;
  sum.convertTo(mean, CV_8U, 1.0 / moments);
  rendering.color_bgr = mean;
  return rendering;
}

}  // namespace rtd::camera::synthetic
