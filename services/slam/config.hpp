// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "common/service/run_settings.hpp"
#include "services/slam/core/config/slam_config.hpp"

namespace rtd::service {
struct Runtime;
}

namespace rtd::slam {

using service::BaseConfig;
using service::MapFileConfig;
using service::MotionTopics;

/// `slam.atlas`: what is shared with an atlas, if there is one.
struct AtlasConfig {
  bool ask = true;
  int bytes_per_s = 150'000;

  void bind(auto& binder) {
    binder.field("ask", ask,
                 "a robot whose map is new or whose camera is lost asks an atlas where it is; not at pace lockstep");
    binder.field("bytes_per_s", bytes_per_s, {1000, 1'000'000'000},
                 "keyframes that the atlas asks for are sent no faster");
  }
};

/// Section `slam` of the configuration.
struct ServiceConfig {
  SlamConfig core;  ///< without what core_config() adds
  std::string vocabulary_file;
  MapFileConfig map;
  BaseConfig base;
  AtlasConfig atlas;
  MotionTopics motion;
  std::string out_dir;
  std::string map_frame = "map";
  std::string odom_frame = "odom";
  std::string camera_frame;
  int path_length = 2000;
  int path_period_ms = 500;
  int map_period_ms = 1000;
  int map_changes_period_ms = 500;

  void bind(auto& binder) {
    binder.section("techniques", core.techniques);
    binder.section("sensor", core.sensor);
    binder.section("tracker", core.tracker);
    binder.section("witness", core.witness);
    binder.section("prediction", core.prediction);
    binder.section("prior", core.prior);
    binder.section("imu", core.imu);
    binder.section("wheel", core.wheel);
    motion.bind(binder);
    binder.section("consistency", core.consistency);
    binder.section("keyframe", core.keyframe);
    binder.section("mapper", core.mapper);
    binder.section("place", core.place);
    binder.field("place.vocabulary", vocabulary_file, "file of rtd-train-vocabulary; empty: the built-in one");
    binder.section("loop", core.loop);
    binder.section("map", map);
    binder.section("base", base);
    binder.section("atlas", atlas);
    service::bind_localize_only(binder, core.localize_only);
    binder
        .field("out", out_dir, "folder for trajectory.txt, keyframes.txt and map.ply, written at the end; empty: none")
        .option("--out");
    binder.field("map_frame", map_frame, "frame of the poses and of the map");
    binder.field("odom_frame", odom_frame, "frame of the odometry: smooth, map -> odom takes up the corrections");
    binder.field("camera_frame", camera_frame, "child frame of the poses, optical; empty: as the images name it");
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

/// The configuration with base.camera=tf replaced by what `rt/tf_static` says: waits until its transforms join the base
/// with the camera's optical frame, and says every few seconds what is missing. Throws service::ConfigError when
/// base.tf_timeout_s pass without. Any other configuration comes back as it is, at once.
ServiceConfig with_mount(ServiceConfig config, service::Runtime& runtime);

}  // namespace rtd::slam
