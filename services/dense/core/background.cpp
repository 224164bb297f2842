// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/dense/core/background.hpp"

#include <cmath>
#include <limits>

namespace rtd::dense {

/// The painted image, in undistorted pixels of the target's camera.
struct BackgroundPainter::Canvas {
  cv::Mat bgra;     ///< CV_8UC4
  cv::Mat depth_m;  ///< CV_32F of what was painted, infinite where nothing was
  cv::Mat wanted;   ///< CV_8U, 1 = something moves there
  Eigen::Isometry3f T_camera_world = Eigen::Isometry3f::Identity();

  /// A nearer surface replaces one that is clearly behind it; of two views of one surface the first stays.
  bool takes(int column, int row, float z_m) const {
    constexpr float kSameSurfaceM = 0.08F;
    return column >= 0 && row >= 0 && column < wanted.cols && row < wanted.rows &&
           wanted.at<std::uint8_t>(row, column) != 0 && z_m < depth_m.at<float>(row, column) - kSameSurfaceM;
  }
  void put(int column, int row, float z_m, const cv::Vec3b& bgr) {
    depth_m.at<float>(row, column) = z_m;
    bgra.at<cv::Vec4b>(row, column) = {bgr[0], bgr[1], bgr[2], 255};
  }
};

void BackgroundPainter::remember(const vision::RgbdImage& image, const DynamicMask& mask,
                                 const Eigen::Isometry3d& T_world_camera, const KeyframePoses& keyframes) {
  newest_.image = image;
  newest_.image.color_bgr = image.color_bgr.clone();
  newest_.image.depth = image.depth.clone();
  newest_.mask = grow(mask, config_.mask_grow_cells);
  newest_.anchor = keyframes.newest();
  const Eigen::Isometry3d* T_world_anchor = keyframes.pose(newest_.anchor);
  newest_.T_anchor_camera = T_world_anchor == nullptr ? T_world_camera : T_world_anchor->inverse() * T_world_camera;
  if (seen_++ % interval_ != 0) return;
  views_.push_back(newest_);  // shares the images
  if (views_.size() <= max_views_) return;
  std::vector<PastView> every_second;
  for (std::size_t i = 0; i < views_.size(); i += 2) every_second.push_back(views_[i]);
  views_ = std::move(every_second);
  interval_ *= 2;
}

cv::Mat BackgroundPainter::paint(StaticMap& map) {
  if (seen_ == 0) return {};
  table_.fit(newest_.image.camera);
  const cv::Size size(table_.width(), table_.height());
  Canvas canvas{cv::Mat(size, CV_8UC4, cv::Scalar(0, 0, 0, 0)),
                cv::Mat(size, CV_32F, cv::Scalar(std::numeric_limits<double>::infinity())),
                cv::Mat(size, CV_8U, cv::Scalar(0)), pose(newest_, map).inverse().cast<float>()};
  const std::vector<CloudPoint> cloud = map.cloud();  // also follows the last corrections
  paint_own(newest_, canvas);
  for (auto view = views_.rbegin(); view != views_.rend(); ++view) {  // newest first: the light is most alike
    const auto& a = view->image.camera.parameters();
    const auto& b = newest_.image.camera.parameters();
    const bool same_camera = a.fx == b.fx && a.cx == b.cx && a.width == b.width && a.distortion == b.distortion;
    if (same_camera) paint_view(*view, pose(*view, map), map, canvas);
  }
  paint_cloud(cloud, canvas);
  return canvas.bgra;
}

Eigen::Isometry3d BackgroundPainter::pose(const PastView& view, const StaticMap& map) const {
  const Eigen::Isometry3d* T_world_anchor = map.keyframes().pose(view.anchor);
  return T_world_anchor == nullptr ? view.T_anchor_camera : *T_world_anchor * view.T_anchor_camera;
}

void BackgroundPainter::paint_own(const PastView& target, Canvas& canvas) const {
  for (int row = 0; row < table_.height(); ++row) {
    for (int column = 0; column < table_.width(); ++column) {
      const Eigen::Vector2f pixel(static_cast<float>(column), static_cast<float>(row));
      const int raw = table_.raw_pixel(pixel);
      if (target.mask.at(pixel.x(), pixel.y(), table_.width(), table_.height()) == DynamicMask::kDynamic) {
        canvas.wanted.at<std::uint8_t>(row, column) = 1;
      } else if (raw >= 0) {
        canvas.put(column, row, 0, target.image.color_bgr.at<cv::Vec3b>(raw / table_.width(), raw % table_.width()));
      }
    }
  }
}

/// Each static point of the view becomes a square of 2x2 pixels, so that nothing in between stays open.
void BackgroundPainter::paint_view(const PastView& view, const Eigen::Isometry3d& T_world_view, const StaticMap& map,
                                   Canvas& canvas) const {
  const DepthView depth(view.image, view.mask, table_, config_);
  const Eigen::Isometry3f T_world = T_world_view.cast<float>();
  for (int row = 1; row + 1 < table_.height(); ++row) {
    for (int column = 1; column + 1 < table_.width(); ++column) {
      const int raw = row * table_.width() + column;
      if (depth.depth_m(raw) <= 0) continue;
      const Eigen::Vector3f p_world = T_world * (depth.depth_m(raw) * table_.ray(raw));
      const Eigen::Vector3f p_camera = canvas.T_camera_world * p_world;
      if (p_camera.z() < static_cast<float>(config_.min_depth_m)) continue;
      const Eigen::Vector2f pixel = table_.project(p_camera);
      if (!(std::abs(pixel.x()) < 1e4F && std::abs(pixel.y()) < 1e4F)) continue;
      const int u = static_cast<int>(std::floor(pixel.x())), v = static_cast<int>(std::floor(pixel.y()));
      bool fits = false;
      for (int i = 0; i < 4 && !fits; ++i) fits = canvas.takes(u + i % 2, v + i / 2, p_camera.z());
      if (!fits || !depth.on_surface(column, row) || depth.motion(raw) != DynamicMask::kStatic) continue;
      if (!map.confirms(p_world)) continue;
      for (int i = 0; i < 4; ++i) {
        if (canvas.takes(u + i % 2, v + i / 2, p_camera.z())) {
          canvas.put(u + i % 2, v + i / 2, p_camera.z(), view.image.color_bgr.at<cv::Vec3b>(row, column));
        }
      }
    }
  }
}

/// Coarser, but it also covers what no kept view saw.
void BackgroundPainter::paint_cloud(const std::vector<CloudPoint>& cloud, Canvas& canvas) const {
  const double fx = newest_.image.camera.parameters().fx;
  for (const CloudPoint& point : cloud) {
    const Eigen::Vector3f p_camera = canvas.T_camera_world * point.p_world;
    if (p_camera.z() < static_cast<float>(config_.min_depth_m)) continue;
    const Eigen::Vector2f pixel = table_.project(p_camera);
    if (!(std::abs(pixel.x()) < 1e4F && std::abs(pixel.y()) < 1e4F)) continue;
    const int half = static_cast<int>(0.5 * fx * config_.voxel_m / static_cast<double>(p_camera.z())) + 1;
    const int u = static_cast<int>(std::lround(pixel.x())), v = static_cast<int>(std::lround(pixel.y()));
    const cv::Vec3b bgr(to_byte(point.bgr[0]), to_byte(point.bgr[1]), to_byte(point.bgr[2]));
    for (int row = v - half; row <= v + half; ++row) {
      for (int column = u - half; column <= u + half; ++column) {
        if (canvas.takes(column, row, p_camera.z())) canvas.put(column, row, p_camera.z(), bgr);
      }
    }
  }
}

void BackgroundPainter::clear() {
  views_.clear();
  newest_ = {};
  seen_ = 0;
  interval_ = 1;
}

}  // namespace rtd::dense
