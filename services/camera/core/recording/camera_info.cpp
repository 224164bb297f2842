// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/core/recording/camera_info.hpp"

#include <algorithm>
#include <cmath>

#include "services/camera/core/frame_source.hpp"

namespace rtd::camera {
namespace {

constexpr const char* kFix = "; give a calibration of your own: ?calibration=FILE";

void take_distortion(const msg::CameraInfo& info, const std::string& origin, std::array<double, 5>& distortion) {
  const bool none = std::all_of(info.d.begin(), info.d.end(), [](double value) { return value == 0; });
  if (none) return;
  const bool tail_zero =
      std::all_of(info.d.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(5, info.d.size())), info.d.end(),
                  [](double value) { return value == 0; });
  if (info.distortion_model == "equidistant" || info.distortion_model == "fisheye" || !tail_zero) {
    throw SourceError(origin + ": distortion model '" + info.distortion_model + "' with " +
                      std::to_string(info.d.size()) + " values; known: plumb_bob with k1 k2 p1 p2 k3" + kFix);
  }
  std::copy_n(info.d.begin(), std::min<std::size_t>(5, info.d.size()), distortion.begin());
}

}  // namespace

msg::CameraInfo to_camera_info(const geometry::CameraModel& camera, std::int64_t stamp_ns) {
  const auto& p = camera.parameters();
  msg::CameraInfo info;
  info.header = {msg::to_time(stamp_ns), kCameraFrame};
  info.width = static_cast<std::uint32_t>(p.width);
  info.height = static_cast<std::uint32_t>(p.height);
  info.distortion_model = "plumb_bob";
  info.d.assign(p.distortion.begin(), p.distortion.end());
  info.k = {p.fx, 0, p.cx, 0, p.fy, p.cy, 0, 0, 1};
  info.r = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  info.p = {p.fx, 0, p.cx, 0, 0, p.fy, p.cy, 0, 0, 0, 1, 0};
  return info;
}

geometry::CameraModel to_camera_model(const msg::CameraInfo& info, const std::string& color_topic,
                                      const std::string& origin) {
  geometry::CameraModel::Parameters p;
  p.width = static_cast<int>(info.width), p.height = static_cast<int>(info.height);
  if (color_topic.find("image_rect") != std::string::npos && info.p[0] > 0) {
    p.fx = info.p[0], p.fy = info.p[5], p.cx = info.p[2], p.cy = info.p[6];
  } else {
    p.fx = info.k[0], p.fy = info.k[4], p.cx = info.k[2], p.cy = info.k[5];
    take_distortion(info, origin, p.distortion);
  }
  const double sum = p.fx + p.fy + p.cx + p.cy + p.distortion[0] + p.distortion[1] + p.distortion[2] + p.distortion[3] +
                     p.distortion[4];
  if (!(p.fx > 0) || !(p.fy > 0) || !std::isfinite(sum)) {
    throw SourceError(origin + ": fx is " + std::to_string(p.fx) + ", fy " + std::to_string(p.fy) +
                      ": the camera was not calibrated" + kFix);
  }
  return geometry::CameraModel(p);
}

}  // namespace rtd::camera
