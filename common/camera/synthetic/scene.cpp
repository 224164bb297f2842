// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/synthetic/scene.hpp"

#include <algorithm>
#include <cmath>

#include "common/camera/synthetic/actors.hpp"
#include "common/camera/synthetic/camera_path.hpp"
#include "common/camera/synthetic/texture.hpp"

namespace rtd::camera::synthetic {
namespace {

using Eigen::Vector3f;

constexpr double kBendM = 0.9;  ///< radius of the walk round a corner
constexpr int kSides = 4;
constexpr float kCorridorWallTexelsPerM = 160, kCorridorFloorTexelsPerM = 96;

/// One side of the corridor. Frame: origin at the outer corner where the side begins, x along the walk (counter-
/// clockwise), y inwards, z up. It covers the square of its first corner, the next side that of its last.
struct Side {
  Eigen::Isometry3f T_world_side;
  float outer_m;  ///< length of its outer wall
};

Side make_side(const CorridorPlan& plan, int index) {
  const double turned_rad = index * kPi / 2;
  const bool along = index % 2 == 0;
  const double own_m = (along ? plan.length_m : plan.depth_m) + plan.width_m;
  const double other_m = (along ? plan.depth_m : plan.length_m) + plan.width_m;
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = Eigen::AngleAxisd(turned_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  T.translation() = T.linear() * Eigen::Vector3d(-own_m / 2, -other_m / 2, 0);
  return {T.cast<float>(), static_cast<float>(own_m)};
}

/// Dull paint with few patches: a corridor has less to hold on to than a room.
TextureStyle dull_style(SeededRandom& random, float patches_per_m2) {
  const float brightness = random.between(100, 180);
  const auto channel = [&] { return brightness + random.between(-14, 14); };
  const float b = channel(), g = channel();
  return {{b, g, channel()}, random.between(4, 7), patches_per_m2, 0.05F, 0.5F, random.between(0.4F, 0.8F)};
}

/// Builds sides out of faces whose textures come from one random sequence: equal sequences, equal sides.
class SideBuilder {
 public:
  SideBuilder(const CorridorPlan& plan, std::vector<Texture>& textures, std::vector<Face>& faces)
      : plan_(plan), textures_(textures), faces_(faces) {}

  /// The textures of a side made before with the same seed are used again.
  void build(const Side& side, std::uint64_t texture_seed, int repeats) {
    side_ = &side;
    random_ = SeededRandom(texture_seed);
    if (texture_seed != painted_seed_) painted_.clear();
    painted_seed_ = texture_seed;
    next_painted_ = 0;
    const auto width = static_cast<float>(plan_.width_m), height = static_cast<float>(plan_.height_m);
    const float inner_m = side.outer_m - 2 * width;
    wall({0, 0, 0}, Vector3f::UnitX(), side.outer_m, repeats);  // x cross z = -y: turned round below
    wall({width, width, 0}, Vector3f::UnitX(), inner_m, repeats);
    floor_and_ceiling(side.outer_m - width, width, height);
    pilasters(inner_m, width, height);
  }

 private:
  int texture(float width_m, float height_m, float texels_per_m, float patches_per_m2) {
    const TextureStyle style = dull_style(random_, patches_per_m2);
    const std::uint64_t seed = random_.next();
    if (next_painted_ == painted_.size()) {
      painted_.push_back(add_texture(textures_, width_m, height_m, texels_per_m, style, seed));
    }
    return painted_[next_painted_++];
  }

  void add(const Vector3f& origin, const Vector3f& s, const Vector3f& t, float width_m, float height_m, int texture) {
    const Eigen::Matrix3f& R = side_->T_world_side.linear();
    faces_.push_back({side_->T_world_side * origin, R * s, R * t, width_m, height_m, texture, false});
  }

  /// A wall along x from `start`, in equal pieces. The outer wall (y = 0) faces inwards, the inner one outwards.
  void wall(const Vector3f& start, const Vector3f& x, float length_m, int repeats) {
    constexpr float kPatchesPerM2 = 1.3F;
    const auto height = static_cast<float>(plan_.height_m);
    const float piece_m = length_m / static_cast<float>(repeats);
    const int painted = texture(piece_m, height, kCorridorWallTexelsPerM, kPatchesPerM2);
    for (int i = 0; i < repeats; ++i) {
      const Vector3f begin = start + x * (piece_m * static_cast<float>(i));
      if (start.y() > 0) {
        add(begin, x, Vector3f::UnitZ(), piece_m, height, painted);
      } else {
        add(begin + x * piece_m, -x, Vector3f::UnitZ(), piece_m, height, painted);
      }
    }
  }

  void floor_and_ceiling(float length_m, float width, float height) {
    constexpr float kFloorPatchesPerM2 = 0.8F, kCeilingPatchesPerM2 = 0.5F;
    add({0, 0, 0}, Vector3f::UnitX(), Vector3f::UnitY(), length_m, width,
        texture(length_m, width, kCorridorFloorTexelsPerM, kFloorPatchesPerM2));
    add({0, width, height}, Vector3f::UnitX(), -Vector3f::UnitY(), length_m, width,
        texture(length_m, width, kCorridorFloorTexelsPerM, kCeilingPatchesPerM2));
  }

  /// Cabinets and pillars along both walls.
  void pilasters(float inner_m, float width, float height) {
    constexpr float kEveryM = 3.0F, kPilasterTexelsPerM = 160, kPatchesPerM2 = 4.0F;
    const int count = std::max(1, static_cast<int>(inner_m / kEveryM));
    for (int i = 0; i < count; ++i) {
      Cuboid cuboid;
      const float step_m = inner_m / static_cast<float>(count);
      const float along_m = width + step_m * (static_cast<float>(i) + random_.between(0.25F, 0.75F));
      const float thick_m = random_.between(0.15F, 0.32F);
      const bool outer = random_.unit() < 0.5F;
      cuboid.size_m = {random_.between(0.3F, 0.9F), thick_m,
                       random_.unit() < 0.4F ? height : random_.between(0.7F, 1.8F)};
      cuboid.T_world_cuboid = side_->T_world_side;
      cuboid.T_world_cuboid.translation() =
          side_->T_world_side * Vector3f(along_m, outer ? thick_m / 2 : width - thick_m / 2, 0);
      cuboid.surface.texture = texture(cuboid.size_m.x(), cuboid.size_m.z(), kPilasterTexelsPerM, kPatchesPerM2);
      for (const Face& face : outer_faces(cuboid)) faces_.push_back(face);
    }
  }

  const CorridorPlan& plan_;
  std::vector<Texture>& textures_;
  std::vector<Face>& faces_;
  const Side* side_ = nullptr;
  SeededRandom random_{0};
  std::vector<int> painted_;  ///< textures of the seed, in order of use
  std::size_t next_painted_ = 0;
  std::uint64_t painted_seed_ = 0;
};

}  // namespace

std::vector<Face> build_corridor(const CorridorPlan& plan, std::uint64_t seed, std::vector<Texture>& textures) {
  std::vector<Face> faces;
  SeededRandom random(seed ^ 0xC0221D02ULL);
  SideBuilder builder(plan, textures, faces);
  std::uint64_t side_seed = random.next();
  for (int i = 0; i < kSides; ++i) {
    builder.build(make_side(plan, i), side_seed, plan.alike && seed % 2 == 1 ? 2 : 1);
    if (!plan.alike) side_seed = random.next();
  }
  return faces;
}

CorridorWalk::CorridorWalk(const CorridorPlan& plan, std::uint64_t seed)
    : plan_(plan), lap_m_(2 * (plan.length_m + plan.depth_m) - 8 * kBendM + 2 * kPi * kBendM) {
  SeededRandom random(seed ^ 0x3A1CULL);
  for (double& phase : phases_rad_) phase = 2 * kPi * static_cast<double>(random.unit());
}

/// Starts in the middle of the first side.
CorridorWalk::Point CorridorWalk::at(double way_m) const {
  const double bend_m = kBendM * kPi / 2;
  const double lap = std::floor(way_m / lap_m_);
  double rest_m = way_m - lap * lap_m_ + plan_.length_m / 2 - kBendM;  // from the end of the bend before the first side
  int side = 0;
  double straight_m = plan_.length_m - 2 * kBendM;
  while (rest_m >= straight_m + bend_m) {
    rest_m -= straight_m + bend_m;
    straight_m = (++side % 2 == 0 ? plan_.length_m : plan_.depth_m) - 2 * kBendM;
  }
  const bool along = side % 2 == 0;
  const double own_m = along ? plan_.length_m : plan_.depth_m, other_m = along ? plan_.depth_m : plan_.length_m;
  const double bent_rad = std::max(0.0, rest_m - straight_m) / kBendM;
  const Eigen::Vector2d in_side(-own_m / 2 + kBendM + std::min(rest_m, straight_m) + kBendM * std::sin(bent_rad),
                                -other_m / 2 + kBendM * (1 - std::cos(bent_rad)));
  const double side_rad = side * kPi / 2;
  return {Eigen::Rotation2Dd(side_rad) * in_side, 2 * kPi * lap + side_rad + bent_rad};
}

/// The mean direction of the way just behind and well ahead: a walker looks into a turn before he takes it.
double CorridorWalk::looking_rad(double way_m) const {
  constexpr double kBehindM = 0.6, kAheadM = 1.8;
  constexpr int kSamples = 48;
  double sum_rad = 0;
  for (int i = 0; i < kSamples; ++i) {
    sum_rad += at(way_m - kBehindM + (kBehindM + kAheadM) * (i + 0.5) / kSamples).heading_rad;
  }
  return sum_rad / kSamples;
}

Eigen::Isometry3d CorridorWalk::T_world_camera(double t_s) const {
  constexpr double kEyeM = 1.35, kStrayM = 0.12, kBobM = 0.02, kPitchRad = -0.06, kNodRad = 0.02;
  constexpr double kStrayRateRadS = 0.5, kStepRateRadS = 5.0, kNodRateRadS = 0.9, kYawRateRadS = 0.7, kYawRad = 0.05;
  const double way_m = plan_.speed_m_s * t_s;
  const Point on_way = at(way_m);
  const auto sway = [&](std::size_t i, double rate_rad_s) { return std::sin(rate_rad_s * t_s + phases_rad_[i]); };
  const Eigen::Vector2d left(-std::sin(on_way.heading_rad), std::cos(on_way.heading_rad));
  const Eigen::Vector2d ground = on_way.position_m + kStrayM * sway(0, kStrayRateRadS) * left;
  const double yaw_rad = looking_rad(way_m) + kYawRad * sway(1, kYawRateRadS);
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() << ground, kEyeM + kBobM * sway(2, kStepRateRadS);
  T.linear() = level_camera_rotation(kPi / 2 - yaw_rad, kPitchRad + kNodRad * sway(3, kNodRateRadS), 0);
  return T;
}

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
    face.surface.texture = add_texture(textures, face.width_m, face.height_m,
                                       wall ? kRoomWallTexelsPerM : kRoomFloorTexelsPerM, style, random.next());
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
    cuboid.surface.material = piece.material;
    const float width_m = std::max(piece.size_m.x(), piece.size_m.y());
    const std::uint64_t texture_seed = random.next();
    cuboid.surface.texture = add_texture(textures, width_m, std::max(piece.size_m.z(), width_m), kFurnitureTexelsPerM,
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
