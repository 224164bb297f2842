// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/recording/emitter_switch.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>

namespace rtd::camera {
namespace {

constexpr double kRatio = 1.3;  // of the textures of two images in turn
constexpr int kEnded = 30;      // images of one kind in a row: the emitter stays as it is

double texture_of(const cv::Mat& image) {
  cv::Mat fine;
  cv::Laplacian(image, fine, CV_16S);
  return cv::norm(fine, cv::NORM_L1) / static_cast<double>(fine.total() * static_cast<std::size_t>(fine.channels()));
}

}  // namespace

bool EmitterSwitch::shows_dots(const cv::Mat& image) {
  const double texture = texture_of(image);
  if (!alternates_) count_turn(texture);
  last_ = texture;
  return alternates_ && has_more(texture);
}

void EmitterSwitch::count_turn(double texture) {
  const int direction = texture > kRatio * last_ ? 1 : kRatio * texture < last_ ? -1 : 0;
  turns_ = direction != 0 && direction == -direction_ ? turns_ + 1 : 0;
  direction_ = direction;
  alternates_ = turns_ >= kTurns;
  with_dots_ = std::max(texture, last_);
  without_ = std::min(texture, last_);
}

bool EmitterSwitch::has_more(double texture) {
  constexpr double kNew = 0.3;
  const bool dots = texture > std::sqrt(with_dots_ * without_);
  double& level = dots ? with_dots_ : without_;
  level += kNew * (texture - level);
  same_ = dots == std::exchange(had_dots_, dots) ? same_ + 1 : 0;
  if (same_ < kEnded) return dots;
  *this = {};
  return false;
}

}  // namespace rtd::camera
