// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>

#include "common/msg/transform_eigen.hpp"
#include "services/filter/core/dynamic_filter.hpp"
#include "tests/unit/filter/orb/test_images.hpp"

namespace rtd::filter::test {

/// A textured wall and floor-like second plane, and a textured block in front that can move; the camera shifts
/// sideways. Everything is parallel to the image plane, so that a picture is three shifted textures and the truth is
/// exact.
class MovingScene {
 public:
  static constexpr double kFarM = 3.0, kNearM = 2.0, kBlockM = 1.3;

  /// The image of a camera at (camera_x_m, 0, 0) with the block's centre at block_x_m. Noise-free.
  vision::RgbdImage render(std::uint64_t seq, double camera_x_m, double block_x_m) const {
    vision::RgbdImage image = rgbd_image(cv::Mat(480, 640, CV_8UC1, cv::Scalar(128)), kFarM);
    image.seq = seq;
    image.stamp_ns = static_cast<std::int64_t>(seq) * 33'333'333;
    cv::Mat grey(480, 640, CV_8UC1);
    paint(grey, image, far_, {0, 0, 640, 300}, kFarM, camera_x_m);
    paint(grey, image, near_, {0, 300, 640, 180}, kNearM, camera_x_m);
    if (block_x_m < 5) {
      const int left =
          static_cast<int>(std::lround(320 + 525 * (block_x_m - camera_x_m) / kBlockM)) - kBlockPx.width / 2;
      paint(grey, image, block_, {left, 120, kBlockPx.width, kBlockPx.height}, kBlockM, camera_x_m - block_x_m);
    }
    cv::cvtColor(grey, image.color_bgr, cv::COLOR_GRAY2BGR);
    return image;
  }
  /// Pixels of the block.
  static cv::Rect block(double camera_x_m, double block_x_m) {
    const int left = static_cast<int>(std::lround(320 + 525 * (block_x_m - camera_x_m) / kBlockM)) - kBlockPx.width / 2;
    return {left, 120, kBlockPx.width, kBlockPx.height};
  }

 private:
  static inline const cv::Size kBlockPx{140, 220};

  /// Copies the part of a texture that a camera at x sees, sub-pixel exact.
  static void paint(cv::Mat& grey, vision::RgbdImage& image, const cv::Mat& texture, const cv::Rect& area,
                    double depth_m, double x_m) {
    const cv::Rect inside = area & cv::Rect(0, 0, 640, 480);
    if (inside.empty()) return;
    const double shift_px = 525 * x_m / depth_m + 600;
    cv::Mat shifted;
    const cv::Mat affine = (cv::Mat_<double>(2, 3) << 1, 0, shift_px, 0, 1, 0);
    cv::warpAffine(texture, shifted, affine, {640, 480}, cv::INTER_LINEAR | cv::WARP_INVERSE_MAP);
    shifted(inside).copyTo(grey(inside));
    image.depth(inside).setTo(cv::Scalar(depth_m / image.depth_scale_m));
  }
  static cv::Mat texture(std::uint64_t seed) {
    static std::map<std::uint64_t, cv::Mat> drawn;  // once for all scenes
    cv::Mat& image = drawn[seed];
    if (image.empty()) image = textured_image({1900, 480}, seed);
    return image;
  }
  const cv::Mat far_ = texture(1), near_ = texture(2), block_ = texture(3);
};

inline bool removed(const msg::Feature& feature) {
  return (feature.flags & msg::kFeatureRemoved) != 0;
}

/// Share of the features inside (or outside) an area that were removed; the seam of 12 px around it counts for neither.
inline double removed_share(const FilterResult& result, const cv::Rect& area, bool inside) {
  const cv::Rect core(area.x + 12, area.y + 12, area.width - 24, area.height - 24),
      wide(area.x - 24, area.y - 24, area.width + 48, area.height + 48);
  int count = 0, gone = 0;
  for (const msg::Feature& f : result.features) {
    const cv::Point2f p(f.u_px, f.v_px);
    if (inside ? !cv::Rect2f(core).contains(p) : cv::Rect2f(wide).contains(p)) continue;
    ++count;
    gone += removed(f) ? 1 : 0;
  }
  return count == 0 ? 0.0 : static_cast<double>(gone) / count;
}

}  // namespace rtd::filter::test
