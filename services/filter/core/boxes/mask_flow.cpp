// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/boxes/mask_flow.hpp"
#include "common/vision/samples.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

namespace rtd::filter {
namespace {

constexpr float kReduction = 2;  // half resolution: a quarter of the time, and movers do not need sub-pixels
constexpr int kMaxLevel = 2;     // with the window: finds shifts of some 60 px of the full image
const cv::Size kWindow{11, 11};
constexpr float kMaxReturnPx = 1.0F;  // forward and backward again, at half resolution

const std::vector<cv::Mat>& pyramid_of(const cv::Mat& grey, std::vector<cv::Mat>& pyramid) {
  if (pyramid.empty()) cv::buildOpticalFlowPyramid(grey, pyramid, kWindow, kMaxLevel, false);
  return pyramid;
}

/// Change of size: distances between pairs of points, now over before.
float scale_of(const std::vector<cv::Point2f>& from_px, const std::vector<cv::Point2f>& to_px) {
  constexpr float kMinDistancePx = 10;
  std::vector<float> ratios;
  for (std::size_t i = 0; i < from_px.size(); ++i) {
    for (const std::size_t hop : {from_px.size() / 3, from_px.size() / 2}) {
      const std::size_t j = (i + hop) % from_px.size();
      const auto before = static_cast<float>(cv::norm(from_px[i] - from_px[j]));
      if (before >= kMinDistancePx) ratios.push_back(static_cast<float>(cv::norm(to_px[i] - to_px[j])) / before);
    }
  }
  return ratios.size() < kMinFlowPoints ? 1.0F : std::clamp(vision::median(std::move(ratios)), 0.8F, 1.25F);
}

}  // namespace

std::optional<BoxFlow> motion_of_points(const Box& box, const std::vector<cv::Point2f>& from_px,
                                        const std::vector<cv::Point2f>& to_px) {
  if (from_px.size() < kMinFlowPoints) return std::nullopt;
  const float scale = scale_of(from_px, to_px);
  const cv::Point2f centre(static_cast<float>(box.centre_px.x()), static_cast<float>(box.centre_px.y()));
  std::vector<float> dx, dy;
  for (std::size_t i = 0; i < from_px.size(); ++i) {
    const cv::Point2f grown = centre + scale * (from_px[i] - centre);  // where it would be if the centre stood still
    dx.push_back(to_px[i].x - grown.x);
    dy.push_back(to_px[i].y - grown.y);
  }
  return BoxFlow{{vision::median(std::move(dx)), vision::median(std::move(dy))}, scale};
}

void MaskFlow::see(std::int64_t stamp_ns, const cv::Mat& color_bgr) {
  if (!images_.empty() && stamp_ns <= images_.back().stamp_ns) images_.clear();
  cv::Mat grey, small;
  cv::cvtColor(color_bgr, grey, cv::COLOR_BGR2GRAY);
  cv::resize(grey, small, {std::max(1, grey.cols / 2), std::max(1, grey.rows / 2)}, 0, 0, cv::INTER_AREA);
  images_.push_back({stamp_ns, std::move(small), {}});
  if (images_.size() > kMaxImages) images_.pop_front();
}

MaskFlow::Image* MaskFlow::find(std::int64_t stamp_ns) {
  const auto found =
      std::find_if(images_.begin(), images_.end(), [&](const Image& image) { return image.stamp_ns == stamp_ns; });
  return found == images_.end() ? nullptr : &*found;
}

std::optional<PointsMotion> MaskFlow::follow(std::int64_t from_ns, std::int64_t to_ns, const Box& box,
                                             const std::vector<cv::Point2f>& points_px) {
  Image *from = find(from_ns), *to = find(to_ns);
  if (from == nullptr || to == nullptr || from->grey.size() != to->grey.size() || points_px.size() < kMinFlowPoints)
    return std::nullopt;
  const auto& before = pyramid_of(from->grey, from->pyramid);
  const auto& after = pyramid_of(to->grey, to->pyramid);
  const cv::TermCriteria enough(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 10, 0.05);
  std::vector<cv::Point2f> start, there, back;
  for (const cv::Point2f& p : points_px) start.push_back(p / kReduction);
  std::vector<std::uint8_t> found, returned;
  cv::calcOpticalFlowPyrLK(before, after, start, there, found, cv::noArray(), kWindow, kMaxLevel, enough);
  back = start;
  cv::calcOpticalFlowPyrLK(after, before, there, back, returned, cv::noArray(), kWindow, 0, enough,
                           cv::OPTFLOW_USE_INITIAL_FLOW);
  std::vector<cv::Point2f> good;
  PointsMotion motion;
  for (std::size_t i = 0; i < start.size(); ++i) {
    if (found[i] == 0 || returned[i] == 0 || cv::norm(back[i] - start[i]) > static_cast<double>(kMaxReturnPx)) continue;
    good.push_back(points_px[i]);
    motion.landed_px.push_back(there[i] * kReduction);
  }
  const std::optional<BoxFlow> flow = motion_of_points(box, good, motion.landed_px);
  if (!flow) return std::nullopt;
  motion.flow = *flow;
  return motion;
}

}  // namespace rtd::filter
