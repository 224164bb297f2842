// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/camera/synthetic/geometry.hpp"
#include "common/camera/synthetic/texture.hpp"

namespace rtd::camera::synthetic {

/// The textures of a drawn person, as indices. All wrap round their ellipsoids.
struct PersonTextures {
  int head = 0, hair = 0, skin = 0;
  int chest = 0;  ///< front and back of what is worn above: buttons, a print, stripes, or an open jacket
  int cloth = 0;  ///< the same without them
  int forearm = 0;
  int hips = 0, leg = 0, shoe = 0;
};

/// Draws face, hair and clothes of a person, all chosen by the seed; adds them to `textures`.
PersonTextures draw_person(std::uint64_t seed, float breadth, std::vector<Texture>& textures);

inline constexpr float kSeatHeightM = 0.45F;

/// How a figure stands or sits at one moment.
struct Posture {
  Eigen::Vector2f position_m = Eigen::Vector2f::Zero();  ///< on the floor, between the feet of a standing figure
  float raised_m = 0;                                    ///< above the floor, as on a step
  float heading_rad = 0;                                 ///< where it looks, from x towards y
  float swing = 0;                                       ///< of the limbs, [-1, 1]; 0 = at rest
  float seated = 0;                                      ///< 1 = sits, 0 = stands; the feet stay where they are
  float fidget_rad = 0;                                  ///< of the arms and the head, moves them alone
  bool body_moves = true;                                ///< torso, hips and legs
  bool limbs_move = true;                                ///< arms and head
};

/// Plain: few ellipsoids with noise and patches on them. Drawn: a person with face, hair, hands, joints and clothes.
enum class FigureLook { kPlain, kDrawn };

/// What a figure looks like, painted by its seed: a person of ellipsoids (head, torso, hips, arms, legs).
class Figure {
 public:
  /// Adds its textures to `textures`. `breadth` scales it from side to side: a wide coat.
  Figure(std::uint64_t seed, FigureLook look, std::vector<Texture>& textures, float breadth = 1);
  /// Adds an object of class "person".
  void append_to(Geometry& geometry, const Posture& posture) const;
  float step_rate_rad_s() const { return step_rate_rad_s_; }

 private:
  struct Placing;
  void paint_plain(SeededRandom& random, std::vector<Texture>& textures);
  void append_upper_body(Placing& placing, const Posture& posture) const;
  void append_standing_legs(Placing& placing, float swing) const;
  void append_bent_legs(Placing& placing, float thigh_rad) const;

  void append_drawn_trunk(Placing& placing, const Posture& posture) const;
  void append_drawn_limbs(Placing& placing, const Posture& posture) const;

  float height_scale_, breadth_, step_rate_rad_s_;
  int skin_texture_ = 0, shirt_texture_ = 0, trousers_texture_ = 0;
  std::optional<PersonTextures> drawn_;  ///< instead of these
};

/// A colour that is neither black nor white.
ColorBgr vivid_color(SeededRandom& random);

}  // namespace rtd::camera::synthetic
