// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/camera_frame.hpp"

#include <algorithm>

#include "common/msg/camera_frame.hpp"
#include "common/service/metric_names.hpp"

namespace rtd::service {
namespace {

constexpr std::size_t kLongestName = 200;
constexpr const char* kCamera = "camera";  // the service

bool fits_in_heartbeat(const std::string& name) {
  return !name.empty() && name.size() <= kLongestName &&
         std::ranges::all_of(name, [](char letter) { return letter > ' ' && letter < 0x7f; });
}

std::string announced(const Heartbeat& heartbeat) {
  return heartbeat.word_of(kCamera, metric::kFrameIdPrefix);
}

}  // namespace

std::string announce_camera_frame(Heartbeat& heartbeat, const bus::Bus& bus, const std::string& frame_id) {
  std::string name = fits_in_heartbeat(frame_id) ? frame_id : bus.frame(msg::kCameraFrame);
  heartbeat.set_word(metric::kFrameIdPrefix, name);
  return name;
}

std::string camera_frame(const Heartbeat& heartbeat, const bus::Bus& bus, const std::string& configured) {
  if (!configured.empty()) return bus.frame(configured);
  std::string name = announced(heartbeat);
  return name.empty() ? bus.frame(msg::kCameraFrame) : name;
}

bool knows_camera_frame(const Heartbeat& heartbeat, const std::string& configured) {
  return !configured.empty() || !announced(heartbeat).empty();
}

}  // namespace rtd::service
