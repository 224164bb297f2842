// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/core/synthetic/scene.hpp"

#include "services/camera/core/synthetic/seeded_random.hpp"

namespace rtd::camera::synthetic {

const std::vector<SceneSpec>& scene_catalog() {
  static const std::vector<SceneSpec> scenes = {{"office", 2, 1, CameraMotion::kHandHeld, {}},
                                                {"static", 0, 0, CameraMotion::kHandHeld, {}},
                                                {"box", 0, 3, CameraMotion::kHandHeld, {}},
                                                {"crowd", 6, 0, CameraMotion::kHandHeld, {0.95F, 2.3F, 0.55F}},
                                                {"tour", 0, 0, CameraMotion::kTour, {}}};
  return scenes;
}

Scene::Scene(const SceneSpec& spec, std::uint64_t seed)
    : room_(build_room(seed, textures_)), camera_path_(spec.motion, seed) {
  SeededRandom random(seed);
  for (int i = 0; i < spec.people; ++i) people_.emplace_back(random.next(), spec.area, textures_);
  for (int i = 0; i < spec.boxes; ++i) boxes_.emplace_back(random.next(), spec.area, textures_);
}

Geometry Scene::geometry_at(double t_s) const {
  Geometry geometry{room_, {}};
  for (const Person& person : people_) person.append_to(geometry, t_s);
  for (const CarriedBox& box : boxes_) box.append_to(geometry, t_s);
  return geometry;
}

}  // namespace rtd::camera::synthetic
