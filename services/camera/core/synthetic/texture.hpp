// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace rtd::camera::synthetic {

/// One resolution of a texture. Texels are packed 0x00RRGGBB.
struct MipLevel {
  int width = 0, height = 0;  ///< texels, >= 2
  std::vector<std::uint32_t> texels;
};

/// A picture on a surface with its smaller versions; level k has half the resolution of level k-1.
struct Texture {
  float texels_per_m = 0;  ///< of level 0
  std::vector<MipLevel> levels;
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
/// rectangles over it, so that corners of all sizes stand everywhere. The same arguments give the same texels.
Texture paint_texture(float width_m, float height_m, float texels_per_m, const TextureStyle& style, std::uint64_t seed);

/// Bilinear sample; `s` and `t` in texels of this level, clamped to the border.
inline std::uint32_t sample(const MipLevel& level, float s, float t) {
  constexpr std::uint64_t kLanes = 0x00FF00FF00FF00FFULL;
  const auto clamp = [](float coordinate, int size) {
    const int fixed = static_cast<int>(coordinate * 256.0F) - 128;  // texel centres stand at half texels
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
