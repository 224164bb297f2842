// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/synthetic/figure.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/camera/synthetic/geometry.hpp"

namespace rtd::camera::synthetic {
namespace {

constexpr float kFaceTexelsPerM = 400;
constexpr float kSkinNoise = 3, kClothNoise = 6;  ///< grey levels of each octave
constexpr ColorBgr kWhite{225, 228, 228}, kBlack{28, 26, 26}, kLips{82, 78, 150}, kLeather{45, 60, 85};

constexpr std::array<ColorBgr, 5> kSkins = {
    {{150, 178, 224}, {130, 160, 212}, {105, 140, 195}, {80, 112, 165}, {58, 80, 120}}};
constexpr std::array<ColorBgr, 5> kHairs = {
    {{24, 24, 28}, {28, 38, 55}, {40, 60, 90}, {70, 105, 140}, {110, 112, 115}}};
constexpr std::array<ColorBgr, 8> kShirts = {{{190, 190, 195},
                                              {60, 60, 66},
                                              {150, 95, 50},
                                              {55, 55, 160},
                                              {95, 120, 70},
                                              {205, 170, 130},
                                              {80, 145, 200},
                                              {120, 80, 110}}};
constexpr std::array<ColorBgr, 5> kTrousers = {
    {{105, 70, 45}, {52, 50, 50}, {80, 110, 135}, {75, 80, 85}, {140, 110, 80}}};

template <std::size_t N>
const ColorBgr& any_of(const std::array<ColorBgr, N>& colors, SeededRandom& random) {
  return colors[static_cast<std::size_t>(random.index(static_cast<int>(N)))];
}

ColorBgr lit(const ColorBgr& color, float light) {
  return {color.b * light, color.g * light, color.r * light};
}

bool in_ellipse(float x, float y, float half_width, float half_height) {
  return (x * x) / (half_width * half_width) + (y * y) / (half_height * half_height) < 1;
}

/// Ambient light: less from below and from the side, where arms and legs shade it.
ColorBgr shaded(const ColorBgr& color, float around, float height) {
  const float beside = std::abs(sine(kPiF * around));
  return lit(color, (0.92F + 0.10F * height) * (1 - 0.18F * beside * beside));
}

ColorBgr face(const ColorBgr& skin, const ColorBgr& hair, float around, float height) {
  const float ring = std::sqrt(std::max(0.0F, 1 - height * height)), beside = std::abs(around);
  if (is_hair({ring * cosine(kPiF * around), ring * sine(kPiF * around), height})) return hair;
  if (in_ellipse(beside - 0.13F, height - 0.02F, 0.022F, 0.06F)) return kBlack;  // iris
  if (in_ellipse(beside - 0.13F, height - 0.02F, 0.055F, 0.06F)) return kWhite;
  if (in_ellipse(beside - 0.13F, height - 0.02F, 0.085F, 0.12F)) return lit(skin, 0.78F);              // socket
  if (in_ellipse(beside - 0.135F, height - 0.20F, 0.08F, 0.035F)) return lit(hair, 0.9F);              // brow
  if (in_ellipse(beside - 0.025F, height + 0.30F, 0.022F, 0.04F)) return lit(skin, 0.45F);             // nostril
  if (in_ellipse(beside, height + 0.22F, 0.05F, 0.14F)) return lit(skin, around > 0 ? 0.82F : 1.08F);  // nose
  if (in_ellipse(around, height + 0.53F, 0.12F, 0.018F)) return lit(kLips, 0.6F);
  if (in_ellipse(around, height + 0.53F, 0.12F, 0.055F)) return kLips;
  return lit(skin, height < -0.72F ? 0.8F : 1);  // darker below the chin
}

enum class Wear { kButtons, kPrint, kStripes, kJacket };

/// How the upper body is dressed.
struct Clothes {
  Wear wear;
  ColorBgr cloth, ink;
  float print_cell;
  std::uint64_t print;  ///< bits of its pattern
};

ColorBgr printed(const Clothes& clothes, const ColorBgr& below, float beside, float height) {
  if (beside > 0.2F || std::abs(height - 0.05F) > 0.35F) return below;
  const int column = static_cast<int>(beside / clothes.print_cell), row = static_cast<int>((height + 0.3F) / 0.1F);
  return (clothes.print >> ((column * 7 + row) & 63) & 1U) != 0 ? clothes.ink : below;
}

ColorBgr open_jacket(const Clothes& clothes, const ColorBgr& below, float beside, float height) {
  const float opening = 0.03F + 0.16F * std::max(0.0F, height + 0.2F);
  if (beside < 0.018F && height < 0.8F) return clothes.ink;  // tie
  if (beside < opening) return kWhite;
  if (beside < opening + 0.03F) return lit(below, 0.7F);  // lapel
  return in_ellipse(beside - 0.22F, height + 0.45F, 0.07F, 0.02F) ? lit(below, 0.5F) : below;
}

ColorBgr chest(const Clothes& clothes, const ColorBgr& below, const ColorBgr& skin, float around, float height) {
  const float beside = std::abs(around), behind = 1 - beside;
  if (beside < 0.35F * (height - 0.55F)) return skin;  // the neckline
  if (beside < 0.35F * (height - 0.45F)) return lit(below, 0.72F);
  switch (clothes.wear) {
    case Wear::kButtons:
      if (in_ellipse(beside, std::remainder(height, 0.24F), 0.014F, 0.03F)) return clothes.ink;
      if (std::abs(around - 0.035F) < 0.005F) return lit(below, 0.65F);
      if (std::abs(around - 0.2F) < 0.07F && std::abs(height - 0.25F) < 0.01F) return lit(below, 0.6F);  // pocket
      return below;
    case Wear::kPrint:
      return printed(clothes, below, std::min(beside, behind), height);
    case Wear::kJacket:
      return open_jacket(clothes, below, beside, height);
    case Wear::kStripes:
      return below;  // in the cloth
  }
  return below;
}

Clothes choose_clothes(SeededRandom& random) {
  Clothes clothes{static_cast<Wear>(random.index(4)), any_of(kShirts, random), any_of(kShirts, random), 0, 0};
  if (clothes.wear == Wear::kJacket) clothes.cloth = any_of(kTrousers, random);
  clothes.print_cell = random.between(0.03F, 0.07F);
  clothes.print = random.next();
  return clothes;
}

/// Draws textures with ambient shade into the list.
struct Painter {
  std::vector<Texture>& textures;
  SeededRandom& random;

  int add(const ColorBgr& base, float noise, float texels_per_m, const Eigen::Vector2f& size_m,
          const Drawing& drawing) {
    const TextureStyle style{.base = base, .noise_amplitude = noise, .patches_per_m2 = 0};
    const Drawing with_shade = [&](const ColorBgr& below, float around, float height) {
      return shaded(drawing(below, around, height), around, height);
    };
    textures.push_back(paint_texture(size_m.x(), size_m.y(), texels_per_m, style, random.next(), with_shade));
    return static_cast<int>(textures.size()) - 1;
  }
  int add_skin(const ColorBgr& skin, float texels_per_m, const Eigen::Vector2f& size_m, const Drawing& drawing) {
    return add(skin, kSkinNoise, texels_per_m, size_m, drawing);
  }
  int add_cloth(const ColorBgr& cloth, const Eigen::Vector2f& size_m, const Drawing& drawing) {
    return add(cloth, kClothNoise, kFigureTexelsPerM, size_m, drawing);
  }
};

ColorBgr as_it_is(const ColorBgr& below, float, float) {
  return below;
}

ColorBgr hips(const ColorBgr& below, float around, float height) {
  if (std::abs(height - 0.35F) > 0.1F) return below;
  return std::abs(around) < 0.03F ? kWhite : kLeather;  // the belt and its buckle
}

ColorBgr leg(const ColorBgr& below, float around, float) {
  return std::abs(std::abs(around) - 0.5F) < 0.02F ? lit(below, 0.7F) : below;  // seams
}

ColorBgr shoe(const ColorBgr& below, float, float height) {
  return height < -0.55F ? kWhite : below;
}

using Eigen::Vector3f;

constexpr float kLegSwingRad = 0.42F, kArmSwingRad = 0.5F;
constexpr float kHipHeightM = 0.86F, kKneeHeightM = 0.43F, kThighM = 0.43F;
constexpr float kSeatedThighRad = 1.45F;  ///< thighs of one who sits, from the vertical
constexpr float kSeatedArmRad = -0.75F;   ///< arms reach forward to the knees

/// One ellipsoid of a figure, person frame: x forward, y left, z up, origin between the feet.
struct BodyPart {
  Vector3f center_m, semi_axes_m;
  float turned_rad = 0;      ///< about the joint's left-right axis
  float joint_height_m = 0;  ///< z of the joint
  Material material = Material::kPlain;
};

/// A piece of a limb between two joints.
struct Bone {
  float length_m, radius_m;
  float turned_rad;  ///< from hanging down, positive backwards
  Material material = Material::kPlain;
};
constexpr float kJointOverlap = 0.6F;  ///< of the radius

/// How far an arm is turned about its shoulder; side: -1 right, 1 left.
float arm_rad_of(const Posture& posture, float side) {
  return -side * posture.swing * kArmSwingRad + posture.seated * kSeatedArmRad + side * posture.fidget_rad;
}

}  // namespace

PersonTextures draw_person(std::uint64_t seed, float breadth, std::vector<Texture>& textures) {
  SeededRandom random(seed ^ 0xFACEULL);
  const ColorBgr skin = any_of(kSkins, random), hair = any_of(kHairs, random), trousers = any_of(kTrousers, random);
  const Clothes clothes = choose_clothes(random);
  const bool short_sleeves = clothes.wear != Wear::kJacket && random.unit() < 0.5F;
  const Drawing woven = [&](const ColorBgr& below, float, float height) {
    return clothes.wear == Wear::kStripes && std::remainder(height, 0.36F) > 0 ? clothes.ink : below;
  };
  Painter painter{textures, random};
  PersonTextures person;
  person.head = painter.add_skin(
      skin, kFaceTexelsPerM, {0.55F, 0.27F},
      [&](const ColorBgr& below, float around, float height) { return face(below, hair, around, height); });
  person.hair = painter.add_cloth(hair, {0.55F, 0.27F}, as_it_is);
  person.skin = painter.add_skin(skin, kFigureTexelsPerM, {0.25F, 0.3F}, as_it_is);
  person.chest =
      painter.add_cloth(clothes.cloth, {breadth, 0.5F}, [&](const ColorBgr& below, float around, float height) {
        return chest(clothes, woven(below, around, height), skin, around, height);
      });
  person.cloth = painter.add_cloth(clothes.cloth, {0.9F * breadth, 0.4F}, woven);
  person.forearm = short_sleeves ? person.skin : person.cloth;
  person.hips = painter.add_cloth(trousers, {breadth, 0.3F}, hips);
  person.leg = painter.add_cloth(trousers, {0.45F, 0.5F}, leg);
  person.shoe = painter.add_cloth(random.unit() < 0.5F ? kBlack : kLeather, {0.5F, 0.1F}, shoe);
  return person;
}

/// Where the parts of one figure go.
struct Figure::Placing {
  Geometry& geometry;
  Eigen::Isometry3f T_world_person;
  float scale, breadth;
  Vector3f hip_shift_m;  ///< of everything above the legs: it is lower and farther back when the knees are bent
  int object;
  bool body_moves, limbs_move;

  void add(const BodyPart& part, int texture, bool moving) {
    const Vector3f wide(1, breadth, 1);
    const Vector3f center_m = part.center_m.cwiseProduct(wide), semi_axes_m = part.semi_axes_m.cwiseProduct(wide);
    const Vector3f joint(center_m.x(), center_m.y(), part.joint_height_m);
    Eigen::Isometry3f T_person_body = Eigen::Isometry3f::Identity();
    T_person_body.linear() = rotation(part.turned_rad, Vector3f::UnitY());
    T_person_body.translation() = scale * (joint + times(T_person_body.linear(), center_m - joint));
    geometry.ellipsoids.push_back(
        {composed(T_world_person, T_person_body), scale * semi_axes_m, texture, moving, object, part.material});
  }
  /// Hangs an ellipsoid below a joint at `from_m`, turned about it; the other end.
  Vector3f hang(const Vector3f& from_m, const Bone& bone, int texture, bool moving) {
    const Vector3f along(-sine(bone.turned_rad), 0, -cosine(bone.turned_rad));
    const Vector3f center_m = from_m + bone.length_m / 2 * along;
    const Vector3f semi_axes_m(bone.radius_m, bone.radius_m / breadth,
                               bone.length_m / 2 + bone.radius_m * kJointOverlap);
    add({center_m, semi_axes_m, bone.turned_rad, center_m.z(), bone.material}, texture, moving);
    return from_m + bone.length_m * along;
  }
  void add_above_hips(BodyPart part, int texture, bool moving) {
    part.center_m += hip_shift_m;
    part.joint_height_m += hip_shift_m.z();
    add(part, texture, moving);
  }
};

ColorBgr vivid_color(SeededRandom& random) {
  return {random.between(30, 200), random.between(30, 200), random.between(30, 200)};
}

Figure::Figure(std::uint64_t seed, FigureLook look, std::vector<Texture>& textures, float breadth) : breadth_(breadth) {
  SeededRandom random(seed ^ 0x9E450AULL);
  height_scale_ = random.between(0.92F, 1.08F);
  step_rate_rad_s_ = kTwoPiF * random.between(0.8F, 1.0F);
  if (look == FigureLook::kDrawn) {
    drawn_ = draw_person(seed, breadth, textures);
  } else {
    paint_plain(random, textures);
  }
}

void Figure::paint_plain(SeededRandom& random, std::vector<Texture>& textures) {
  const TextureStyle skin{{120, 150, 205}, 5, 25, 0.02F, 0.05F, 0.15F};
  const TextureStyle shirt{vivid_color(random), 9, 45, 0.04F, 0.25F, 0.75F};
  const TextureStyle trousers{vivid_color(random), 9, 30, 0.03F, 0.12F, 0.35F};
  skin_texture_ = add_texture(textures, 0.25F, 0.3F, kFigureTexelsPerM, skin, random.next());
  shirt_texture_ = add_texture(textures, 0.6F * breadth_, 0.75F, kFigureTexelsPerM, shirt, random.next());
  trousers_texture_ = add_texture(textures, 0.25F * breadth_, 0.9F, kFigureTexelsPerM, trousers, random.next());
}

void Figure::append_to(Geometry& geometry, const Posture& posture) const {
  const Eigen::Isometry3f T_world_person =
      upright({posture.position_m.x(), posture.position_m.y(), posture.raised_m}, posture.heading_rad);
  const float thigh_rad = kSeatedThighRad * posture.seated;
  const Vector3f hip_shift_m(-kThighM * sine(thigh_rad), 0, kThighM * (cosine(thigh_rad) - 1));
  Placing placing{geometry,           T_world_person,    height_scale_,
                  breadth_,           hip_shift_m,       geometry.add_object("person"),
                  posture.body_moves, posture.limbs_move};
  if (drawn_) {
    append_drawn_trunk(placing, posture);
    append_drawn_limbs(placing, posture);
    return;
  }
  append_upper_body(placing, posture);
  if (posture.seated > 0) {
    append_bent_legs(placing, thigh_rad);
  } else {
    append_standing_legs(placing, posture.swing);
  }
}

void Figure::append_upper_body(Placing& placing, const Posture& posture) const {
  const bool body = placing.body_moves, limbs = placing.limbs_move;
  const float nod_rad = 0.5F * posture.fidget_rad;
  placing.add_above_hips({{0.02F, 0, 1.62F}, {0.105F, 0.085F, 0.135F}, nod_rad, 1.5F, Material::kHead}, skin_texture_,
                         limbs);
  placing.add_above_hips({{0, 0, 1.46F}, {0.055F, 0.055F, 0.10F}}, skin_texture_, body);  // neck
  placing.add_above_hips({{0, 0, 1.17F}, {0.14F, 0.225F, 0.33F}}, shirt_texture_, body);  // torso
  placing.add_above_hips({{0, 0, 0.90F}, {0.145F, 0.19F, 0.17F}, 0, 0, Material::kDark}, trousers_texture_,
                         body);  // hips
  for (const float side : {-1.0F, 1.0F}) {
    const float arm_rad = arm_rad_of(posture, side);
    placing.add_above_hips({{0, side * 0.26F, 1.12F}, {0.05F, 0.05F, 0.31F}, arm_rad, 1.40F}, shirt_texture_, limbs);
  }
}

void Figure::append_standing_legs(Placing& placing, float swing) const {
  for (const float side : {-1.0F, 1.0F}) {
    placing.add(
        {{0, side * 0.10F, 0.44F}, {0.085F, 0.08F, 0.45F}, side * swing * kLegSwingRad, kHipHeightM, Material::kDark},
        trousers_texture_, placing.body_moves);
  }
}

/// Shins upright on the feet, thighs from the knees back to the hips.
void Figure::append_bent_legs(Placing& placing, float thigh_rad) const {
  for (const float side : {-1.0F, 1.0F}) {
    const Vector3f knee_m(0, side * 0.10F, kKneeHeightM);
    placing.add({{0, knee_m.y(), 0.22F}, {0.065F, 0.065F, 0.235F}, 0, 0, Material::kDark}, trousers_texture_,
                placing.body_moves);
    placing.add(
        {knee_m + Vector3f(0, 0, kThighM / 2), {0.08F, 0.08F, 0.26F}, -thigh_rad, kKneeHeightM, Material::kDark},
        trousers_texture_, placing.body_moves);
  }
}

void Figure::append_drawn_trunk(Placing& placing, const Posture& posture) const {
  const PersonTextures& look = *drawn_;
  const bool body = placing.body_moves, limbs = placing.limbs_move;
  const float nod_rad = 0.5F * posture.fidget_rad, slim = 1 / breadth_;
  placing.add_above_hips({{0.02F, 0, 1.63F}, {0.100F, 0.080F * slim, 0.125F}, nod_rad, 1.5F, Material::kHead},
                         look.head, limbs);
  placing.add_above_hips({{-0.014F, 0, 1.645F}, {0.096F, 0.088F * slim, 0.12F}, nod_rad, 1.5F, Material::kDark},
                         look.hair, limbs);
  placing.add_above_hips({{0, 0, 1.48F}, {0.052F, 0.055F * slim, 0.10F}}, look.skin, body);
  placing.add_above_hips({{-0.005F, 0, 1.395F}, {0.078F, 0.205F, 0.075F}}, look.cloth, body);  // shoulders
  placing.add_above_hips({{0, 0, 1.23F}, {0.12F, 0.185F, 0.25F}}, look.chest, body);
  placing.add_above_hips({{0, 0, 1.04F}, {0.112F, 0.165F, 0.20F}}, look.cloth, body);  // waist
  placing.add_above_hips({{-0.005F, 0, 0.91F}, {0.13F, 0.178F, 0.16F}, 0, 0, Material::kDark}, look.hips, body);
}

void Figure::append_drawn_limbs(Placing& placing, const Posture& posture) const {
  constexpr float kElbowRad = -0.3F, kKneeRad = 0.25F, kAnkleM = 0.07F;
  const PersonTextures& look = *drawn_;
  const float thigh_rad = kSeatedThighRad * posture.seated, swing = posture.swing * (1 - posture.seated);
  for (const float side : {-1.0F, 1.0F}) {
    const bool body = placing.body_moves, limbs = placing.limbs_move;
    const float arm_rad = arm_rad_of(posture, side);
    const float leg_rad = side * swing * kLegSwingRad - thigh_rad;
    const float shin_rad = (1 - posture.seated) * (leg_rad + kKneeRad * std::abs(swing));
    const Vector3f shoulder_m = Vector3f(0, side * 0.215F, 1.40F) + placing.hip_shift_m;
    const Vector3f elbow_m = placing.hang(shoulder_m, {0.29F, 0.052F, arm_rad}, look.cloth, limbs);
    const Vector3f wrist_m = placing.hang(elbow_m, {0.25F, 0.041F, arm_rad + kElbowRad}, look.forearm, limbs);
    placing.hang(wrist_m, {0.14F, 0.040F, arm_rad + kElbowRad}, look.skin, limbs);  // hand
    const Vector3f hip_m = Vector3f(0, side * 0.09F, kHipHeightM) + placing.hip_shift_m;
    const Vector3f knee_m = placing.hang(hip_m, {kThighM, 0.083F, leg_rad, Material::kDark}, look.leg, body);
    const Vector3f ankle_m =
        placing.hang(knee_m, {kKneeHeightM - kAnkleM, 0.062F, shin_rad, Material::kDark}, look.leg, body);
    placing.add(
        {ankle_m + Vector3f(0.055F, 0, -0.02F), {0.13F, 0.047F, 0.052F}, shin_rad, ankle_m.z(), Material::kDark},
        look.shoe, body);
  }
}

}  // namespace rtd::camera::synthetic
