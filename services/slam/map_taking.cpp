// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "common/service/config.hpp"
#include "common/service/monotonic_clock.hpp"
#include "services/slam/slam_service.hpp"

/// Where the service's map comes from: a file, a command, or an atlas.
namespace rtd::slam {

void SlamService::load_map() {
  const std::string& file = config_.map.load;
  if (file.empty()) return;
  const std::int64_t start_ns = service::monotonic_ns();
  try {
    MapContents contents = load_map_file(file);
    map_cameras_ = cameras_of(contents);
    SPDLOG_INFO("event=map_loaded file={} keyframes={} landmarks={} maps={}", file, contents.keyframes.size(),
                contents.landmarks.size(), std::ranges::count_if(contents.keyframes, &Keyframe::is_origin));
    slam_.restore(std::move(contents));
    if (atlas_) atlas_->begin_map(true);
  } catch (const std::runtime_error& error) {  // it cannot be read, or is no map
    throw service::ConfigError(std::string("slam.map.load: ") + error.what());
  }
  SPDLOG_INFO("event=map_ready file={} ms={:.0f}", file,
              static_cast<double>(service::monotonic_ns() - start_ns) * 1e-6);
}

bool SlamService::check_camera(const msg::FeatureFrame& frame) {
  const std::string difference = difference_to(map_cameras_, frame);
  if (difference.empty()) return true;
  if (map_by_command_) {
    SPDLOG_WARN("event=map_given_up cause=\"{}\"", difference);
    forget_map();
    refused_map_ = "the map of slam/load_map is not used: " + difference;
    return true;
  }
  SPDLOG_ERROR("event=other_camera file={} cause=\"{}\"", config_.map.load, difference);
  return false;
}

/// How its cameras differ from ours, and what to do; then nothing is taken.
std::string SlamService::take_map(MapContents contents) {
  MapCameras cameras = cameras_of(contents);
  const std::string difference = last_frame_ ? difference_to(cameras, *last_frame_) : "";
  if (!difference.empty()) return difference;
  map_cameras_ = std::move(cameras);
  map_by_command_ = true;
  refused_map_.clear();
  slam_.load_map(std::move(contents));
  publisher_.begin_map();
  if (atlas_) atlas_->begin_map(true);
  return {};
}

void SlamService::forget_map() {
  map_cameras_.clear();
  refused_map_.clear();
  slam_.reset();
  publisher_.begin_map();
  if (atlas_) atlas_->begin_map(false);
}

}  // namespace rtd::slam
