// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "services/slam/core/slam_config.hpp"

namespace rtd::slam {

/// Where the map comes from and goes to.
struct MapFileConfig {
  std::string load, save;
  std::string folder;
  double checkpoint_s = 30;

  void bind(auto& binder) {
    binder.field("load", load, "map file to continue; empty: a new map");
    binder.field("save", save, "map file to write at checkpoints and at the end; empty: none");
    binder.field("folder", folder,
                 "folder of the maps that slam/save_map and slam/load_map may name (--maps-dir); empty: that of "
                 "map.save, else out, else $STATE_DIRECTORY");
    binder.field("checkpoint_s", checkpoint_s, {0.0, 86400.0}, "time between two checkpoints; 0: only at the end");
  }
};

/// The robot that carries the camera; without it all poses are those of the camera.
struct BaseConfig {
  std::string frame = "base_link";
  std::string camera;
  std::string gravity = "level";
  int gravity_wait_frames = 30;
  double tf_timeout_s = 10;
  bool publish_camera = true;

  void bind(auto& binder) {
    binder.field("frame", frame, "frame of the robot in odometry, poses and tf, when base.camera is given");
    binder.field("camera", camera,
                 "where the camera's optical frame is in the base: x,y,z,qx,qy,qz,qw, or tf: as rt/tf_static says; "
                 "empty: poses of the camera. The map then begins at the base, with z up");
    binder.choice("gravity", gravity, {"level", "floor", "imu"},
                  "what is up in a new map: as the base (or the camera) is turned when it begins, the floor that the "
                  "camera sees, or an IMU. With floor and imu z is up also without a base",
                  {{"told", "level"}});
    binder.field("gravity_wait_frames", gravity_wait_frames, {0, 10000},
                 "so many frames may pass before the first map begins without having seen what is up");
    binder.field("tf_timeout_s", tf_timeout_s, {0.1, 3600.0}, "camera=tf: how long to wait for rt/tf_static");
    binder.field("publish_camera", publish_camera, "tf also has base -> camera; off where a robot description has it");
  }
  bool given() const { return !camera.empty(); }
  bool from_tf() const { return camera == "tf"; }
  bool z_up() const { return given() || gravity != "level"; }
};

/// The topics of an IMU and of the wheels.
struct MotionTopics {
  std::string imu, wheels;  ///< ROS names; empty: none
  std::string imu_mount, imu_mount_in_base;
  bool given() const { return !imu.empty() || !wheels.empty(); }
};

/// Section `slam` of the configuration.
struct ServiceConfig {
  SlamConfig core;  ///< without what core_config() adds
  std::string vocabulary_file;
  MapFileConfig map;
  BaseConfig base;
  MotionTopics motion;
  std::string out_dir;
  std::string map_frame = "map";
  std::string odom_frame = "odom";
  std::string camera_frame = "camera_color_optical_frame";
  int path_length = 2000;
  int path_period_ms = 500;
  int map_period_ms = 1000;
  int map_changes_period_ms = 500;

  void bind(auto& binder) {
    binder.section("techniques", core.techniques);
    binder.section("sensor", core.sensor);
    binder.section("tracker", core.tracker);
    binder.section("prediction", core.prediction);
    binder.section("prior", core.prior);
    binder.section("imu", core.imu);
    binder.field("imu.topic", motion.imu, "topic of an IMU beside the camera, sensor_msgs/Imu; empty: none");
    binder.field("imu.mount", motion.imu_mount,
                 "where the IMU is in the camera's optical frame: x,y,z,qx,qy,qz,qw; empty: in it, with its axes");
    binder.field("imu.mount_in_base", motion.imu_mount_in_base,
                 "the same in the robot's base, when base.camera is given; in place of imu.mount");
    binder.section("wheel", core.wheel);
    binder.field("wheel.topic", motion.wheels,
                 "topic of a wheel odometry, nav_msgs/Odometry; needs base.camera; empty: none");
    binder.section("consistency", core.consistency);
    binder.section("keyframe", core.keyframe);
    binder.section("mapper", core.mapper);
    binder.section("place", core.place);
    binder.field("place.vocabulary", vocabulary_file, "file of rtd-train-vocabulary; empty: the built-in one");
    binder.section("loop", core.loop);
    binder.section("map", map);
    binder.section("base", base);
    binder.field("map.localize_only", core.localize_only, "find poses in the loaded map and leave it as it is");
    binder.field("out", out_dir,
                 "folder for trajectory.txt, keyframes.txt and map.ply, written at the end; empty: none");
    binder.field("map_frame", map_frame, "frame of the poses and of the map");
    binder.field("odom_frame", odom_frame, "frame of the odometry: smooth, map -> odom takes up the corrections");
    binder.field("camera_frame", camera_frame, "child frame of the poses: optical");
    binder.field("path_length", path_length, {1, 1000000}, "poses kept for rt/slam/path");
    binder.field("path_period_ms", path_period_ms, {1, 60000}, "time between two path messages");
    binder.field("map_period_ms", map_period_ms, {1, 60000}, "time between two clouds on rt/slam/map_points");
    binder.field("map_changes_period_ms", map_changes_period_ms, {1, 60000},
                 "time between two updates on rtd/map, while it has a reader");
  }
  /// Throws service::ConfigError for keys that contradict each other.
  void validate() const;
};

/// The folder of the maps that commands may name; "": none. `state_folder`: of a service of systemd, or "".
std::string maps_folder(const ServiceConfig& config, const std::string& state_folder);

/// The configuration of the core, with the vocabulary of `vocabulary_file` and the first pose that `base` gives, in
/// which tf has been replaced by what it says. Throws service::ConfigError naming the file when it cannot be read or is
/// damaged.
SlamConfig core_config(const ServiceConfig& config);

}  // namespace rtd::slam
