// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "services/camera/core/synthetic/camera_path.hpp"
#include "services/camera/core/synthetic/movers.hpp"
#include "services/camera/core/synthetic/room.hpp"

namespace rtd::camera::synthetic {

/// What is in a scene beside the room.
struct SceneSpec {
  std::string name;
  int people = 0, boxes = 0;
  CameraMotion motion = CameraMotion::kHandHeld;
  WalkArea area;
};

/// The scenes that have a name: office, static, box, crowd, tour.
const std::vector<SceneSpec>& scene_catalog();

/// The world of a synthetic source; everything is a pure function of seed and time.
class Scene {
 public:
  Scene(const SceneSpec& spec, std::uint64_t seed);
  Geometry geometry_at(double t_s) const;
  Eigen::Isometry3d T_world_camera(double t_s) const { return camera_path_.T_world_camera(t_s); }
  const std::vector<Texture>& textures() const { return textures_; }

 private:
  std::vector<Texture> textures_;
  std::vector<Face> room_;
  std::vector<Person> people_;
  std::vector<CarriedBox> boxes_;
  CameraPath camera_path_;
};

}  // namespace rtd::camera::synthetic
