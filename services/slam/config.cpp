// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/config.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <chrono>
#include <memory>
#include <set>

#include "common/bus/topics.hpp"
#include "common/concurrency/bounded_queue.hpp"
#include "common/geometry/transform_log.hpp"
#include "common/io/byte_sink.hpp"
#include "common/io/fd_writing.hpp"
#include "common/io/input_file.hpp"
#include "common/io/printable.hpp"
#include "common/service/camera_frame.hpp"
#include "common/service/config.hpp"
#include "common/service/log.hpp"
#include "common/service/runtime.hpp"
#include "services/slam/camera_tree.hpp"
#include "services/slam/core/place/vocabulary.hpp"

namespace rtd::slam {
namespace {

std::string read_vocabulary(const std::string& path) {
  try {
    return io::read_file(path, {"a vocabulary", Vocabulary::kMaxBytes});
  } catch (const io::IoError& error) {
    throw service::ConfigError(std::string("slam.place.vocabulary: ") + error.what() +
                               "; leave it empty for the built-in one");
  }
}

void check_topic(const std::string& key, const std::string& topic) {
  if (topic.empty() || (topic.size() > 1 && topic.starts_with('/'))) return;
  throw service::ConfigError(key + "=" + topic + ": a ROS topic begins with a slash, e.g. /" + topic);
}

void check(const MotionTopics& motion, bool base_given) {
  check_topic("slam.imu.topic", motion.imu);
  check_topic("slam.wheel.topic", motion.wheels);
  if (!motion.imu_mount.empty()) parse_mount(motion.imu_mount, "slam.imu.mount");
  if (!motion.imu_mount_in_base.empty()) parse_mount(motion.imu_mount_in_base, "slam.imu.mount_in_base");
  if (!motion.wheels.empty() && !base_given)
    throw service::ConfigError("slam.wheel.topic=" + motion.wheels +
                               ": wheels move the base: say where the camera is in it, --camera-in-base");
  if (motion.imu_mount_in_base.empty()) return;
  if (!base_given)
    throw service::ConfigError("slam.imu.mount_in_base needs the camera's place in the base, --camera-in-base");
  if (!motion.imu_mount.empty())
    throw service::ConfigError("slam.imu.mount and slam.imu.mount_in_base: give one of the two");
}

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

std::string frames_of(const geometry::TransformLog& log) {
  const std::set<std::string> frames = log.frames();
  return frames.empty() ? "" : fmt::format(" (of the frames {})", fmt::join(frames, ", "));
}

std::string to_text(const Eigen::Isometry3d& T) {
  const Eigen::Vector3d t = T.translation();
  const Eigen::Quaterniond q(T.linear());
  return fmt::format("{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g}", t.x(), t.y(), t.z(), q.x(), q.y(),
                     q.z(), q.w());
}

}  // namespace

std::string maps_folder(const ServiceConfig& config, const std::string& state_folder) {
  if (!config.map.folder.empty()) return config.map.folder;
  if (!config.map.save.empty()) return io::folder_of(config.map.save).string();
  return config.out_dir.empty() ? state_folder : config.out_dir;
}

SlamConfig core_config(const ServiceConfig& config) {
  SlamConfig core = config.core;
  if (config.base.gravity != "level") core.first_pose = level_camera();
  if (config.base.given()) core.first_pose = core.prior.T_base_camera = parse_mount(config.base.camera);
  if (config.base.gravity == "floor") core.gravity = Gravity::kFloor;
  if (config.base.gravity == "imu") core.gravity = Gravity::kImu;
  core.gravity_wait_frames = config.base.gravity_wait_frames;
  core.prior.imu = !config.motion.imu.empty();
  core.prior.wheels = !config.motion.wheels.empty();
  if (!config.motion.imu_mount.empty()) {
    core.prior.T_camera_imu = parse_mount(config.motion.imu_mount, "slam.imu.mount");
  }
  if (!config.motion.imu_mount_in_base.empty()) {
    const Eigen::Isometry3d T_base_imu = parse_mount(config.motion.imu_mount_in_base, "slam.imu.mount_in_base");
    core.prior.T_camera_imu = core.prior.T_base_camera.inverse() * T_base_imu;
  }
  if (config.vocabulary_file.empty()) return core;
  try {
    core.place.vocabulary =
        std::make_shared<const Vocabulary>(Vocabulary::parse(io::bytes_of(read_vocabulary(config.vocabulary_file))));
  } catch (const VocabularyError& error) {
    throw service::ConfigError("slam.place.vocabulary: '" + io::abridged(config.vocabulary_file) +
                               "': " + error.what());
  }
  return core;
}

void ServiceConfig::validate() const {
  if (base.given() && !base.from_tf()) parse_mount(base.camera);
  if (base.gravity == "imu" && motion.imu.empty())
    throw service::ConfigError(
        "slam.base.gravity=imu needs the topic of an IMU: --imu TOPIC; without one use floor or level");
  check(motion, base.given());
  if (!core.localize_only) return;
  if (map.load.empty())
    throw service::ConfigError("slam.map.localize_only needs a map: name its file with --map (slam.map.load)");
  if (!map.save.empty())
    throw service::ConfigError("slam.map.save=" + map.save +
                               ": with slam.map.localize_only the map does not change; leave out one of the two");
}

ServiceConfig with_mount(ServiceConfig config, service::Runtime& runtime) {
  config.validate();
  if (!config.base.from_tf()) return config;
  constexpr std::chrono::milliseconds kStep{50};
  constexpr std::size_t kQueue = 64;
  const std::string base = runtime.bus.frame(config.base.frame);
  const auto queue = std::make_shared<Transforms>(kQueue, concurrency::Overflow::kDropOldest);
  const auto reader = runtime.bus.reader<msg::TFMessage>(
      bus::topics::kTfStatic, [queue](const std::shared_ptr<const msg::TFMessage>& message) { queue->push(*message); });
  geometry::TransformLog log;
  service::RateLimit progress(std::chrono::seconds(2));
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(config.base.tf_timeout_s);
  const auto camera_frame = [&] { return service::camera_frame(runtime.heartbeat, runtime.bus, config.camera_frame); };
  // A camera that waits for its driver does not know the name yet, and ends by itself when the driver does not come.
  const auto may_be_named = [&] {
    return runtime.heartbeat.alive("camera") && !service::knows_camera_frame(runtime.heartbeat, config.camera_frame);
  };
  std::string camera = camera_frame();
  for (std::string missing; !(missing = missing_between(base, camera, log)).empty(); camera = camera_frame()) {
    if (runtime.stop.stop_requested()) {
      config.base.camera = "0,0,0,0,0,0,1";  // the service ends before its first frame
      return config;
    }
    if (std::chrono::steady_clock::now() > end && !may_be_named()) {
      throw service::ConfigError(fmt::format(
          "slam.base.camera=tf: {} on rt/tf_static after {:g} s. Does a robot_state_publisher run in this domain, and "
          "are the frames those of slam.base.frame and slam.camera_frame? Or give the mount as "
          "--camera-in-base x,y,z,qx,qy,qz,qw",
          missing + frames_of(log), config.base.tf_timeout_s));
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
