// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/synthetic/texture.hpp"

#include <algorithm>
#include <cmath>

#include "common/camera/synthetic/geometry.hpp"

namespace rtd::camera::synthetic {
namespace {

constexpr std::array<float, 4> kNoiseCellsM = {0.45F, 0.17F, 0.065F, 0.026F};  ///< octaves of the value noise
constexpr int kSmallestLevel = 4;                                              ///< texels

/// The texture while it is painted: brightness noise first, then colours.
struct Canvas {
  int width, height;
  float texels_per_m;
  std::vector<ColorBgr> pixels;
  ColorBgr& at(int x, int y) {
    return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
  }
};

float smooth(float x) {
  return x * x * (3.0F - 2.0F * x);
}

/// Adds one octave: random values on a lattice, smoothly interpolated.
void add_value_noise(Canvas& canvas, float cell_m, float amplitude, SeededRandom& random) {
  const float cells_per_texel = 1.0F / (cell_m * canvas.texels_per_m);
  const int columns = static_cast<int>(static_cast<float>(canvas.width) * cells_per_texel) + 2;
  const int rows = static_cast<int>(static_cast<float>(canvas.height) * cells_per_texel) + 2;
  std::vector<float> lattice(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  for (float& value : lattice) value = random.between(-amplitude, amplitude);
  for (int y = 0; y < canvas.height; ++y) {
    const float v = static_cast<float>(y) * cells_per_texel;
    const float wy = smooth(v - std::floor(v));
    const float* top = lattice.data() + static_cast<std::ptrdiff_t>(v) * columns;
    const float* bottom = top + columns;
    for (int x = 0; x < canvas.width; ++x) {
      const float u = static_cast<float>(x) * cells_per_texel;
      const int column = static_cast<int>(u);
      const float wx = smooth(u - static_cast<float>(column));
      const float upper = top[column] + (top[column + 1] - top[column]) * wx;
      const float lower = bottom[column] + (bottom[column + 1] - bottom[column]) * wx;
      const float value = upper + (lower - upper) * wy;
      ColorBgr& pixel = canvas.at(x, y);
      pixel.b += value;
      pixel.g += value;
      pixel.r += value;
    }
  }
}

enum class Fill { kPlain, kChecker, kStripes, kFrame, kText };

/// A rectangle over the noise, in texels.
struct Patch {
  float center_x, center_y, half_width, half_height, cos_angle, sin_angle, cell;
  Fill fill;
  ColorBgr ink, paper;
  std::uint64_t seed;
};

/// Whether the pattern shows ink at (u, v), the offset from the patch's upper left corner in texels.
bool is_ink(const Patch& patch, float u, float v) {
  const int column = static_cast<int>(u / patch.cell), row = static_cast<int>(v / patch.cell);
  const float border = std::min({u, v, 2 * patch.half_width - u, 2 * patch.half_height - v});
  switch (patch.fill) {
    case Fill::kPlain:
      return true;
    case Fill::kChecker:
      return ((column + row) & 1) == 0;
    case Fill::kStripes:
      return (row & 1) == 0;
    case Fill::kFrame:
      return border < patch.cell;
    case Fill::kText:  // words: random cells of every other row
      return border > patch.cell && (row & 1) == 1 &&
             (SeededRandom(patch.seed + static_cast<std::uint64_t>(row * 977 + column / 2)).next() & 3) != 0;
  }
  return true;
}

ColorBgr mixed(const ColorBgr& a, const ColorBgr& b, float weight_b) {
  return {a.b + (b.b - a.b) * weight_b, a.g + (b.g - a.g) * weight_b, a.r + (b.r - a.r) * weight_b};
}

ColorBgr random_color(const TextureStyle& style, SeededRandom& random) {
  const ColorBgr any{random.between(20, 235), random.between(20, 235), random.between(20, 235)};
  return mixed(style.base, any, style.patch_contrast);
}

Patch random_patch(const Canvas& canvas, const TextureStyle& style, SeededRandom& random) {
  const float scale = style.max_patch_m / style.min_patch_m;
  const auto size_texels = [&] { return style.min_patch_m * power(scale, random.unit()) * canvas.texels_per_m; };
  const float turned_rad = random.unit() < 0.7F ? 0.0F : random.between(-0.6F, 0.6F);
  Patch patch{};
  patch.center_x = random.unit() * static_cast<float>(canvas.width);
  patch.center_y = random.unit() * static_cast<float>(canvas.height);
  patch.half_width = size_texels() / 2;
  patch.half_height = size_texels() / 2;
  patch.cos_angle = cosine(turned_rad);
  patch.sin_angle = sine(turned_rad);
  patch.cell = std::max(2.0F, random.between(0.015F, 0.05F) * canvas.texels_per_m);
  patch.fill = static_cast<Fill>(random.index(5));
  patch.ink = random_color(style, random);
  patch.paper = random_color(style, random);
  patch.seed = random.next();
  return patch;
}

/// Paints the patch and lets some of the noise below shine through, so that large plain patches are not empty.
void paint_patch(Canvas& canvas, const Patch& patch, const ColorBgr& base) {
  constexpr float kNoiseKept = 0.7F;
  const float reach = std::abs(patch.half_width) + std::abs(patch.half_height);
  const int x_end = std::min(canvas.width - 1, static_cast<int>(patch.center_x + reach));
  const int y_end = std::min(canvas.height - 1, static_cast<int>(patch.center_y + reach));
  for (int y = std::max(0, static_cast<int>(patch.center_y - reach)); y <= y_end; ++y) {
    for (int x = std::max(0, static_cast<int>(patch.center_x - reach)); x <= x_end; ++x) {
      const float dx = static_cast<float>(x) - patch.center_x, dy = static_cast<float>(y) - patch.center_y;
      const float u = patch.cos_angle * dx + patch.sin_angle * dy + patch.half_width;
      const float v = -patch.sin_angle * dx + patch.cos_angle * dy + patch.half_height;
      if (u < 0 || v < 0 || u >= 2 * patch.half_width || v >= 2 * patch.half_height) continue;
      const ColorBgr& color = is_ink(patch, u, v) ? patch.ink : patch.paper;
      ColorBgr& pixel = canvas.at(x, y);
      const float noise = std::clamp((pixel.g - base.g) * kNoiseKept, -40.0F, 40.0F);
      pixel = {color.b + noise, color.g + noise, color.r + noise};
    }
  }
}

MipLevel to_level(const Canvas& canvas) {
  MipLevel level{canvas.width, canvas.height, {}};
  level.texels.reserve(canvas.pixels.size());
  const auto byte = [](float value) { return static_cast<std::uint32_t>(std::clamp(value, 0.0F, 255.0F)); };
  for (const ColorBgr& p : canvas.pixels) level.texels.push_back(byte(p.b) | byte(p.g) << 8 | byte(p.r) << 16);
  return level;
}

MipLevel half_size(const MipLevel& level) {
  MipLevel half{level.width / 2, level.height / 2, {}};
  half.texels.reserve(static_cast<std::size_t>(half.width) * static_cast<std::size_t>(half.height));
  for (int y = 0; y < half.height; ++y) {
    for (int x = 0; x < half.width; ++x) {
      const std::uint32_t* top = level.texels.data() + static_cast<std::ptrdiff_t>(2 * y) * level.width + 2 * x;
      const std::array<std::uint32_t, 4> four = {top[0], top[1], top[level.width], top[level.width + 1]};
      std::uint32_t texel = 0;
      for (const int shift : {0, 8, 16}) {
        std::uint32_t sum = 2;
        for (const std::uint32_t source : four) sum += (source >> shift) & 255U;
        texel |= (sum / 4) << shift;
      }
      half.texels.push_back(texel);
    }
  }
  return half;
}

void draw(Canvas& canvas, const Drawing& drawing) {
  const auto centered = [](int i, int count) {
    return (2 * static_cast<float>(i) + 1) / static_cast<float>(count) - 1;
  };
  for (int y = 0; y < canvas.height; ++y) {
    for (int x = 0; x < canvas.width; ++x) {
      ColorBgr& pixel = canvas.at(x, y);
      pixel = drawing(pixel, centered(x, canvas.width), -centered(y, canvas.height));
    }
  }
}

}  // namespace

Texture paint_texture(float width_m, float height_m, float texels_per_m, const TextureStyle& style,
                      std::uint64_t seed) {
  return paint_texture(width_m, height_m, texels_per_m, style, seed, nullptr);
}

Texture paint_texture(float width_m, float height_m, float texels_per_m, const TextureStyle& style, std::uint64_t seed,
                      const Drawing& drawing) {
  SeededRandom random(seed);
  Canvas canvas{std::max(2, static_cast<int>(width_m * texels_per_m)),
                std::max(2, static_cast<int>(height_m * texels_per_m)),
                texels_per_m,
                {}};
  canvas.pixels.assign(static_cast<std::size_t>(canvas.width) * static_cast<std::size_t>(canvas.height), style.base);
  for (const float cell_m : kNoiseCellsM) {
    if (cell_m * texels_per_m >= 2.0F) add_value_noise(canvas, cell_m, style.noise_amplitude, random);
  }
  const int patches = static_cast<int>(std::ceil(style.patches_per_m2 * width_m * height_m));
  for (int i = 0; i < patches; ++i) paint_patch(canvas, random_patch(canvas, style, random), style.base);
  if (drawing) draw(canvas, drawing);
  Texture texture{texels_per_m, {to_level(canvas)}, static_cast<bool>(drawing)};
  while (std::min(texture.levels.back().width, texture.levels.back().height) >= 2 * kSmallestLevel) {
    texture.levels.push_back(half_size(texture.levels.back()));
  }
  return texture;
}

int add_texture(std::vector<Texture>& textures, float width_m, float height_m, float texels_per_m,
                const TextureStyle& style, std::uint64_t seed) {
  textures.push_back(paint_texture(width_m, height_m, texels_per_m, style, seed));
  return static_cast<int>(textures.size()) - 1;
}

}  // namespace rtd::camera::synthetic
