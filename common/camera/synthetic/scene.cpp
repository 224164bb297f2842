// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/synthetic/scene.hpp"

#include <algorithm>

#include "common/camera/synthetic/actors.hpp"
#include "common/camera/synthetic/texture.hpp"

namespace rtd::camera::synthetic {
namespace {

using Eigen::Vector3f;

constexpr float kRoomWallTexelsPerM = 192, kRoomFloorTexelsPerM = 112, kFurnitureTexelsPerM = 224;

/// Where a piece of furniture stands: middle of its lower side (m), size (m), turned about the vertical (rad).
struct Furniture {
  Vector3f position_m, size_m;
  float turned_rad;
  Material material = Material::kPlain;
};
constexpr float kTableTopM = 0.62F;

const std::vector<Furniture>& furniture() {
  static const std::vector<Furniture> pieces = {
      {{-2.4F, 2.85F, 0}, {1.3F, 0.45F, 1.9F}, 0},        // shelf, front wall
      {{-0.9F, 2.75F, 0}, {1.2F, 0.6F, 0.8F}, 0},         // sideboard
      {{-1.2F, 2.75F, 0.8F}, {0.35F, 0.3F, 0.4F}, 0.3F},  // things on it
      {{-0.6F, 2.7F, 0.8F}, {0.25F, 0.2F, 0.28F}, -0.4F, Material::kMonitor},
      {{0.9F, 2.8F, 0}, {0.9F, 0.5F, 1.3F}, 0},  // cabinet
      {{0.8F, 2.75F, 1.3F}, {0.4F, 0.3F, 0.35F}, 0.2F, Material::kMonitor},
      {{2.5F, 2.7F, 0}, {1.0F, 0.7F, 1.0F}, 0.1F},  // chest
      {{2.6F, 2.7F, 1.0F}, {0.5F, 0.4F, 0.45F}, -0.3F, Material::kMonitor},
      {{-3.2F, 0.6F, 0}, {0.5F, 1.5F, 1.1F}, 0},  // left wall
      {{-3.2F, 0.2F, 1.1F}, {0.3F, 0.4F, 0.5F}, 0.5F, Material::kMonitor},
      {{-3.2F, 1.0F, 1.1F}, {0.3F, 0.3F, 0.3F}, -0.2F},
      {{3.2F, 0.7F, 0}, {0.5F, 1.3F, 1.6F}, 0},  // right wall
      {{3.1F, -1.2F, 0}, {0.6F, 1.2F, 0.75F}, 0},
      {{-3.1F, -1.6F, 0}, {0.7F, 1.0F, 0.9F}, 0.15F},
      {{-1.6F, -2.9F, 0}, {1.2F, 0.5F, 1.7F}, 0},  // rear wall
      {{1.4F, -2.9F, 0}, {1.6F, 0.5F, 0.9F}, 0},
      {{0.1F, 2.0F, 0}, {1.3F, 0.5F, kTableTopM}, 0.12F},  // low table behind the movers
      {{-0.3F, 1.95F, kTableTopM}, {0.24F, 0.18F, 0.16F}, 0.5F},
      {{0.15F, 2.05F, kTableTopM}, {0.16F, 0.22F, 0.09F}, -0.3F},
      {{0.5F, 2.0F, kTableTopM}, {0.18F, 0.14F, 0.24F}, 0.9F},
      {{-2.0F, -0.4F, 0}, {0.45F, 0.4F, 0.5F}, 0.6F},  // boxes on the floor
      {{2.1F, -0.4F, 0}, {0.5F, 0.4F, 0.55F}, -0.5F}};
  return pieces;
}

TextureStyle random_style(SeededRandom& random, float patches_per_m2) {
  const float brightness = random.between(90, 190);
  const auto channel = [&] { return brightness + random.between(-16, 16); };
  const float b = channel(), g = channel();
  return {{b, g, channel()}, random.between(5, 9), patches_per_m2, 0.04F, 0.45F, random.between(0.5F, 0.95F)};
}

/// Walls, floor and ceiling, seen from inside.
std::vector<Face> shell(SeededRandom& random, std::vector<Texture>& textures) {
  constexpr float kX = kRoomWidthM / 2, kY = kRoomDepthM / 2;
  const Vector3f x = Vector3f::UnitX(), y = Vector3f::UnitY(), z = Vector3f::UnitZ();
  std::vector<Face> faces = {{{-kX, kY, 0}, x, z, kRoomWidthM, kRoomHeightM, 0, false},   // front: x cross z = -y
                             {{kX, -kY, 0}, -x, z, kRoomWidthM, kRoomHeightM, 0, false},  // rear: +y
                             {{-kX, -kY, 0}, y, z, kRoomDepthM, kRoomHeightM, 0, false},  // left: +x
                             {{kX, kY, 0}, -y, z, kRoomDepthM, kRoomHeightM, 0, false},   // right: -x
                             {{-kX, -kY, 0}, x, y, kRoomWidthM, kRoomDepthM, 0, false},   // floor: +z
                             {{-kX, kY, kRoomHeightM}, x, -y, kRoomWidthM, kRoomDepthM, 0, false}};  // ceiling: -z
  for (Face& face : faces) {
    const bool wall = face.height_m == kRoomHeightM;
    const TextureStyle style = random_style(random, wall ? 3.0F : 2.5F);
    face.texture = add_texture(textures, face.width_m, face.height_m, wall ? kRoomWallTexelsPerM : kRoomFloorTexelsPerM,
                               style, random.next());
  }
  return faces;
}

/// The furnished room: walls, floor, ceiling, shelves and cabinets along the walls, a low table with objects on it
/// behind the movers, boxes. CameraRoom stays empty. Adds its textures to `textures`.
std::vector<Face> build_room(std::uint64_t seed, std::vector<Texture>& textures) {
  SeededRandom random(seed ^ 0x5CE4EULL);
  std::vector<Face> faces = shell(random, textures);
  for (const Furniture& piece : furniture()) {
    Cuboid cuboid{.T_world_cuboid = upright(piece.position_m, piece.turned_rad), .size_m = piece.size_m};
    cuboid.material = piece.material;
    const float width_m = std::max(piece.size_m.x(), piece.size_m.y());
    const std::uint64_t texture_seed = random.next();
    cuboid.texture = add_texture(textures, width_m, std::max(piece.size_m.z(), width_m), kFurnitureTexelsPerM,
                                 random_style(random, 12.0F), texture_seed);
    for (const Face& face : outer_faces(cuboid)) faces.push_back(face);
  }
  return faces;
}

constexpr int kSlowBoxes = 3;

std::vector<SceneSpec> make_catalog() {
  const SceneSpec office{"office", 2, 1};
  SceneSpec still{"static"}, box{"box", 0, 3}, crowd{"crowd", 6, 0}, tour{"tour"}, sitting{"sitting"}, fill{"fill"};
  SceneSpec approach{"approach"}, slow{"slow"}, flicker{"flicker", 2, 1};
  crowd.area = {0.7F, 1.7F, 0.55F};
  tour.motion = CameraMotion::kTour;
  sitting.plot = Plot::kSitter;
  sitting.frames = 600;
  sitting.motion = CameraMotion::kWatching;
  fill.plot = Plot::kBlocker;
  approach.plot = Plot::kAxialBox;
  slow.plot = Plot::kSlowBoxes;
  flicker.flicker = 1;
  SceneSpec corridor{"corridor"}, lookalike{"lookalike"};
  corridor.corridor = CorridorPlan{};
  corridor.fps = lookalike.fps = 10;
  corridor.frames = 570;
  corridor.range_m = lookalike.range_m = 4;
  corridor.grain = lookalike.grain = 3;
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

template <class M>
void Scene::add(SeededRandom& random, const auto&... of_actor) {
  actors_.push_back(std::make_unique<M>(random.next(), of_actor..., textures_));
}

Scene::Scene(const SceneSpec& spec, std::uint64_t seed)
    : room_(spec.corridor ? build_corridor(*spec.corridor, seed, textures_) : build_room(seed, textures_)),
      camera_path_(spec.motion, seed),
      lighting_(spec.flicker, seed) {
  if (spec.corridor) walk_.emplace(*spec.corridor, seed);
  SeededRandom random(seed);
  for (int i = 0; i < spec.people; ++i) add<Walker>(random, spec.area, spec.figures);
  for (int i = 0; i < spec.boxes; ++i) add<CarriedBox>(random, spec.area);
  add_plot(spec, random);
}

void Scene::add_plot(const SceneSpec& spec, SeededRandom& random) {
  switch (spec.plot) {
    case Plot::kNone:
      return;
    case Plot::kSitter:
      return add<Sitter>(random, camera_path_, Sitter::Habits{spec.sit_s, spec.fidget_rad}, spec.figures);
    case Plot::kBlocker:
      return add<Blocker>(random, camera_path_, spec.figures);
    case Plot::kAxialBox:
      return add<AxialBox>(random, camera_path_);
    case Plot::kSlowBoxes:
      for (int i = 0; i < kSlowBoxes; ++i) add<SlowBox>(random, spec.area);
      return;
  }
}

Geometry Scene::geometry_at(double t_s) const {
  Geometry geometry{room_, {}};
  for (const std::unique_ptr<Actor>& actor : actors_) actor->append_to(geometry, t_s);
  return geometry;
}

}  // namespace rtd::camera::synthetic
