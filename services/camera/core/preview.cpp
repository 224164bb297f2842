// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/core/preview.hpp"

#include <fmt/format.h>

#include <opencv2/imgproc.hpp>
#include <vector>

#include "services/camera/core/depth_colors.hpp"

namespace rtd::camera {
namespace {

constexpr double kEdgeStep = 1.08;                // of depth from one surface to the next
constexpr std::uint64_t kFewestEdgePixels = 500;  // in all frames
constexpr double kClearPeak = 1.15;               // times the mean score
constexpr std::uint64_t kCompareEvery = 5;        // frames
constexpr int kGapReach = 4;                      // px, from a pixel across a gap

/// Where the surface at a pixel ends if what is next measured in this direction lies behind: in the middle of the gap
/// that sensors leave at many edges.
std::optional<cv::Point> end_towards(const cv::Mat& depth, cv::Point at, cv::Point direction) {
  const double here = depth.at<std::uint16_t>(at);
  for (int k = 1; k <= kGapReach; ++k) {
    const double next = depth.at<std::uint16_t>(at + k * direction);
    if (next > kEdgeStep * here) return at + k / 2 * direction;
    if (next > 0) break;
  }
  return std::nullopt;
}

/// Depth edges, found from pixels at least `margin` away from the border.
std::vector<cv::Point> depth_edges(const cv::Mat& depth, cv::Size margin_px) {
  std::vector<cv::Point> edges;
  for (int y = margin_px.height; y < depth.rows - margin_px.height; ++y) {
    for (int x = margin_px.width; x < depth.cols - margin_px.width; ++x) {
      if (depth.at<std::uint16_t>(y, x) == 0) continue;
      for (const cv::Point direction : {cv::Point(1, 0), cv::Point(-1, 0), cv::Point(0, 1), cv::Point(0, -1)}) {
        const std::optional<cv::Point> end = end_towards(depth, {x, y}, direction);
        if (end) edges.push_back(*end);
      }
    }
  }
  return edges;
}

cv::Mat color_edges(const cv::Mat& color_bgr) {
  cv::Mat grey, right, down, strength;
  cv::cvtColor(color_bgr, grey, cv::COLOR_BGR2GRAY);
  cv::GaussianBlur(grey, grey, {5, 5}, 1.0);
  cv::Sobel(grey, right, CV_32F, 1, 0);
  cv::Sobel(grey, down, CV_32F, 0, 1);
  cv::magnitude(right, down, strength);
  return cv::min(strength, 150.0);  // a few strong edges must not outvote the rest
}

std::string depth_text(const DepthFigures& figures, bool unit_given) {
  if (!figures.median_m()) return {};
  const std::string doubt = figures.doubt(unit_given);
  return fmt::format("depth         median {:.2f} m, nine tenths below {:.2f} m\n", *figures.median_m(),
                     *figures.quantile_m(0.9)) +
         (doubt.empty() ? "" : "WARNING       " + doubt + '\n');
}

/// Where the parabola through three values has its top, relative to the middle one.
double top_of(double before, double middle, double after) {
  const double bend = before - 2 * middle + after;
  return bend < 0 ? 0.5 * (before - after) / bend : 0;
}

}  // namespace

void Preview::add(const SourceFrame& frame) {
  if (frames_ == 0) first_ns_ = frame.image.stamp_ns;
  newest_ns_ = frame.image.stamp_ns;
  color_ = frame.image.color_bgr;
  depth_ = frame.image.depth;
  holes_ += 1 - static_cast<double>(cv::countNonZero(depth_)) / static_cast<double>(depth_.total());
  offsets_s_ += frame.image.depth_offset_s;
  if (frame.image.depth_scale_m > 0) figures_.add(depth_, frame.image.depth_scale_m);
  if (frames_++ % kCompareEvery == 0) compare_edges(color_, depth_);
}

void Preview::compare_edges(const cv::Mat& color_bgr, const cv::Mat& depth) {
  const std::vector<cv::Point> edges = depth_edges(depth, {kReachX + kGapReach, kReachY + kGapReach});
  const cv::Mat strength = color_edges(color_bgr);
  edge_pixels_ += edges.size();
  for (int dy = -kReachY; dy <= kReachY; ++dy) {
    for (int dx = -kReachX; dx <= kReachX; ++dx) {
      double sum = 0;
      for (const cv::Point& edge : edges) sum += static_cast<double>(strength.at<float>(edge.y + dy, edge.x + dx));
      scores_.at<double>(dy + kReachY, dx + kReachX) += sum;
    }
  }
}

std::optional<cv::Point2d> Preview::registration_px() const {
  if (edge_pixels_ < kFewestEdgePixels) return std::nullopt;
  double best = 0;
  cv::Point at;
  cv::minMaxLoc(scores_, nullptr, &best, nullptr, &at);
  const bool inside = at.x > 0 && at.y > 0 && at.x < scores_.cols - 1 && at.y < scores_.rows - 1;
  if (!inside || best < kClearPeak * cv::mean(scores_)[0]) return std::nullopt;
  const auto score = [&](int x, int y) { return scores_.at<double>(y, x); };
  const double x = at.x - kReachX + top_of(score(at.x - 1, at.y), best, score(at.x + 1, at.y));
  const double y = at.y - kReachY + top_of(score(at.x, at.y - 1), best, score(at.x, at.y + 1));
  return cv::Point2d(-x, -y);
}

double Preview::rate_hz() const {
  if (newest_ns_ <= first_ns_) return 0;
  return static_cast<double>(frames_ - 1) * 1e9 / static_cast<double>(newest_ns_ - first_ns_);
}

double Preview::hole_share() const {
  return frames_ == 0 ? 0 : holes_ / static_cast<double>(frames_);
}

cv::Mat Preview::picture() const {
  if (frames_ == 0) return {};
  double nearest = 0, farthest = 0;
  const cv::Mat measured = depth_ > 0;
  cv::minMaxLoc(depth_, &nearest, &farthest, nullptr, nullptr, measured);
  cv::Mat both;
  cv::hconcat(color_, depth_colors(depth_, nearest, farthest), both);
  return both;
}

std::string Preview::text(const SourceInfo& info, const SourceCounters& counters) const {
  const auto& camera = info.camera.parameters();
  const std::optional<cv::Point2d> shift = registration_px();
  std::string text = fmt::format("source        {}\nframes        {}, {:.1f} per second, nominal {:g}\n", info.uri,
                                 frames_, rate_hz(), info.fps);
  text += fmt::format("size          {} px, fx {:.1f} fy {:.1f} cx {:.1f} cy {:.1f}\n", size_text(color_.size()),
                      camera.fx, camera.fy, camera.cx, camera.cy);
  for (const std::string& note : info.notes) text += "              " + note + '\n';
  text += fmt::format("depth unit    {:g} m\nholes         {:.1f} % of the depth image\n", info.depth_scale_m,
                      100 * hole_share());
  text += depth_text(figures_, info.depth_unit_given);
  text += fmt::format("depth - color {:.1f} ms by the stamps\n", 1e3 * depth_offset_s());
  text += shift ? fmt::format("              {:.1f} px to the right, {:.1f} px down by the edges\n", shift->x, shift->y)
                : std::string("              not measured in px: point the camera at objects in front of a wall\n");
  return text + fmt::format("left out      {} frames, without depth {}, reconnected {} times\n",
                            counters.skipped_total(), counters.frames_without_depth, counters.reconnects);
}

}  // namespace rtd::camera
