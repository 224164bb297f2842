// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/mount_from_tf.hpp"

#include <fmt/format.h>

#include <chrono>

#include "common/bus/topics.hpp"
#include "common/concurrency/bounded_queue.hpp"
#include "common/geometry/transform_log.hpp"
#include "common/service/config.hpp"
#include "common/service/log.hpp"

namespace rtd::slam {
namespace {

using Transforms = concurrency::BoundedQueue<msg::TFMessage>;

/// What keeps the two frames apart; empty when they are joined.
std::string missing_between(const std::string& base, const std::string& camera, const geometry::TransformLog& log) {
  if (log.between(base, camera)) return {};
  const bool knows_base = log.knows(base), knows_camera = log.knows(camera);
  if (!knows_base && !knows_camera) return fmt::format("no transform of '{}' or '{}'", base, camera);
  if (!knows_base) return fmt::format("no transform of '{}' (slam.base.frame)", base);
  if (!knows_camera) return fmt::format("no transform of '{}' (slam.camera_frame)", camera);
  return fmt::format("no chain of transforms from '{}' to '{}'", base, camera);
}

std::string to_text(const Eigen::Isometry3d& T) {
  const Eigen::Vector3d t = T.translation();
  const Eigen::Quaterniond q(T.linear());
  return fmt::format("{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g}", t.x(), t.y(), t.z(), q.x(), q.y(),
                     q.z(), q.w());
}

}  // namespace

ServiceConfig with_mount(ServiceConfig config, service::Runtime& runtime) {
  config.validate();
  if (!config.base.from_tf()) return config;
  constexpr std::chrono::milliseconds kStep{50};
  constexpr std::size_t kQueue = 64;
  const std::string base = runtime.bus.frame(config.base.frame), camera = runtime.bus.frame(config.camera_frame);
  const auto queue = std::make_shared<Transforms>(kQueue, concurrency::Overflow::kDropOldest);
  const auto reader = runtime.bus.reader<msg::TFMessage>(
      bus::topics::kTfStatic, [queue](const std::shared_ptr<const msg::TFMessage>& message) { queue->push(*message); });
  geometry::TransformLog log;
  service::RateLimit progress(std::chrono::seconds(2));
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(config.base.tf_timeout_s);
  for (std::string missing; !(missing = missing_between(base, camera, log)).empty();) {
    if (runtime.stop.stop_requested()) {
      config.base.camera = "0,0,0,0,0,0,1";  // the service ends before its first frame
      return config;
    }
    if (std::chrono::steady_clock::now() > end) {
      throw service::ConfigError(fmt::format(
          "slam.base.camera=tf: {} on rt/tf_static after {:g} s. Does a robot_state_publisher run in this domain, and "
          "are the frames those of slam.base.frame and slam.camera_frame? Or give the mount as "
          "--camera-in-base x,y,z,qx,qy,qz,qw",
          missing, config.base.tf_timeout_s));
    }
    runtime.heartbeat.tick();
    runtime.heartbeat.set_state(msg::ServiceState::kStarting, "waits for rt/tf_static: " + missing);
    if (progress.pass()) SPDLOG_INFO("event=waits_for_tf topic=rt/tf_static missing=\"{}\"", missing);
    if (const auto message = queue->pop_for(kStep)) log.add(*message);
  }
  config.base.camera = to_text(*log.between(base, camera));
  config.base.publish_camera = false;  // whoever publishes rt/tf_static has it
  SPDLOG_INFO("event=mount_from_tf base={} camera={} mount={}", base, camera, config.base.camera);
  return config;
}

}  // namespace rtd::slam
