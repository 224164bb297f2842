// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/dense/ghost_measure.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace rtd::test_support {
namespace {

constexpr float kFreeM = 0.15F, kOnMoverM = 0.08F;
constexpr double kCoveredM = 0.05;
constexpr int kGrowPx = 3, kPixelStep = 8;

cv::Mat disc(int radius) {
  return cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * radius + 1, 2 * radius + 1});
}

}  // namespace

GhostMeasure::GhostMeasure(std::vector<dense::CloudPoint> points)
    : points_(std::move(points)), votes_(points_.size()), cells_({.voxel_m = kCoveredM, .max_voxels = 10'000'000}) {
  for (const dense::CloudPoint& point : points_) cells_.add({point.p_world, Eigen::Vector3f::UnitZ(), 0, 1, {}}, 1, 0);
}

void GhostMeasure::judge(const vision::RgbdImage& image, const cv::Mat& mask, const Eigen::Isometry3d& T_cloud_camera) {
  table_.fit(image.camera);
  const cv::Mat movers = mask.empty() ? cv::Mat::zeros(image.depth.size(), CV_8UC1) : mask;
  cv::Mat near_movers, on_movers;
  cv::dilate(movers, near_movers, disc(kGrowPx));
  cv::erode(movers, on_movers, disc(kGrowPx));
  const dense::DynamicMask all = dense::all_static();
  const dense::FusionConfig config;
  const dense::DepthView view(image, all, table_, config);
  judge_points(view, near_movers, on_movers, T_cloud_camera.inverse().cast<float>());
  judge_pixels(view, near_movers, T_cloud_camera.cast<float>());
}

void GhostMeasure::judge_points(const dense::DepthView& view, const cv::Mat& near_movers, const cv::Mat& on_movers,
                                const Eigen::Isometry3f& T_camera_cloud) {
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Eigen::Vector3f p_camera = T_camera_cloud * points_[i].p_world;
    if (p_camera.z() < 0.3F) continue;
    const int pixel = table_.raw_pixel(table_.project(p_camera));
    if (pixel < 0 || view.depth_m(pixel) <= 0) continue;
    const float behind_m = view.depth_m(pixel) - p_camera.z();
    if (near_movers.data[pixel] == 0) {
      if (std::abs(behind_m) <= kFreeM) {
        ++votes_[i].surface;
        errors_m_.push_back(std::abs(behind_m));
      } else if (view.nearest_around_m(pixel) - p_camera.z() > kFreeM) {
        ++votes_[i].through;
      }
    } else if (on_movers.data[pixel] != 0 && std::abs(behind_m) <= kOnMoverM) {
      ++votes_[i].mover;
    }
  }
}

void GhostMeasure::judge_pixels(const dense::DepthView& view, const cv::Mat& near_movers,
                                const Eigen::Isometry3f& T_cloud_camera) {
  for (int row = kPixelStep; row + kPixelStep < table_.height(); row += kPixelStep) {
    for (int column = kPixelStep; column + kPixelStep < table_.width(); column += kPixelStep) {
      const int pixel = row * table_.width() + column;
      if (near_movers.data[pixel] != 0 || !view.on_surface(column, row)) continue;
      const Eigen::Vector3f p = T_cloud_camera * (view.depth_m(pixel) * table_.ray(pixel));
      ++pixels_;
      bool covered = false;
      for (int i = 0; i < 27 && !covered; ++i) {
        const Eigen::Vector3f shift(static_cast<float>(i % 3 - 1), static_cast<float>(i / 3 % 3 - 1),
                                    static_cast<float>(i / 9 - 1));
        const dense::Voxel* voxel = cells_.at(p + static_cast<float>(kCoveredM) * shift);
        covered = voxel != nullptr && (voxel->p_world - p).norm() < kCoveredM;
      }
      covered_ += covered ? 1 : 0;
    }
  }
}

GhostReport GhostMeasure::report() const {
  GhostReport report;
  report.points = points_.size();
  for (const Votes& votes : votes_) {
    if (votes.through + votes.surface + votes.mover == 0) continue;
    ++report.judged;
    if (votes.through > votes.surface) {
      ++report.floating;
    } else if (votes.mover > 0 && votes.surface == 0) {
      ++report.on_movers;
    }
  }
  std::vector<float> errors = errors_m_;
  if (!errors.empty()) {
    std::nth_element(errors.begin(), errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2), errors.end());
    report.error_median_m = static_cast<double>(errors[errors.size() / 2]);
  }
  report.completeness = pixels_ == 0 ? 0 : static_cast<double>(covered_) / static_cast<double>(pixels_);
  return report;
}

}  // namespace rtd::test_support
