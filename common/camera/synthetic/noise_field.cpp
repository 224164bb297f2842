// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/synthetic/noise_field.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/camera/synthetic/texture.hpp"

namespace rtd::camera::synthetic {
namespace {

constexpr int kOffsets = 256;  ///< windows begin at so many columns and rows

std::vector<float> gaussian(double sigma_px) {
  const int reach = static_cast<int>(std::ceil(3 * sigma_px));
  std::vector<float> kernel;
  for (int i = -reach; i <= reach; ++i) {
    kernel.push_back(static_cast<float>(std::exp(-i * i / (2 * sigma_px * sigma_px))));
  }
  return kernel;
}

/// Convolves the rows, wrapping round, and transposes. Plain loops: the same bits on every processor.
cv::Mat smoothed_rows_transposed(const cv::Mat& field, const std::vector<float>& kernel) {
  cv::Mat smooth(field.cols, field.rows, CV_32FC1);
  const auto length = static_cast<int>(kernel.size());
  std::vector<float> row(static_cast<std::size_t>(field.cols + length));
  for (int y = 0; y < field.rows; ++y) {
    for (int x = 0; x < field.cols + length; ++x) row[static_cast<std::size_t>(x)] = field.at<float>(y, x % field.cols);
    for (int x = 0; x < field.cols; ++x) {
      float sum = 0;
      for (int k = 0; k < length; ++k)
        sum += kernel[static_cast<std::size_t>(k)] * row[static_cast<std::size_t>(x + k)];
      smooth.at<float>(x, y) = sum;
    }
  }
  return smooth;
}

void normalize(cv::Mat& field) {
  cv::Scalar mean, deviation;
  cv::meanStdDev(field, mean, deviation);
  field = (field - mean[0]) / deviation[0];
}

}  // namespace

NoiseField::NoiseField(double correlation_px, cv::Size window_px, std::uint64_t seed)
    : window_px_(window_px), seed_(seed), field_(window_px + cv::Size(kOffsets, kOffsets), CV_32FC1) {
  SeededRandom random(seed);
  std::generate(field_.begin<float>(), field_.end<float>(), [&] { return random.normal(); });
  if (correlation_px > 0) {  // white noise smoothed with sigma s has the correlation exp(-d^2 / (4 s^2))
    const std::vector<float> kernel = gaussian(correlation_px / 2);
    field_ = smoothed_rows_transposed(smoothed_rows_transposed(field_, kernel), kernel);
  }
  normalize(field_);
  sorted_.assign(field_.begin<float>(), field_.end<float>());
  std::sort(sorted_.begin(), sorted_.end());
}

cv::Mat NoiseField::window(std::uint64_t index) const {
  SeededRandom random(seed_ ^ (index * 0x9E3779B97F4A7C15ULL));
  const int x = random.index(kOffsets);
  return field_(cv::Rect({x, random.index(kOffsets)}, window_px_));
}

float NoiseField::quantile(double share) const {
  if (share <= 0) return -std::numeric_limits<float>::infinity();
  if (share >= 1) return std::numeric_limits<float>::infinity();
  return sorted_[static_cast<std::size_t>(share * static_cast<double>(sorted_.size()))];
}

}  // namespace rtd::camera::synthetic
