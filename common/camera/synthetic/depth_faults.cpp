// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/synthetic/depth_faults.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "common/camera/synthetic/geometry.hpp"
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

constexpr double kBlobPx = 4, kRaggedPx = 5;  ///< correlation of holes, and of the course of a depth edge
constexpr float kEdge = 0.12F;                ///< relative difference of 1/z across a depth edge
constexpr double kBareEdgePx = 1;             ///< the plain sensor measures nothing so near to an edge
constexpr float kFlying = 0.8F;               ///< share of the pixels on an edge that have a value
constexpr int kDarkPaint = 45;                ///< grey level
constexpr float kFarLoss = 0.5F;              ///< speckle: how much likelier 1 m farther is, in standard deviations
constexpr double kNoParallaxM = 2;
constexpr float kSameSurface = 0.02F;  ///< relative difference of depth between neighbours

/// Nearest (largest 1/z) and farthest of the pixels within a square.
struct Reach {
  cv::Mat nearest, farthest;
};
Reach reach_of(const cv::Mat& inverse_depth, int side_px) {
  const cv::Mat square = cv::Mat::ones(side_px, side_px, CV_8UC1);
  Reach reach;
  cv::dilate(inverse_depth, reach.nearest, square);
  cv::erode(inverse_depth, reach.farthest, square);
  return reach;
}

bool is_edge(float nearest, float farthest) {
  return nearest - farthest > kEdge * nearest;
}

bool is_dark(const cv::Vec3b& bgr) {
  return bgr[0] + bgr[1] + bgr[2] < 3 * kDarkPaint;
}

/// Two standard deviations of the noise are the largest displacement.
int displacement(float noise, double most_px) {
  return static_cast<int>(std::lround(std::clamp(static_cast<double>(noise) / 2, -1.0, 1.0) * most_px));
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

DepthFaults::DepthFaults(const SensorFaults& faults, const SensorModel& model, cv::Size size_px, std::uint64_t seed)
    : faults_(faults), model_(model), sensor_(model, seed) {
  if (faults.noise_correlation_px > 0) disparity_noise_.emplace(faults.noise_correlation_px, size_px, seed ^ 0xD15BULL);
  if (std::max({faults.holes, faults.dark_holes, faults.monitor_holes}) > 0) {
    blobs_.emplace(kBlobPx, size_px, seed ^ 0x401EULL);
  }
  if (faults.wrong_side_px > 0) ragged_.emplace(kRaggedPx, size_px, seed ^ 0xED6EULL);
  if (faults.flying_px > 0) mixing_.emplace(0, size_px, seed ^ 0xF1ULL);
  const double direction_rad = kTwoPi * static_cast<double>(SeededRandom(seed ^ 0x2E61ULL).unit());
  offset_px_ = cv::Point2d(std::cos(direction_rad), std::sin(direction_rad)) * faults.registration_px;
}

cv::Mat DepthFaults::measure(const DepthScene& view, std::uint64_t frame_index) const {
  const cv::Mat noise = disparity_noise_ ? disparity_noise_->window(frame_index) : cv::Mat();
  cv::Mat depth = sensor_.measure_depth(view.inverse_depth, frame_index, noise);
  if (faults_.flying_px > 0) fly(depth, view.inverse_depth, frame_index);
  if (faults_.wrong_side_px > 0) depth = wrong_sided(depth, view.inverse_depth, frame_index);
  if (faults_.dark_holes > 0 || faults_.monitor_holes > 0) lose_by_material(depth, view, frame_index);
  if (faults_.holes > 0) lose_speckle(depth, frame_index);
  if (faults_.depth_error != 0) scale(depth);
  return faults_.registration_px != 0 || faults_.parallax_px_m != 0 ? registered(depth) : depth;
}

/// Pixels on a depth edge get values between near and far where the plain sensor measures nothing.
void DepthFaults::fly(cv::Mat& depth, const cv::Mat& inverse_depth, std::uint64_t frame_index) const {
  const Reach reach = reach_of(inverse_depth, static_cast<int>(std::lround(faults_.flying_px)) + 1);
  const cv::Mat mixing = mixing_->window(frame_index);
  const float lost_above = mixing_->quantile(static_cast<double>(kFlying));
  for (int row = 0; row < depth.rows; ++row) {
    for (int column = 0; column < depth.cols; ++column) {
      const float nearest = reach.nearest.at<float>(row, column), farthest = reach.farthest.at<float>(row, column);
      if (!is_edge(nearest, farthest)) continue;
      const float noise = mixing.at<float>(row, column);
      const float share = std::clamp((noise + 2.0F) / (lost_above + 2.0F), 0.0F, 1.0F);
      const float mixed = farthest + (nearest - farthest) * share;
      depth.at<std::uint16_t>(row, column) =
          noise > lost_above || mixed <= 0 ? std::uint16_t{0} : sensor_.to_units(1.0F / mixed);
    }
  }
}

/// Pixels near a depth edge have the value of some pixels away: the edge is ragged, and values lie on its wrong side.
cv::Mat DepthFaults::wrong_sided(const cv::Mat& depth, const cv::Mat& inverse_depth, std::uint64_t frame_index) const {
  const double most_px = faults_.wrong_side_px + kBareEdgePx;
  const Reach reach = reach_of(inverse_depth, 2 * static_cast<int>(std::ceil(most_px)) + 1);
  const cv::Mat along_u = ragged_->window(2 * frame_index), along_v = ragged_->window(2 * frame_index + 1);
  cv::Mat moved = depth.clone();
  for (int row = 0; row < moved.rows; ++row) {
    for (int column = 0; column < moved.cols; ++column) {
      if (!is_edge(reach.nearest.at<float>(row, column), reach.farthest.at<float>(row, column))) continue;
      const int u = column + displacement(along_u.at<float>(row, column), most_px);
      const int v = row + displacement(along_v.at<float>(row, column), most_px);
      moved.at<std::uint16_t>(row, column) =
          depth.at<std::uint16_t>(std::clamp(v, 0, moved.rows - 1), std::clamp(u, 0, moved.cols - 1));
    }
  }
  return moved;
}

void DepthFaults::lose_by_material(cv::Mat& depth, const DepthScene& view, std::uint64_t frame_index) const {
  const cv::Mat blobs = blobs_->window(frame_index);
  const float dark_below = blobs_->quantile(faults_.dark_holes),
              monitor_below = blobs_->quantile(faults_.monitor_holes);
  for (int row = 0; row < depth.rows; ++row) {
    for (int column = 0; column < depth.cols; ++column) {
      const auto material = static_cast<Material>(view.material.at<std::uint8_t>(row, column));
      const bool monitor = material == Material::kMonitor;
      if (!monitor && material != Material::kDark && !is_dark(view.color_bgr.at<cv::Vec3b>(row, column))) continue;
      if (blobs.at<float>(row, column) < (monitor ? monitor_below : dark_below))
        depth.at<std::uint16_t>(row, column) = 0;
    }
  }
}

/// Loses blobs, far ones first, until the wanted share of the image is lost.
void DepthFaults::lose_speckle(cv::Mat& depth, std::uint64_t frame_index) const {
  const int measured = cv::countNonZero(depth);
  const int to_keep = static_cast<int>((1 - faults_.holes) * static_cast<double>(depth.total()));
  if (measured <= to_keep) return;
  cv::Mat firmness = blobs_->window(frame_index + 1).clone();  // not the field of the materials in this frame
  std::vector<float> of_measured;
  of_measured.reserve(static_cast<std::size_t>(measured));
  for (int row = 0; row < depth.rows; ++row) {
    for (int column = 0; column < depth.cols; ++column) {
      const std::uint16_t units = depth.at<std::uint16_t>(row, column);
      if (units == 0) continue;
      float& firm = firmness.at<float>(row, column);
      firm -= kFarLoss * static_cast<float>(units) / model_.depth_units_per_m;
      of_measured.push_back(firm);
    }
  }
  const auto limit = of_measured.begin() + (measured - to_keep);
  std::nth_element(of_measured.begin(), limit, of_measured.end());
  depth.setTo(0, firmness < static_cast<double>(*limit));
}

void DepthFaults::scale(cv::Mat& depth) const {
  depth.convertTo(depth, CV_16U, 1 + faults_.depth_error);
}

/// Moves every pixel to where the colour camera is thought to see it; the nearer one of two stays.
cv::Mat DepthFaults::registered(const cv::Mat& depth) const {
  cv::Mat moved = cv::Mat::zeros(depth.size(), CV_16UC1);
  const int down_px = static_cast<int>(std::lround(offset_px_.y));
  for (int row = std::max(0, -down_px); row < std::min(depth.rows, depth.rows - down_px); ++row) {
    register_row(depth, row, moved);
  }
  return moved;
}

void DepthFaults::register_row(const cv::Mat& depth, int row, cv::Mat& moved) const {
  const auto* from = depth.ptr<std::uint16_t>(row);
  auto* to = moved.ptr<std::uint16_t>(row + static_cast<int>(std::lround(offset_px_.y)));
  int last = -1;
  for (int column = 0; column < depth.cols; ++column) {
    if (from[column] == 0) continue;
    const double inverse_depth = static_cast<double>(model_.depth_units_per_m) / from[column];
    const double parallax_px = faults_.parallax_px_m * (inverse_depth - 1 / kNoParallaxM);
    const int target = static_cast<int>(std::lround(column + static_cast<double>(offset_px_.x) + parallax_px));
    const auto difference = static_cast<float>(column > 0 ? std::abs(from[column] - from[column - 1]) : from[column]);
    const bool crack = target == last + 2 && difference < kSameSurface * from[column];  // of a stretched surface
    for (int u = crack ? target - 1 : target; u <= target; ++u) {
      if (u >= 0 && u < depth.cols && (to[u] == 0 || from[column] < to[u])) to[u] = from[column];
    }
    last = target;
  }
}

}  // namespace rtd::camera::synthetic
