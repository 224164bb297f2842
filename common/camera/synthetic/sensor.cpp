// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/synthetic/sensor.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "common/camera/synthetic/texture.hpp"

namespace rtd::camera::synthetic {
namespace {

constexpr double kSwitchS = 0.7;   ///< a lamp may go off or on so often
constexpr double kOffShare = 0.3;  ///< of the time one of the lamps is off
constexpr double kOffGain = 0.5;   ///< what is left then
constexpr double kDimming = 0.25, kFlicker = 0.1, kGammaUnrest = 0.2;

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

namespace {

constexpr std::size_t kNoiseStarts = (1U << 16U) - 2048;  ///< where a row may start to read
constexpr std::size_t kLongestRow = std::size_t{3} * Sensor::kWidestRowPx;
constexpr std::size_t kNoiseTable = kNoiseStarts + kLongestRow;

/// Where a row starts to read the noise table: different in every row and frame.
std::size_t noise_offset(std::uint64_t seed, std::uint64_t frame_index, int row) {
  SeededRandom random(seed ^ (frame_index * 0x9E3779B97F4A7C15ULL) ^ (static_cast<std::uint64_t>(row) << 48U));
  return random.next() % kNoiseStarts;
}

void check_width(const cv::Mat& image) {
  if (image.cols <= Sensor::kWidestRowPx) return;
  throw std::invalid_argument("synthetic sensor: image width is " + std::to_string(image.cols) +
                              " px, allowed are at most " + std::to_string(Sensor::kWidestRowPx));
}

}  // namespace

Sensor::Sensor(const SensorModel& model, std::uint64_t seed) : model_(model), seed_(seed) {
  SeededRandom random(seed);
  color_noise_.reserve(kNoiseTable);
  depth_noise_.reserve(kNoiseTable);
  for (std::size_t i = 0; i < kNoiseTable; ++i) {
    color_noise_.push_back(static_cast<std::int8_t>(std::lround(random.normal() * model.color_noise_levels)));
    depth_noise_.push_back(random.normal() * model.disparity_noise_steps);
  }
  const float steps_m = model.baseline_px_m / model.disparity_step_px;
  units_of_disparity_.assign(static_cast<std::size_t>(steps_m / model.min_depth_m) + 2, 0);
  for (std::size_t steps = 1; steps < units_of_disparity_.size(); ++steps) {
    units_of_disparity_[steps] = to_units(steps_m / static_cast<float>(steps));
  }
}

std::uint16_t Sensor::to_units(float depth_m) const {
  if (depth_m < model_.min_depth_m || depth_m > model_.max_depth_m) return 0;
  return static_cast<std::uint16_t>(std::lround(depth_m * model_.depth_units_per_m));
}

cv::Mat Sensor::measure_depth(const cv::Mat& inverse_depth, std::uint64_t frame_index, const cv::Mat& noise) const {
  check_width(inverse_depth);
  cv::Mat depth(inverse_depth.size(), CV_16UC1), noise_steps;
  noise.convertTo(noise_steps, CV_32F, static_cast<double>(model_.disparity_noise_steps));
  for (int row = 0; row < depth.rows; ++row) {
    auto* units = depth.ptr<std::uint16_t>(row);
    if (model_.noise) {
      const float* white = depth_noise_.data() + noise_offset(seed_, frame_index, row);
      measure_depth_row(inverse_depth, row, noise.empty() ? white : noise_steps.ptr<float>(row), units);
    } else {
      const auto* w = inverse_depth.ptr<float>(row);
      for (int column = 0; column < depth.cols; ++column) {
        units[column] = w[column] > 0 ? to_units(1.0F / w[column]) : std::uint16_t{0};
      }
    }
  }
  return depth;
}

void Sensor::measure_depth_row(const cv::Mat& inverse_depth, int row, const float* noise, std::uint16_t* depth) const {
  const auto* w = inverse_depth.ptr<float>(row);
  const auto* above = inverse_depth.ptr<float>(std::max(row - 1, 0));
  const auto* below = inverse_depth.ptr<float>(std::min(row + 1, inverse_depth.rows - 1));
  const float steps_m = model_.baseline_px_m / model_.disparity_step_px;
  const int last_steps = static_cast<int>(units_of_disparity_.size()) - 1;
  const int last_column = inverse_depth.cols - 1;
  // The projector stands to the right and sees a point at column - disparity. From right to left its column must fall;
  // where it does not, something nearer hides the point from the projector: the shadow to the left of near objects.
  float hidden_from = static_cast<float>(2 * inverse_depth.cols);
  for (int column = last_column; column >= 0; --column) {
    const float here = w[column];
    const float projector_column = static_cast<float>(column) - model_.shadow_px_m * here;
    const bool hidden = projector_column > hidden_from;
    hidden_from = std::min(hidden_from, projector_column);
    const float slope_u = std::abs(w[std::min(column + 1, last_column)] - w[std::max(column - 1, 0)]);
    const float slope_v = std::abs(below[column] - above[column]);
    const bool steep = std::max(slope_u, slope_v) > model_.max_relative_slope * here;
    const int steps = static_cast<int>(steps_m * here + noise[column] + 0.5F);
    depth[column] = hidden || steep ? std::uint16_t{0}
                                    : units_of_disparity_[static_cast<std::size_t>(std::clamp(steps, 0, last_steps))];
  }
}

cv::Mat Sensor::measure_color(const cv::Mat& ideal_bgr, std::uint64_t frame_index) const {
  check_width(ideal_bgr);
  cv::Mat color(ideal_bgr.size(), CV_8UC3);
  const int bytes = 3 * ideal_bgr.cols;
  for (int row = 0; row < color.rows; ++row) {
    const auto* in = ideal_bgr.ptr<std::uint8_t>(row);
    auto* out = color.ptr<std::uint8_t>(row);
    const std::int8_t* noise = color_noise_.data() + noise_offset(seed_ + 1, frame_index, row);
    if (!model_.noise) {
      std::copy_n(in, bytes, out);
      continue;
    }
    for (int i = 0; i < bytes; ++i) {
      out[i] = static_cast<std::uint8_t>(std::clamp(static_cast<int>(in[i]) + noise[i], 0, 255));
    }
  }
  return color;
}

}  // namespace rtd::camera::synthetic
