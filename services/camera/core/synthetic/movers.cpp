// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/core/synthetic/movers.hpp"

#include <algorithm>
#include <cmath>

namespace rtd::camera::synthetic {
namespace {

using Eigen::Vector3f;

constexpr float kTwoPi = 6.2831853F;
constexpr float kWalkingSpeedMS = 1.2F, kCarryingSpeedMS = 0.9F;
constexpr float kSmallestPaintM = 0.56F;

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

Walker::Walker(std::uint64_t seed, const WalkArea& area, std::vector<Texture>& textures)
    : path_(seed, area, kWalkingSpeedMS), figure_(seed, textures) {}

void Walker::append_to(Geometry& geometry, double t_s) const {
  Posture posture;
  posture.position_m = path_.position_m(t_s);
  posture.heading_rad = path_.heading_rad(t_s);
  posture.swing = static_cast<float>(std::sin(figure_.step_rate_rad_s() * t_s));
  figure_.append_to(geometry, posture);
}

int paint_box(SeededRandom& random, const Vector3f& size_m, std::vector<Texture>& textures) {
  const TextureStyle style{vivid_color(random), 10, 50, 0.05F, 0.3F, 0.9F};
  const float side_m = std::max(kSmallestPaintM, size_m.maxCoeff());
  return add_mover_texture(textures, side_m, side_m, style, random.next());
}

void MovingBox::append_to(Geometry& geometry, const Vector3f& position_m, float turned_rad) const {
  Cuboid cuboid;
  cuboid.T_world_cuboid.translation() = position_m;
  cuboid.T_world_cuboid.linear() = Eigen::AngleAxisf(turned_rad, Vector3f::UnitZ()).toRotationMatrix();
  cuboid.size_m = size_m;
  cuboid.texture = texture;
  cuboid.moving = true;
  cuboid.object = geometry.add_object("box");
  for (const Face& face : outer_faces(cuboid)) geometry.faces.push_back(face);
}

CarriedBox::CarriedBox(std::uint64_t seed, const WalkArea& area, std::vector<Texture>& textures)
    : path_(seed, area, kCarryingSpeedMS) {
  SeededRandom random(seed ^ 0xB0BULL);
  box_.size_m = Vector3f(random.between(0.3F, 0.55F), random.between(0.3F, 0.55F), random.between(0.3F, 0.5F));
  height_m_ = random.between(0.75F, 1.15F);
  turn_rate_rad_s_ = random.between(-0.7F, 0.7F);
  phase_rad_ = kTwoPi * random.unit();
  box_.texture = paint_box(random, box_.size_m, textures);
}

void CarriedBox::append_to(Geometry& geometry, double t_s) const {
  const Eigen::Vector2f position_m = path_.position_m(t_s);
  const float bob_m = 0.12F * static_cast<float>(std::sin(2.1 * t_s + phase_rad_));
  box_.append_to(geometry, {position_m.x(), position_m.y(), height_m_ + bob_m},
                 static_cast<float>(turn_rate_rad_s_ * t_s) + phase_rad_);
}

}  // namespace rtd::camera::synthetic
