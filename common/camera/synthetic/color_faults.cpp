// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/synthetic/color_faults.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "common/camera/synthetic/texture.hpp"
#include "common/vision/image_codecs.hpp"

namespace rtd::camera::synthetic {
namespace {

constexpr double kSpanS = 0.8;             ///< the light changes once in every span
constexpr std::int64_t kSpansLooked = 12;  ///< back: what came before is forgotten
constexpr double kDisplayGamma = 2.2;

/// 1 in the middle, 1 - loss in the corners.
cv::Mat make_falloff(cv::Size size_px, double loss) {
  cv::Mat falloff(size_px, CV_32FC3);
  const double cx = (size_px.width - 1) / 2.0, cy = (size_px.height - 1) / 2.0;
  for (int row = 0; row < size_px.height; ++row) {
    for (int column = 0; column < size_px.width; ++column) {
      const double share = ((column - cx) * (column - cx) + (row - cy) * (row - cy)) / (cx * cx + cy * cy);
      falloff.at<cv::Vec3f>(row, column) = cv::Vec3f::all(static_cast<float>(1 - loss * share));
    }
  }
  return falloff;
}

}  // namespace

ColorFaults::ColorFaults(const SensorFaults& faults, cv::Size size_px, double fps, std::uint64_t seed)
    : faults_(faults), lag_s_(faults.exposure_lag_frames / fps), seed_(seed ^ 0xE4905ULL) {
  if (faults.vignetting > 0) falloff_ = make_falloff(size_px, faults.vignetting);
}

/// Brightness of the light in a span against the mean; nothing has changed at the start.
double ColorFaults::light_ev(std::int64_t span) const {
  SeededRandom random(seed_ ^ (static_cast<std::uint64_t>(span) * 0x9E3779B97F4A7C15ULL));
  return span <= 0 ? 0 : faults_.exposure_ev * static_cast<double>(random.between(-1, 1));
}

double ColorFaults::change_s(std::int64_t span) const {
  SeededRandom random(seed_ ^ 0xC4ULL ^ (static_cast<std::uint64_t>(span) * 0x9E3779B97F4A7C15ULL));
  return kSpanS * (static_cast<double>(span) + static_cast<double>(random.unit()));
}

/// Every change of the light is made up for by exp(-t / lag).
double ColorFaults::exposure_error_ev(double t_s) const {
  const auto now = static_cast<std::int64_t>(std::floor(t_s / kSpanS));
  double error_ev = 0;
  for (std::int64_t span = now - kSpansLooked; span <= now; ++span) {
    const double since_s = t_s - change_s(span);
    if (since_s < 0) continue;
    const double forgotten = lag_s_ > 0 ? std::exp(-since_s / lag_s_) : 0;
    error_ev += (light_ev(span) - light_ev(span - 1)) * forgotten;
  }
  return std::clamp(error_ev, -faults_.exposure_ev, faults_.exposure_ev);
}

void ColorFaults::expose(cv::Mat& color_bgr, double t_s) const {
  if (!falloff_.empty()) cv::multiply(color_bgr, falloff_, color_bgr, 1, CV_8U);
  if (faults_.exposure_ev <= 0) return;
  const double gain = std::pow(2.0, exposure_error_ev(t_s) / kDisplayGamma);  // on what a display shows
  color_bgr.convertTo(color_bgr, CV_8U, gain);
}

cv::Mat ColorFaults::compressed(const cv::Mat& color_bgr) const {
  const int quality = static_cast<int>(faults_.jpeg);
  if (quality == 0) return color_bgr;
  return vision::decode_image(vision::encode_jpeg(color_bgr, quality)).pixels;
}

}  // namespace rtd::camera::synthetic
