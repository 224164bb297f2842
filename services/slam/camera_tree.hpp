// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "common/service/runtime.hpp"
#include "services/slam/config.hpp"
#include "services/slam/robot_base.hpp"

namespace rtd::slam {

/// The camera in tf: its optical frame as the images name it, and the frame above it that nothing else is above. A
/// driver publishes on `rt/tf_static` where its optical frame is in its housing; tf allows each frame one parent, so
/// `odom` has to lead to the housing, or the two trees fall apart. One thread.
class CameraTree {
 public:
  struct Camera {
    std::string frame;
    /// With T_root_camera; empty where the optical frame itself has no parent, or the robot's base is configured.
    std::optional<RobotBase> root;
  };

  CameraTree(const ServiceConfig& config, service::Runtime& runtime);
  /// As known now. The first time it waits a moment for a camera that has not said yet how its frame is called.
  const Camera& camera();

 private:
  struct Transforms;

  void await_name() const;
  std::optional<RobotBase> find_root(const std::string& frame) const;

  const std::string configured_, map_, odom_;
  const bool base_given_;
  service::Runtime& runtime_;
  const std::shared_ptr<Transforms> transforms_;
  bus::Reader<msg::TFMessage> reader_;
  Camera camera_;
  std::uint64_t revision_ = 0;  ///< of the transforms that camera_ goes by
};

}  // namespace rtd::slam
