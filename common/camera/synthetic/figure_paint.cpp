// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/synthetic/figure_paint.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/camera/synthetic/geometry.hpp"
#include "common/camera/synthetic/same_math.hpp"

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

/// Ambient light: less from below and beside, where arms and legs shade it.
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

}  // namespace rtd::camera::synthetic
