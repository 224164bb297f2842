// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "common/msg/engine_names.hpp"
#include "common/msg/filter_modes.hpp"
#include "common/service/model_locator.hpp"

/// The settings of services that are options of `rtd run`, too: the service and the launcher bind them by this, so key,
/// range, default, help and option are declared once.
namespace rtd::service {

/// `slam.map`: where the map comes from and goes to.
struct MapFileConfig {
  std::string load, save;
  std::string folder;
  double checkpoint_s = 30;

  void bind(auto& binder) {
    binder.field("load", load, "map file to continue; empty: a new map").option("--map", "Map");
    binder
        .field("save", save,
               "map file to write at checkpoints and at the end; empty: none, of rtd run map.rtdmap in the folder of "
               "--out")
        .option("--save-map", "Map");
    binder
        .field("folder", folder,
               "folder of the maps that slam/save_map and slam/load_map may name; empty: that of map.save, else out, "
               "else $STATE_DIRECTORY")
        .option("--maps-dir", "Map");
    binder.field("checkpoint_s", checkpoint_s, {0.0, 86400.0}, "time between two checkpoints; 0: only at the end");
  }
};

/// Of section `slam`.
void bind_localize_only(auto& binder, bool& value) {
  binder.field("map.localize_only", value, "only find poses in the loaded map and leave it as it is")
      .option("--localize-only", "Map");
}

/// `slam.base`: the robot that carries the camera; without it all poses are those of the camera.
struct BaseConfig {
  std::string frame = "base_link";
  std::string camera;
  std::string gravity = "level";
  int gravity_wait_frames = 30;
  double tf_timeout_s = 10;
  bool publish_camera = true;

  void bind(auto& binder) {
    binder.field("frame", frame, "frame of the robot in odometry, poses and tf, when base.camera is given")
        .option("--base-frame", "Robot");
    binder
        .field("camera", camera,
               "where the camera's optical frame is in the base: x,y,z,qx,qy,qz,qw, or tf: as rt/tf_static says; "
               "empty: poses of the camera. The map then begins at the base, with z up")
        .option("--camera-in-base", "Robot");
    binder
        .choice("gravity", gravity, {"level", "floor", "imu"},
                "what is up in a new map: as the base (or the camera) is turned when it begins, the floor that the "
                "camera sees, or an IMU. With floor and imu z is up also without a base",
                {{"told", "level"}})
        .option("--gravity", "Robot");
    binder.field("gravity_wait_frames", gravity_wait_frames, {0, 10000},
                 "so many frames may pass before the first map begins without having seen what is up");
    binder.field("tf_timeout_s", tf_timeout_s, {0.1, 3600.0}, "camera=tf: how long to wait for rt/tf_static");
    binder.field("publish_camera", publish_camera, "tf also has base -> camera; off where a robot description has it");
  }
  bool given() const { return !camera.empty(); }
  bool from_tf() const { return camera == "tf"; }
  bool z_up() const { return given() || gravity != "level"; }
};

/// Of section `slam`: the topics of an IMU and of the wheels.
struct MotionTopics {
  std::string imu, wheels;  ///< ROS names; empty: none
  std::string imu_mount, imu_mount_in_base;

  void bind(auto& binder) {
    binder
        .field("imu.topic", imu,
               "topic of an IMU next to the camera, sensor_msgs/Imu: poses continue while nothing can be seen; empty: "
               "none")
        .option("--imu", "Robot");
    binder.field("imu.mount", imu_mount,
                 "where the IMU is in the camera's optical frame: x,y,z,qx,qy,qz,qw; empty: in it, with its axes");
    binder.field("imu.mount_in_base", imu_mount_in_base,
                 "the same in the robot's base, when base.camera is given; in place of imu.mount");
    binder.field("wheel.topic", wheels, "topic of a wheel odometry, nav_msgs/Odometry; needs base.camera; empty: none")
        .option("--wheel-odometry", "Robot");
  }
  bool given() const { return !imu.empty() || !wheels.empty(); }
};

/// Of section `filter`.
void bind_filter_mode(auto& binder, std::string& mode) {
  binder.choice("mode", mode, msg::filter_mode_names(), "which parts of the filter are at work")
      .option("--filter,--mode", "Dynamic points");
}

/// Of section `filter`.
void bind_filter_detector(auto& binder, std::string& use) {
  binder.choice("detector", use, {"auto", "on", "off"},
                "auto: use a detector if one runs; on: and at asap and lockstep no frame before it is ready (rtd run "
                "sets it where it has one); off: never wait, never use");
}

/// Of section `filter`.
void bind_person_masks(auto& binder, std::string& use) {
  binder.choice("person_masks", use, {"on", "off"},
                "on: use the detector's person masks if it sends them; off: boxes alone");
}

/// Of section `detector`.
void bind_model(auto& binder, std::string& model) {
  binder
      .field("model", model,
             "the network: " + known_model_names() +
                 ", or an ONNX file: a path, or a name looked for in RTD_MODEL_DIR and the user's cache")
      .option("--model", "Dynamic points");
}
/// Of section `detector`: people as pixels.
struct MaskSettings {
  std::string use = "auto";
  std::string model;

  void bind(auto& binder) {
    binder
        .choice("masks", use, {"auto", "on", "off"},
                "people as pixels as well as boxes; auto: where the network for it is there")
        .option("--masks", "Dynamic points");
    binder
        .field("mask_model", model,
               std::string("the network for it: ") + kMaskModel.name +
                   ", or an ONNX file: a path, or a name looked for as that of model; empty: " + kMaskModel.file)
        .option("--mask-model", "Dynamic points");
  }
};
/// Of section `detector`.
void bind_engine(auto& binder, std::string& engine) {
  binder.field("engine", engine, std::string("what computes the network: ") + msg::kEngineNames)
      .option("--engine", "Dynamic points");
}

}  // namespace rtd::service
