// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/core/synthetic/scene.hpp"

#include "services/camera/core/synthetic/staged_movers.hpp"

namespace rtd::camera::synthetic {
namespace {

constexpr int kSlowBoxes = 3;

std::vector<SceneSpec> make_catalog() {
  const SceneSpec office{"office", 2, 1};
  SceneSpec still{"static"}, box{"box", 0, 3}, crowd{"crowd", 6, 0}, tour{"tour"}, sitting{"sitting"}, fill{"fill"};
  SceneSpec approach{"approach"}, slow{"slow"}, flicker{"flicker", 2, 1};
  crowd.area = {0.7F, 1.7F, 0.55F};
  tour.motion = CameraMotion::kTour;
  sitting.plot = Plot::kSitter, sitting.frames = 600, sitting.motion = CameraMotion::kWatching;
  fill.plot = Plot::kBlocker;
  approach.plot = Plot::kAxialBox;
  slow.plot = Plot::kSlowBoxes;
  flicker.flicker = 1;
  SceneSpec corridor{"corridor"}, lookalike{"lookalike"};
  corridor.corridor = CorridorPlan{};
  corridor.fps = lookalike.fps = 10, corridor.frames = 570;
  corridor.range_m = lookalike.range_m = 4, corridor.grain = lookalike.grain = 3;
  corridor.focal_error = lookalike.focal_error = 0.02;  // as a Kinect's without calibration: what drift comes from
  lookalike.corridor = CorridorPlan{.length_m = 11, .depth_m = 11, .alike = true};
  lookalike.frames = 180;  // ends before it sees its start again
  return {office, still, box, crowd, tour, sitting, fill, approach, slow, flicker, corridor, lookalike};
}

}  // namespace

const std::vector<SceneSpec>& scene_catalog() {
  static const std::vector<SceneSpec> scenes = make_catalog();
  return scenes;
}

Scene::Scene(const SceneSpec& spec, std::uint64_t seed)
    : room_(spec.corridor ? build_corridor(*spec.corridor, seed, textures_) : build_room(seed, textures_)),
      camera_path_(spec.motion, seed),
      lighting_(spec.flicker, seed) {
  if (spec.corridor) walk_.emplace(*spec.corridor, seed);
  SeededRandom random(seed);
  for (int i = 0; i < spec.people; ++i) {
    movers_.push_back(std::make_unique<Walker>(random.next(), spec.area, textures_));
  }
  for (int i = 0; i < spec.boxes; ++i) {
    movers_.push_back(std::make_unique<CarriedBox>(random.next(), spec.area, textures_));
  }
  add_plot(spec, random);
}

void Scene::add_plot(const SceneSpec& spec, SeededRandom& random) {
  switch (spec.plot) {
    case Plot::kNone:
      return;
    case Plot::kSitter:
      movers_.push_back(std::make_unique<Sitter>(random.next(), camera_path_,
                                                 Sitter::Habits{spec.sit_s, spec.fidget_rad}, textures_));
      return;
    case Plot::kBlocker:
      movers_.push_back(std::make_unique<Blocker>(random.next(), camera_path_, textures_));
      return;
    case Plot::kAxialBox:
      movers_.push_back(std::make_unique<AxialBox>(random.next(), camera_path_, textures_));
      return;
    case Plot::kSlowBoxes:
      for (int i = 0; i < kSlowBoxes; ++i) {
        movers_.push_back(std::make_unique<SlowBox>(random.next(), spec.area, textures_));
      }
      return;
  }
}

Geometry Scene::geometry_at(double t_s) const {
  Geometry geometry{room_, {}};
  for (const std::unique_ptr<Mover>& mover : movers_) mover->append_to(geometry, t_s);
  return geometry;
}

}  // namespace rtd::camera::synthetic
