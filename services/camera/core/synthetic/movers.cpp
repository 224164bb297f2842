// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/core/synthetic/movers.hpp"

#include <cmath>

#include "services/camera/core/synthetic/seeded_random.hpp"

namespace rtd::camera::synthetic {
namespace {

using Eigen::Vector3f;

constexpr float kTwoPi = 6.2831853F;
constexpr float kWalkingSpeedMS = 1.2F, kCarryingSpeedMS = 0.9F;
constexpr float kFigureTexelsPerM = 256;

/// One ellipsoid of a figure, person frame: x forward, y left, z up, origin between the feet.
struct BodyPart {
  Vector3f center_m, semi_axes_m;
  float swing_rad;       ///< amplitude about the joint's left-right axis
  float joint_height_m;  ///< z of the joint
};
constexpr float kLegSwingRad = 0.42F, kArmSwingRad = 0.5F;

void append_part(Geometry& geometry, const Eigen::Isometry3f& T_world_person, float scale, const BodyPart& part,
                 float swing, int texture, int object) {
  const Vector3f joint(part.center_m.x(), part.center_m.y(), part.joint_height_m);
  Eigen::Isometry3f T_person_body = Eigen::Isometry3f::Identity();
  T_person_body.linear() = Eigen::AngleAxisf(swing * part.swing_rad, Vector3f::UnitY()).toRotationMatrix();
  T_person_body.translation() = scale * (joint + T_person_body.linear() * (part.center_m - joint));
  geometry.ellipsoids.push_back({T_world_person * T_person_body, scale * part.semi_axes_m, texture, true, object});
}

int add_texture(std::vector<Texture>& textures, Texture texture) {
  textures.push_back(std::move(texture));
  return static_cast<int>(textures.size()) - 1;
}

ColorBgr vivid(SeededRandom& random) {
  return {random.between(30, 200), random.between(30, 200), random.between(30, 200)};
}

}  // namespace

FloorPath::FloorPath(std::uint64_t seed, const WalkArea& area, float speed_m_s) : area_(area) {
  SeededRandom random(seed);
  rate_x_ = speed_m_s / area.reach_x_m * random.between(0.8F, 1.1F);
  rate_y_ = rate_x_ * random.between(1.2F, 1.5F);
  phase_x_ = kTwoPi * random.unit();
  phase_y_ = kTwoPi * random.unit();
}

Eigen::Vector2f FloorPath::position_m(double t_s) const {
  const auto t = static_cast<double>(t_s);
  return {area_.reach_x_m * static_cast<float>(std::sin(rate_x_ * t + phase_x_)),
          area_.center_y_m + area_.reach_y_m * static_cast<float>(std::sin(rate_y_ * t + phase_y_))};
}

float FloorPath::heading_rad(double t_s) const {
  return static_cast<float>(std::atan2(area_.reach_y_m * rate_y_ * std::cos(rate_y_ * t_s + phase_y_),
                                       area_.reach_x_m * rate_x_ * std::cos(rate_x_ * t_s + phase_x_)));
}

Person::Person(std::uint64_t seed, const WalkArea& area, std::vector<Texture>& textures)
    : path_(seed, area, kWalkingSpeedMS) {
  SeededRandom random(seed ^ 0x9E450AULL);
  height_scale_ = random.between(0.92F, 1.08F);
  step_rate_rad_s_ = kTwoPi * random.between(0.8F, 1.0F);
  const TextureStyle skin{{120, 150, 205}, 5, 25, 0.02F, 0.05F, 0.15F};
  const TextureStyle shirt{vivid(random), 9, 45, 0.04F, 0.25F, 0.75F};
  const TextureStyle trousers{vivid(random), 9, 30, 0.03F, 0.12F, 0.35F};
  skin_texture_ = add_texture(textures, paint_texture(0.25F, 0.3F, kFigureTexelsPerM, skin, random.next()));
  shirt_texture_ = add_texture(textures, paint_texture(0.6F, 0.75F, kFigureTexelsPerM, shirt, random.next()));
  trousers_texture_ = add_texture(textures, paint_texture(0.25F, 0.9F, kFigureTexelsPerM, trousers, random.next()));
}

void Person::append_to(Geometry& geometry, double t_s) const {
  const Eigen::Vector2f position_m = path_.position_m(t_s);
  Eigen::Isometry3f T_world_person = Eigen::Isometry3f::Identity();
  T_world_person.translation() = Vector3f(position_m.x(), position_m.y(), 0);
  T_world_person.linear() = Eigen::AngleAxisf(path_.heading_rad(t_s), Vector3f::UnitZ()).toRotationMatrix();
  const auto swing = static_cast<float>(std::sin(step_rate_rad_s_ * t_s));
  const int object = geometry.add_object("person");
  const auto add = [&](const BodyPart& part, float signed_swing, int texture) {
    append_part(geometry, T_world_person, height_scale_, part, signed_swing, texture, object);
  };
  add({{0.02F, 0, 1.62F}, {0.105F, 0.085F, 0.135F}, 0, 0}, 0, skin_texture_);  // head
  add({{0, 0, 1.46F}, {0.055F, 0.055F, 0.10F}, 0, 0}, 0, skin_texture_);       // neck
  add({{0, 0, 1.17F}, {0.14F, 0.225F, 0.33F}, 0, 0}, 0, shirt_texture_);       // torso
  add({{0, 0, 0.90F}, {0.145F, 0.19F, 0.17F}, 0, 0}, 0, trousers_texture_);    // hips
  for (const float side : {-1.0F, 1.0F}) {
    add({{0, side * 0.10F, 0.44F}, {0.085F, 0.08F, 0.45F}, kLegSwingRad, 0.86F}, side * swing, trousers_texture_);
    add({{0, side * 0.26F, 1.12F}, {0.05F, 0.05F, 0.31F}, kArmSwingRad, 1.40F}, -side * swing, shirt_texture_);
  }
}

CarriedBox::CarriedBox(std::uint64_t seed, const WalkArea& area, std::vector<Texture>& textures)
    : path_(seed, area, kCarryingSpeedMS) {
  SeededRandom random(seed ^ 0xB0BULL);
  size_m_ = Vector3f(random.between(0.3F, 0.55F), random.between(0.3F, 0.55F), random.between(0.3F, 0.5F));
  height_m_ = random.between(0.75F, 1.15F);
  turn_rate_rad_s_ = random.between(-0.7F, 0.7F);
  phase_rad_ = kTwoPi * random.unit();
  const TextureStyle style{vivid(random), 10, 50, 0.05F, 0.3F, 0.9F};
  texture_ = add_texture(textures, paint_texture(0.56F, 0.56F, kFigureTexelsPerM, style, random.next()));
}

void CarriedBox::append_to(Geometry& geometry, double t_s) const {
  const Eigen::Vector2f position_m = path_.position_m(t_s);
  const float bob_m = 0.12F * static_cast<float>(std::sin(2.1 * t_s + phase_rad_));
  Cuboid box;
  box.T_world_cuboid.translation() = Vector3f(position_m.x(), position_m.y(), height_m_ + bob_m);
  box.T_world_cuboid.linear() =
      Eigen::AngleAxisf(static_cast<float>(turn_rate_rad_s_ * t_s) + phase_rad_, Vector3f::UnitZ()).toRotationMatrix();
  box.size_m = size_m_;
  box.texture = texture_;
  box.moving = true;
  box.object = geometry.add_object("box");
  for (const Face& face : outer_faces(box)) geometry.faces.push_back(face);
}

}  // namespace rtd::camera::synthetic
