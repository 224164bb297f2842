// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/synthetic/actors.hpp"

#include <algorithm>
#include <cmath>

#include "common/camera/synthetic/geometry.hpp"

namespace rtd::camera::synthetic {
namespace {

using Eigen::Vector3f;

constexpr float kWalkingSpeedMS = 1.2F, kCarryingSpeedMS = 0.9F;
constexpr float kSmallestPaintM = 0.56F;

using Eigen::Vector2f;

constexpr double kFidgetRateRadS = 2.4;
constexpr float kCoatBreadth = 1.6F;
constexpr float kChestHeightM = 1.17F;
constexpr float kTravelM = 1.0F;  ///< of a slow box

/// 0 before begin, 1 after end, smooth between.
float progress(double t_s, double begin_s, double end_s) {
  const double x = std::clamp((t_s - begin_s) / (end_s - begin_s), 0.0, 1.0);
  return static_cast<float>(x * x * (3 - 2 * x));
}

Vector2f level(const Eigen::Vector3d& v) {
  return v.head<2>().cast<float>();
}

/// Where the camera looks on the line y = `y_m`, on average over a clip.
float mean_gaze_x_m(const CameraPath& camera, float y_m, double clip_s) {
  constexpr int kSamples = 20;
  double sum_m = 0;
  for (int i = 0; i < kSamples; ++i) {
    const Eigen::Isometry3d T_world_camera = camera.T_world_camera(clip_s * i / kSamples);
    const Eigen::Vector3d from = T_world_camera.translation(), along = T_world_camera.linear().col(2);
    sum_m += from.x() + along.x() / along.y() * (static_cast<double>(y_m) - from.y());
  }
  return static_cast<float>(sum_m / kSamples);
}

}  // namespace

FloorPath::FloorPath(std::uint64_t seed, const WalkArea& area, float speed_m_s) : area_(area) {
  SeededRandom random(seed);
  rate_x_ = speed_m_s / area.reach_x_m * random.between(0.8F, 1.1F);
  rate_y_ = rate_x_ * random.between(1.2F, 1.5F);
  phase_x_ = kTwoPiF * random.unit();
  phase_y_ = kTwoPiF * random.unit();
}

Eigen::Vector2f FloorPath::position_m(double t_s) const {
  return {area_.reach_x_m * sine(rate_x_ * t_s + phase_x_),
          area_.center_y_m + area_.reach_y_m * sine(rate_y_ * t_s + phase_y_)};
}

float FloorPath::heading_rad(double t_s) const {
  return angle_rad(area_.reach_y_m * rate_y_ * std::cos(rate_y_ * t_s + phase_y_),
                   area_.reach_x_m * rate_x_ * std::cos(rate_x_ * t_s + phase_x_));
}

Walker::Walker(std::uint64_t seed, const WalkArea& area, FigureLook look, std::vector<Texture>& textures)
    : path_(seed, area, kWalkingSpeedMS), figure_(seed, look, textures) {}

void Walker::append_to(Geometry& geometry, double t_s) const {
  Posture posture;
  posture.position_m = path_.position_m(t_s);
  posture.heading_rad = path_.heading_rad(t_s);
  posture.swing = sine(figure_.step_rate_rad_s() * t_s);
  figure_.append_to(geometry, posture);
}

int paint_box(SeededRandom& random, const Vector3f& size_m, std::vector<Texture>& textures) {
  const TextureStyle style{vivid_color(random), 10, 50, 0.05F, 0.3F, 0.9F};
  const float side_m = std::max(kSmallestPaintM, size_m.maxCoeff());
  return add_texture(textures, side_m, side_m, kFigureTexelsPerM, style, random.next());
}

void MovingBox::append_to(Geometry& geometry, const Vector3f& position_m, float turned_rad) const {
  const Cuboid cuboid{upright(position_m, turned_rad), size_m, texture, true, geometry.add_object("box")};
  for (const Face& face : outer_faces(cuboid)) geometry.faces.push_back(face);
}

CarriedBox::CarriedBox(std::uint64_t seed, const WalkArea& area, std::vector<Texture>& textures)
    : path_(seed, area, kCarryingSpeedMS) {
  SeededRandom random(seed ^ 0xB0BULL);
  const float high_m = random.between(0.3F, 0.5F), deep_m = random.between(0.3F, 0.55F);
  box_.size_m = {random.between(0.3F, 0.55F), deep_m, high_m};
  height_m_ = random.between(0.75F, 1.15F);
  turn_rate_rad_s_ = random.between(-0.7F, 0.7F);
  phase_rad_ = kTwoPiF * random.unit();
  box_.texture = paint_box(random, box_.size_m, textures);
}

void CarriedBox::append_to(Geometry& geometry, double t_s) const {
  const Eigen::Vector2f position_m = path_.position_m(t_s);
  const float bob_m = 0.12F * sine(2.1 * t_s + phase_rad_);
  box_.append_to(geometry, {position_m.x(), position_m.y(), height_m_ + bob_m},
                 static_cast<float>(turn_rate_rad_s_ * t_s) + phase_rad_);
}

Sitter::Sitter(std::uint64_t seed, const CameraPath& camera, const Habits& habits, FigureLook look,
               std::vector<Texture>& textures)
    : figure_(seed, look, textures), habits_(habits) {
  SeededRandom random(seed ^ 0x517ULL);
  const float y_m = random.between(0.2F, 0.5F);
  const double clip_s = habits.sit_s + kRiseS + kWalkS + 4;
  feet_m_ = {std::clamp(mean_gaze_x_m(camera, y_m, clip_s), -0.9F, 0.9F), y_m};
  heading_rad_ = -kPiF / 2 + random.between(-0.7F, 0.7F);  // towards the camera, more or less
  turned_end_rad_ = random.between(1.85F, 2.15F) * kPiF;
  reach_x_m_ = random.between(0.5F, 0.8F) * (random.unit() < 0.5F ? -1.0F : 1.0F);
  reach_y_m_ = random.between(0.1F, 0.2F);
  const TextureStyle wood{vivid_color(random), 9, 30, 0.04F, 0.2F, 0.6F};
  chair_texture_ = add_texture(textures, 0.6F, 0.6F, kFigureTexelsPerM, wood, random.next());
}

/// The walk follows an ellipse that begins and ends at rest.
Posture Sitter::posture_at(double t_s) const {
  const double walk_s = habits_.sit_s + kRiseS, stop_s = walk_s + kWalkS;
  const float turned_rad = turned_end_rad_ * progress(t_s, walk_s, stop_s);
  const bool walks = t_s >= walk_s && t_s < stop_s;
  Posture posture;
  posture.position_m = feet_m_ + Vector2f(reach_x_m_ * sine(turned_rad), reach_y_m_ * (cosine(turned_rad) - 1));
  const float along_rad = angle_rad(-reach_y_m_ * sine(turned_rad), reach_x_m_ * cosine(turned_rad));
  const float turn_rad = std::remainder(along_rad - heading_rad_, kTwoPiF);
  posture.heading_rad = heading_rad_ + turn_rad * progress(t_s, walk_s - 0.5, walk_s + 0.5);
  posture.seated = 1 - progress(t_s, habits_.sit_s, walk_s);
  posture.swing = walks ? sine(figure_.step_rate_rad_s() * (t_s - walk_s)) * progress(t_s, walk_s, walk_s + 0.5) *
                              (1 - progress(t_s, stop_s - 0.5, stop_s))
                        : 0;
  posture.body_moves = t_s >= habits_.sit_s && t_s < stop_s;
  posture.fidget_rad = posture.body_moves ? 0 : static_cast<float>(habits_.fidget_rad) * sine(kFidgetRateRadS * t_s);
  posture.limbs_move = posture.body_moves || habits_.fidget_rad > 0;
  return posture;
}

void Sitter::append_chair(Geometry& geometry) const {
  const Vector2f back = -Vector2f(cosine(heading_rad_), sine(heading_rad_));
  const int object = geometry.add_object("chair");
  const auto add = [&](float behind_feet_m, float height_m, const Vector3f& size_m) {
    const Vector2f at = feet_m_ + behind_feet_m * back;
    const Cuboid part{upright({at.x(), at.y(), height_m}, heading_rad_), size_m, chair_texture_, false, object};
    for (const Face& face : outer_faces(part)) geometry.faces.push_back(face);
  };
  add(0.42F, kSeatHeightM - 0.15F, {0.46F, 0.48F, 0.06F});  // seat, below hips of 0.17 m
  for (const float side : {0.24F, 0.60F}) add(side, 0, {0.05F, 0.44F, kSeatHeightM - 0.15F});
  add(0.66F, kSeatHeightM - 0.15F, {0.05F, 0.48F, 0.62F});
}

void Sitter::append_to(Geometry& geometry, double t_s) const {
  append_chair(geometry);
  figure_.append_to(geometry, posture_at(t_s));
}

Blocker::Blocker(std::uint64_t seed, const CameraPath& camera, FigureLook look, std::vector<Texture>& textures)
    : camera_(camera), figure_(seed, look, textures, kCoatBreadth) {
  SeededRandom random(seed ^ 0xB10CULL);
  nearest_m_ = random.between(0.68F, 0.75F);
  farthest_m_ = random.between(2.6F, 3.0F);
}

void Blocker::append_to(Geometry& geometry, double t_s) const {
  const float near = progress(t_s, kComesS, kThereS) * (1 - progress(t_s, kGoesS, kGoneS));
  const Eigen::Isometry3d T_world_camera = camera_.T_world_camera(t_s);
  const Vector2f forward = level(T_world_camera.linear().col(2)).normalized();
  const Vector2f to_the_side(forward.y(), -forward.x());
  const float walks = std::min(1.0F, 4 * near * (1 - near) + (near < 0.5F ? 0.5F : 0.0F));
  const float sway = sine(figure_.step_rate_rad_s() * t_s);
  Posture posture;
  posture.position_m = level(T_world_camera.translation()) +
                       (farthest_m_ + (nearest_m_ - farthest_m_) * near) * forward +
                       ((1 - near) * 0.5F * sine(0.9 * t_s) + 0.02F * sine(1.7 * t_s)) * to_the_side;
  const Eigen::Vector3d gaze_m = T_world_camera * Eigen::Vector3d(0, 0, static_cast<double>(nearest_m_));
  posture.raised_m = near * std::clamp(static_cast<float>(gaze_m.z()) - kChestHeightM, -0.3F, 0.4F);
  posture.heading_rad = angle_rad(-forward.y(), -forward.x()) + 0.12F * sine(0.8 * t_s);
  posture.swing = (0.05F + 0.95F * walks) * sway;
  figure_.append_to(geometry, posture);
}

AxialBox::AxialBox(std::uint64_t seed, const CameraPath& camera, std::vector<Texture>& textures) : camera_(camera) {
  SeededRandom random(seed ^ 0xA51ULL);
  const float width_m = random.between(0.45F, 0.7F), depth_m = random.between(0.3F, 0.5F);
  box_.size_m = {width_m, depth_m, random.between(0.4F, 0.55F)};
  rate_rad_s_ = random.between(0.7F, 1.1F);
  phase_rad_ = kTwoPiF * random.unit();
  turned_rad_ = random.between(-0.5F, 0.5F);
  const float right_m = random.between(-0.15F, 0.15F);
  offset_camera_m_ = {right_m, random.between(-0.1F, 0.1F), 0};
  box_.texture = paint_box(random, box_.size_m, textures);
}

void AxialBox::append_to(Geometry& geometry, double t_s) const {
  constexpr float kMiddleM = 1.75F, kReachM = 0.75F;
  const Vector3f middle_camera_m =
      offset_camera_m_ + Vector3f(0, 0, kMiddleM + kReachM * sine(rate_rad_s_ * t_s + phase_rad_));
  const Vector3f middle_m = (camera_.T_world_camera(t_s) * middle_camera_m.cast<double>()).cast<float>();
  box_.append_to(geometry, middle_m - Vector3f(0, 0, box_.size_m.z() / 2), turned_rad_);
}

SlowBox::SlowBox(std::uint64_t seed, const WalkArea& area, std::vector<Texture>& textures) {
  SeededRandom random(seed ^ 0x510ULL);
  const float width_m = random.between(0.4F, 0.7F), depth_m = random.between(0.3F, 0.5F);
  box_.size_m = {width_m, depth_m, random.between(0.4F, 0.6F)};
  const float x_m = random.between(-0.7F, 0.7F) * area.reach_x_m;
  const float y_m = area.center_y_m + random.between(-0.7F, 0.7F) * area.reach_y_m;
  middle_m_ = {x_m, y_m, random.between(0.7F, 1.1F)};
  speed_m_s_ = random.between(kSlowestMS, kFastestMS);
  phase_m_ = 2 * kTravelM * random.unit();
  turned_rad_ = random.between(-0.6F, 0.6F);
  box_.texture = paint_box(random, box_.size_m, textures);
}

void SlowBox::append_to(Geometry& geometry, double t_s) const {
  const float way_m = std::fmod(speed_m_s_ * static_cast<float>(t_s) + phase_m_, 2 * kTravelM);
  const float along_m = std::abs(way_m - kTravelM) - kTravelM / 2;
  box_.append_to(geometry, middle_m_ + Vector3f(along_m, 0, 0), turned_rad_);
}

}  // namespace rtd::camera::synthetic
