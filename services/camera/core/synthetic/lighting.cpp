// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/core/synthetic/lighting.hpp"

#include <algorithm>
#include <cmath>

#include "services/camera/core/synthetic/seeded_random.hpp"

namespace rtd::camera::synthetic {
namespace {

constexpr double kSwitchS = 0.7;   ///< a lamp may go off or on so often
constexpr double kOffShare = 0.3;  ///< of the time one of the lamps is off
constexpr double kOffGain = 0.5;   ///< what is left then
constexpr double kDimming = 0.25, kFlicker = 0.1, kGammaUnrest = 0.2;
constexpr double kTwoPi = 6.283185307179586;

/// Whether a lamp is off in the n-th span; the light is on at first.
bool lamp_off(std::uint64_t seed, std::int64_t span) {
  SeededRandom random(seed ^ (static_cast<std::uint64_t>(span) * 0x9E3779B97F4A7C15ULL));
  return span > 0 && static_cast<double>(random.unit()) < kOffShare;
}

}  // namespace

Lighting::Lighting(double unrest, std::uint64_t seed) : unrest_(unrest), seed_(seed ^ 0x1A3FULL) {
  SeededRandom random(seed_);
  dim_rate_rad_s_ = static_cast<double>(random.between(0.8F, 1.6F));
  dim_phase_rad_ = kTwoPi * static_cast<double>(random.unit());
  flicker_rate_rad_s_ = static_cast<double>(random.between(25, 45));  // mains against the frame rate
}

Lighting::Curve Lighting::at(double t_s) const {
  if (unrest_ <= 0) return {};
  const double dimmed = kDimming * std::sin(dim_rate_rad_s_ * t_s + dim_phase_rad_);
  const double flicker = kFlicker * std::sin(flicker_rate_rad_s_ * t_s);
  const double lamps = lamp_off(seed_, static_cast<std::int64_t>(t_s / kSwitchS)) ? kOffGain - 1 : 0;
  const double gain = (1 + unrest_ * (dimmed + flicker)) * (1 + unrest_ * lamps);
  return {gain, 1 + unrest_ * kGammaUnrest * std::sin(0.6 * dim_rate_rad_s_ * t_s)};
}

void Lighting::apply(cv::Mat& color_bgr, double t_s) const {
  if (unrest_ <= 0) return;
  const Curve curve = at(t_s);
  cv::Mat table(1, 256, CV_8UC1);
  for (int level = 0; level < 256; ++level) {
    const double lit = 255 * curve.gain * std::pow(level / 255.0, curve.gamma);
    table.at<std::uint8_t>(level) = static_cast<std::uint8_t>(std::clamp(std::lround(lit), 0L, 255L));
  }
  cv::LUT(color_bgr, table, color_bgr);
}

}  // namespace rtd::camera::synthetic
