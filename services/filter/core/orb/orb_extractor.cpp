// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/orb/orb_extractor.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "services/filter/core/orb/brief.hpp"
#include "services/filter/core/orb/corners.hpp"
#include "services/filter/core/orb/shrink.hpp"

namespace rtd::filter {
namespace {

constexpr int kStepPx = 8;

/// Splits the wanted number over the levels, each getting 1/scale of the one below: the same density per level pixel
/// along a line.
std::vector<int> share_of_levels(int wanted, int levels, double scale_factor) {
  const double ratio = 1.0 / scale_factor;
  double share = wanted * (1 - ratio) / (1 - std::pow(ratio, levels));
  std::vector<int> shares;
  int given = 0;
  for (int level = 0; level + 1 < levels; ++level, share *= ratio) {
    shares.push_back(static_cast<int>(std::lround(share)));
    given += shares.back();
  }
  shares.push_back(std::max(0, wanted - given));
  return shares;
}

}  // namespace

void UndistortionTable::fit(const geometry::CameraModel& camera) {
  if (parameters_ == camera.parameters()) return;
  parameters_ = camera.parameters();
  identity_ = !camera.distorted();
  nodes_.clear();
  if (identity_) return;
  columns_ = parameters_.width / kStepPx + 2;
  rows_ = parameters_.height / kStepPx + 2;
  nodes_.reserve(static_cast<std::size_t>(columns_ * rows_));
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) {
      const Eigen::Vector2d pixel = camera.undistort({column * kStepPx, row * kStepPx});
      nodes_.emplace_back(static_cast<float>(pixel.x()), static_cast<float>(pixel.y()));
    }
  }
}

cv::Point2f UndistortionTable::undistort(cv::Point2f raw_pixel) const {
  if (identity_) return raw_pixel;
  const float x = std::clamp(raw_pixel.x / kStepPx, 0.0F, static_cast<float>(columns_ - 1) - 1e-3F);
  const float y = std::clamp(raw_pixel.y / kStepPx, 0.0F, static_cast<float>(rows_ - 1) - 1e-3F);
  const int column = static_cast<int>(x), row = static_cast<int>(y);
  const float fx = x - static_cast<float>(column), fy = y - static_cast<float>(row);
  const cv::Point2f* upper = &nodes_[static_cast<std::size_t>(row * columns_ + column)];
  const cv::Point2f* lower = upper + columns_;
  return (upper[0] * (1 - fx) + upper[1] * fx) * (1 - fy) + (lower[0] * (1 - fx) + lower[1] * fx) * fy;
}

void ImagePyramid::build(const cv::Mat& image, int first_level) {
  size_ = image.size();
  if (image.channels() == 3) {
    cv::cvtColor(image, images_[0], cv::COLOR_BGR2GRAY);
  } else {
    image.copyTo(images_[0]);
  }
  const double enlarged =
      msg::feature_scale(static_cast<std::uint32_t>(size_.width), static_cast<std::uint32_t>(size_.height));
  if (enlarged > 1) cv::resize(images_[0], images_[0], {}, enlarged, enlarged, cv::INTER_CUBIC);
  double scale = 1.0;
  std::size_t from = 0;
  for (std::size_t level = 1; level < images_.size(); ++level) {
    scale *= scale_factor_;
    if (level < static_cast<std::size_t>(first_level)) continue;
    const cv::Size size(std::max(1, static_cast<int>(std::lround(images_[0].cols / scale))),
                        std::max(1, static_cast<int>(std::lround(images_[0].rows / scale))));
    shrink(images_[from], size, images_[level]);
    from = level;
  }
}

cv::Point2f ImagePyramid::to_base(cv::Point2f pixel, int level) const {
  const cv::Mat& from = image(level);
  const float scale_x = static_cast<float>(size_.width) / static_cast<float>(from.cols);
  const float scale_y = static_cast<float>(size_.height) / static_cast<float>(from.rows);
  return {(pixel.x + 0.5F) * scale_x - 0.5F, (pixel.y + 0.5F) * scale_y - 0.5F};
}

OrbExtractor::OrbExtractor(const OrbConfig& config) : config_(config), pyramid_(config.levels, config.scale_factor) {}

std::vector<msg::Feature> OrbExtractor::extract(const vision::RgbdImage& image, int feature_count, int first_level) {
  first_level = std::clamp(first_level, 0, pyramid_.levels() - 1);
  pyramid_.build(image.color_bgr, first_level);
  undistortion_.fit(image.camera);
  std::vector<msg::Feature> features;
  features.reserve(static_cast<std::size_t>(feature_count + 3 * config_.levels));
  const std::vector<int> wanted = share_of_levels(feature_count, pyramid_.levels() - first_level, config_.scale_factor);
  for (int level = first_level; level < pyramid_.levels(); ++level)
    append_level(image, level, wanted[static_cast<std::size_t>(level - first_level)], features);
  if (features.size() > msg::kMaxFeatures) features.resize(msg::kMaxFeatures);
  return features;
}

void OrbExtractor::append_level(const vision::RgbdImage& image, int level, int wanted,
                                std::vector<msg::Feature>& features) {
  const cv::Mat& grey = pyramid_.image(level);
  const cv::Rect whole(0, 0, grey.cols, grey.rows);
  const std::vector<Corner> corners = spread_corners(detect_corners(grey, config_), whole, wanted);
  if (corners.empty()) return;
  smooth(grey, smoothed_);
  for (const Corner& corner : corners) {
    const cv::Point centre(static_cast<int>(corner.x), static_cast<int>(corner.y));
    const cv::Point2f raw = pyramid_.to_base({corner.x, corner.y}, level);
    const cv::Point2f undistorted = undistortion_.undistort(raw);
    msg::Feature feature{};
    feature.u_raw_px = raw.x;
    feature.v_raw_px = raw.y;
    feature.u_px = undistorted.x;
    feature.v_px = undistorted.y;
    feature.depth_m = depth_at(image, raw.x, raw.y, config_);
    feature.angle_rad = centroid_angle_rad(grey, centre);
    feature.static_probability = 1.0F;
    feature.octave = static_cast<std::uint8_t>(level);
    feature.object_id = -1;
    feature.descriptor = rotated_brief(smoothed_, centre, feature.angle_rad);
    features.push_back(feature);
  }
}

float depth_at(const vision::RgbdImage& image, float u_raw_px, float v_raw_px, const OrbConfig& config) {
  const int u = static_cast<int>(std::lround(u_raw_px)), v = static_cast<int>(std::lround(v_raw_px));
  if (u < 0 || v < 0 || u >= image.depth.cols || v >= image.depth.rows) return 0.0F;
  const double depth_m = image.depth.at<std::uint16_t>(v, u) * image.depth_scale_m;
  return depth_m >= config.min_depth_m && depth_m <= config.max_depth_m ? static_cast<float>(depth_m) : 0.0F;
}

}  // namespace rtd::filter
