// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/camera_tree.hpp"

#include <mutex>
#include <utility>

#include "common/geometry/transform_log.hpp"
#include "common/service/camera_frame.hpp"
#include "common/service/monotonic_clock.hpp"

namespace rtd::slam {

/// Filled by a thread of the bus.
struct CameraTree::Transforms {
  void add(msg::TFMessage message) {
    constexpr std::uint64_t kMost = 4096;  // messages: they are to last
    for (msg::TransformStamped& transform : message.transforms) transform.header.stamp = {};  // one each, the newest
    const std::lock_guard lock(mutex);
    if (revision < kMost) log.add(message);
    ++revision;
  }

  std::mutex mutex;
  geometry::TransformLog log;
  std::uint64_t revision = 1;
};

CameraTree::CameraTree(const ServiceConfig& config, service::Runtime& runtime)
    : configured_(config.camera_frame),
      map_(runtime.bus.frame(config.map_frame)),
      odom_(runtime.bus.frame(config.odom_frame)),
      base_given_(config.base.given()),
      runtime_(runtime),
      transforms_(std::make_shared<Transforms>()) {
  if (base_given_) return;
  reader_ = runtime.bus.reader<msg::TFMessage>(
      bus::topics::kTfStatic,
      [into = transforms_](const std::shared_ptr<const msg::TFMessage>& message) { into->add(*message); });
}

const CameraTree::Camera& CameraTree::camera() {
  if (camera_.frame.empty()) await_name();
  std::string frame = service::camera_frame(runtime_.heartbeat, runtime_.bus, configured_);
  const std::lock_guard lock(transforms_->mutex);
  if (frame == camera_.frame && transforms_->revision == revision_) return camera_;
  revision_ = transforms_->revision;
  camera_ = {frame, find_root(frame)};
  return camera_;
}

/// Heartbeats come five times a second, and a slam that was restarted may have missed them.
void CameraTree::await_name() const {
  constexpr std::int64_t kMostNs = 500'000'000;
  constexpr std::chrono::milliseconds kLook{10};
  const std::int64_t give_up_ns = service::monotonic_ns() + kMostNs;
  while (!service::knows_camera_frame(runtime_.heartbeat, configured_) && runtime_.heartbeat.alive("camera") &&
         service::monotonic_ns() < give_up_ns && !runtime_.stop.wait_for(kLook)) {
  }
}

/// Under the lock of the transforms.
std::optional<RobotBase> CameraTree::find_root(const std::string& frame) const {
  if (base_given_) return std::nullopt;
  auto [root, T_root_camera] = transforms_->log.root_of(frame);
  if (root == geometry::bare_frame(frame) || root == map_ || root == odom_) return std::nullopt;
  return RobotBase{std::move(root), T_root_camera, false};
}

}  // namespace rtd::slam
