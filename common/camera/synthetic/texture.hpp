// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

namespace rtd::camera::synthetic {

inline constexpr double kPi = 3.141592653589793, kTwoPi = 6.283185307179586;
inline constexpr float kPiF = 3.1415927F, kTwoPiF = 6.2831853F;
inline constexpr float kFigureTexelsPerM = 256;  ///< of all movers

/// A small generator with the same numbers on every platform and library (splitmix64, Steele et al. 2014).
class SeededRandom {
 public:
  explicit SeededRandom(std::uint64_t seed) : state_(seed) {}

  std::uint64_t next() {
    state_ += 0x9E3779B97F4A7C15ULL;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
    return z ^ (z >> 31);
  }
  /// In [0, 1).
  float unit() { return static_cast<float>(next() >> 40) * (1.0F / 16777216.0F); }
  float between(float low, float high) { return low + (high - low) * unit(); }
  /// In [0, count).
  int index(int count) { return static_cast<int>(next() % static_cast<std::uint64_t>(count)); }
  /// Approximately normal, mean 0, variance 1 (sum of 12 uniform numbers).
  float normal() {
    float sum = -6.0F;
    for (int i = 0; i < 12; ++i) sum += unit();
    return sum;
  }

 private:
  std::uint64_t state_;
};

/// One resolution of a texture. Texels are packed 0x00RRGGBB.
struct MipLevel {
  int width = 0, height = 0;  ///< texels, >= 2
  std::vector<std::uint32_t> texels;
};

/// An image on a surface with its smaller versions; level k has half the resolution of level k-1.
struct Texture {
  float texels_per_m = 0;  ///< of level 0
  std::vector<MipLevel> levels;
  bool wraps = false;  ///< on an ellipsoid: goes round its z axis, the middle in front (x); else is seen from x + y
};

struct ColorBgr {
  float b = 0, g = 0, r = 0;  ///< 0..255
};

/// How a surface is painted.
struct TextureStyle {
  ColorBgr base;
  float noise_amplitude = 12;  ///< grey levels of each octave of the value noise
  float patches_per_m2 = 6;    ///< rectangles painted over the noise: posters, books, labels
  float min_patch_m = 0.05F, max_patch_m = 0.5F;
  float patch_contrast = 1;  ///< 0: patches in the base colour, 1: in any colour
};

/// Paints a texture of width_m x height_m: multi-octave value noise with plain, checkered, striped and framed
/// rectangles over it, so that there are corners of all sizes everywhere. The same arguments give the same texels.
Texture paint_texture(float width_m, float height_m, float texels_per_m, const TextureStyle& style, std::uint64_t seed);

/// What is drawn over a texture that goes round an ellipsoid: the colour at `around`, 0 in front, 0.5 on the left, +-1
/// behind, and `height`, z of the unit sphere; `below` is what was painted there.
using Drawing = std::function<ColorBgr(const ColorBgr& below, float around, float height)>;
/// The same with a drawing over it; it wraps.
Texture paint_texture(float width_m, float height_m, float texels_per_m, const TextureStyle& style, std::uint64_t seed,
                      const Drawing& drawing);

/// Paints one more texture; its index.
int add_texture(std::vector<Texture>& textures, float width_m, float height_m, float texels_per_m,
                const TextureStyle& style, std::uint64_t seed);

/// Bilinear sample; `s` and `t` in texels of this level, clamped to the border.
inline std::uint32_t sample(const MipLevel& level, float s, float t) {
  constexpr std::uint64_t kLanes = 0x00FF00FF00FF00FFULL;
  const auto clamp = [](float coordinate, int size) {
    const int fixed = static_cast<int>(coordinate * 256.0F) - 128;  // texel centres are at half texels
    const int last = (size - 1) * 256 - 1;
    return fixed < 0 ? 0 : (fixed > last ? last : fixed);
  };
  const auto spread = [](std::uint32_t texel) {  // 4 bytes -> 4 lanes of 16 bits
    return (texel & 0x00FF00FFU) | (static_cast<std::uint64_t>((texel >> 8) & 0x00FF00FFU) << 32);
  };
  const int x = clamp(s, level.width), y = clamp(t, level.height);
  const auto wx = static_cast<std::uint64_t>(x & 255), wy = static_cast<std::uint64_t>(y & 255);
  const std::uint32_t* top = level.texels.data() + static_cast<std::ptrdiff_t>(y >> 8) * level.width + (x >> 8);
  const std::uint32_t* bottom = top + level.width;
  const std::uint64_t upper = ((spread(top[0]) * (256 - wx) + spread(top[1]) * wx) >> 8) & kLanes;
  const std::uint64_t lower = ((spread(bottom[0]) * (256 - wx) + spread(bottom[1]) * wx) >> 8) & kLanes;
  const std::uint64_t mixed = ((upper * (256 - wy) + lower * wy) >> 8) & kLanes;
  return static_cast<std::uint32_t>(mixed) | (static_cast<std::uint32_t>(mixed >> 32) << 8);
}

}  // namespace rtd::camera::synthetic
