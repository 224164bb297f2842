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

const std::vector<FaultParameter>& fault_parameters() {
  using F = SensorFaults;
  static const std::vector<FaultParameter> parameters = {
      {"disparity_step_px", &F::disparity_step_px, 0.01, 1, "step of the measured disparity, 43.5 px m / depth"},
      {"disparity_noise_px", &F::disparity_noise_px, 0, 2, "standard deviation of the disparity before rounding"},
      {"noise_correlation_px", &F::noise_correlation_px, 0, 50, "distance at which its correlation falls to 1/e"},
      {"holes", &F::holes, 0, 0.9, "share of the depth pixels without measurement; speckle makes up what is missing"},
      {"dark_holes", &F::dark_holes, 0, 1, "share of hair, dark cloth and dark paint without measurement"},
      {"monitor_holes", &F::monitor_holes, 0, 1, "share of monitors without measurement"},
      {"flying_px", &F::flying_px, 0, 12, "width of the pixels between near and far at a depth edge"},
      {"wrong_side_px", &F::wrong_side_px, 0, 12, "how far a depth edge is off its place, to and fro along the edge"},
      {"shadow_px", &F::shadow_px, 0, 100, "width of the projector's shadow that 2 m casts on 4 m; left side"},
      {"registration_px", &F::registration_px, 0, 20, "shift of depth against colour; direction from the seed"},
      {"parallax_px_m", &F::parallax_px_m, -50, 50, "shift to the right by this times (1/depth - 1/2 m)"},
      {"depth_error", &F::depth_error, -0.2, 0.2, "systematic, relative"},
      {"rolling_shutter_ms", &F::rolling_shutter_ms, 0, 100, "colour: from the first row to the last"},
      {"depth_shutter_ms", &F::depth_shutter_ms, 0, 100, "depth: from the first row to the last"},
      {"blur_ms", &F::blur_ms, 0, 100, "exposure time of colour"},
      {"depth_lag_ms", &F::depth_lag_ms, -100, 100, "depth is seen so much later than colour"},
      {"depth_missing_every", &F::depth_missing_every, 0, 1000, "every n-th frame has no depth; 0 = none"},
      {"drops", &F::drops, 0, 0.9, "share of the frames that are lost"},
      {"exposure_ev", &F::exposure_ev, 0, 4, "the light changes, the image is up to so many stops wrong"},
      {"exposure_lag_frames", &F::exposure_lag_frames, 0, 100, "time constant of the automatic exposure"},
      {"vignetting", &F::vignetting, 0, 0.9, "loss of brightness in the corners"},
      {"jpeg", &F::jpeg, 0, 100, "quality; 0 = not compressed"},
      {"distortion", &F::distortion, 0, 2, "of the lens, times that of TUM's freiburg1"},
      {"calibration_error", &F::calibration_error, 0, 0.1,
       "focal lengths, principal point (of the image size): off by this share; signs from the seed"}};
  return parameters;
}

const std::vector<std::pair<std::string, SensorFaults>>& sensor_presets() {
  static const std::vector<std::pair<std::string, SensorFaults>> presets = {
      // Structured light, colour and depth rolling; lens and calibration as TUM's freiburg1.
      {"kinect",
       {.noise_correlation_px = 5,
        .holes = 0.2,
        .dark_holes = 0.75,
        .monitor_holes = 0.9,
        .flying_px = 2,
        .wrong_side_px = 2,
        .shadow_px = 14,
        .registration_px = 1.5,
        .parallax_px_m = 2,
        .depth_error = 0.015,
        .rolling_shutter_ms = 21,
        .depth_shutter_ms = 26,
        .blur_ms = 10,
        .depth_lag_ms = 9,
        .exposure_ev = 0.75,
        .vignetting = 0.25,
        .distortion = 1,
        .calibration_error = 0.01}},
      // Active stereo: global shutter and fine steps, but noisier, with wide flying edges; colour as JPEG by USB.
      {"d435",
       {.disparity_step_px = 0.05,
        .disparity_noise_px = 0.13,
        .noise_correlation_px = 7,
        .holes = 0.15,
        .dark_holes = 0.6,
        .monitor_holes = 0.7,
        .flying_px = 4,
        .wrong_side_px = 3,
        .shadow_px = 8,
        .registration_px = 1,
        .parallax_px_m = 1,
        .depth_error = 0.01,
        .rolling_shutter_ms = 15,
        .blur_ms = 8,
        .depth_lag_ms = -5,
        .exposure_ev = 0.75,
        .vignetting = 0.2,
        .jpeg = 80,
        .calibration_error = 0.005}}};
  return presets;
}

}  // namespace rtd::camera::synthetic
