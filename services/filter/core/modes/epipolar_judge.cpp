// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/modes/epipolar_judge.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

namespace rtd::filter {
namespace {

constexpr int kMaxCorners = 1000;           ///< corners followed
constexpr double kCornerQuality = 0.01;     ///< of the strongest corner
constexpr double kCornerDistancePx = 8;     ///< between two corners
constexpr int kBorderPx = 5;                ///< matches that end nearer to the border are dropped
constexpr double kMaxPatchDifference = 25;  ///< mean grey value difference of the 3x3 patches; more: no match
constexpr double kRansacDistancePx = 0.2;   ///< of the matches that the fundamental matrix is made of
constexpr double kRansacConfidence = 0.99;  ///< that a sample without outliers was drawn
constexpr double kMaxDistancePx = 1;        ///< a point farther from its epipolar line has moved

constexpr std::size_t kMinMatches = 16;  // twice what the 8-point algorithm needs

/// Mean absolute difference of grey values of the 3x3 patches.
double patch_difference(const cv::Mat& before, const cv::Mat& now, const FlowMatch& match) {
  cv::Mat a, b;
  cv::getRectSubPix(before, {3, 3}, match.before, a);
  cv::getRectSubPix(now, {3, 3}, match.now, b);
  return cv::norm(a, b, cv::NORM_L1) / 9;
}

bool near_border(const cv::Point2f& p, const cv::Size& size, int border_px) {
  const auto border = static_cast<float>(border_px);
  return !(p.x >= border && p.y >= border && p.x < static_cast<float>(size.width) - border &&
           p.y < static_cast<float>(size.height) - border);
}

std::vector<cv::Point2f> undistorted(const std::vector<FlowMatch>& matches, cv::Point2f FlowMatch::*end,
                                     const geometry::CameraModel& camera) {
  std::vector<cv::Point2f> points;
  points.reserve(matches.size());
  for (const FlowMatch& match : matches) {
    const Eigen::Vector2d p = camera.undistort(Eigen::Vector2d((match.*end).x, (match.*end).y));
    points.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()));
  }
  return points;
}

/// Distance of a point to the epipolar line F x of its partner, px; 0 if there is no line.
double epipolar_distance_px(const cv::Matx33d& fundamental, const cv::Point2f& before, const cv::Point2f& now) {
  const cv::Vec3d line = fundamental * cv::Vec3d(before.x, before.y, 1);
  const double norm = std::hypot(line[0], line[1]);
  return norm > 0 ? std::abs(line.dot(cv::Vec3d(now.x, now.y, 1))) / norm : 0.0;
}

constexpr const char* kPerson = "person";

std::vector<int> cells_of_points(const Scene& scene, const std::vector<cv::Point2f>& raw_points) {
  std::vector<int> cells;
  cells.reserve(raw_points.size());
  for (const cv::Point2f& raw : raw_points) {
    const Eigen::Vector2d p = scene.image.camera.undistort(Eigen::Vector2d(raw.x, raw.y));
    cells.push_back(scene.shape().nearest_cell(p.x(), p.y()));
  }
  return cells;
}

}  // namespace

std::vector<FlowMatch> follow_corners(const cv::Mat& before, const cv::Mat& now) {
  std::vector<cv::Point2f> corners, ends;
  cv::goodFeaturesToTrack(before, corners, kMaxCorners, kCornerQuality, kCornerDistancePx);
  if (corners.empty()) return {};
  std::vector<unsigned char> found;
  std::vector<float> errors;
  cv::calcOpticalFlowPyrLK(before, now, corners, ends, found, errors, {21, 21}, 4);
  std::vector<FlowMatch> matches;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const FlowMatch match{corners[i], ends[i]};
    if (found[i] == 0 || near_border(match.now, now.size(), kBorderPx)) continue;
    if (patch_difference(before, now, match) <= kMaxPatchDifference) matches.push_back(match);
  }
  return matches;
}

std::vector<cv::Point2f> find_moving_points(const std::vector<FlowMatch>& matches,
                                            const geometry::CameraModel& camera) {
  if (matches.size() < kMinMatches) return {};
  const std::vector<cv::Point2f> before = undistorted(matches, &FlowMatch::before, camera);
  const std::vector<cv::Point2f> now = undistorted(matches, &FlowMatch::now, camera);
  cv::setRNGSeed(0);  // the same input gives the same result
  const cv::Mat found = cv::findFundamentalMat(before, now, cv::FM_RANSAC, kRansacDistancePx, kRansacConfidence);
  if (found.rows != 3 || found.cols != 3 || !cv::checkRange(found)) return {};
  const cv::Matx33d fundamental(found.ptr<double>());
  std::vector<cv::Point2f> moving;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    if (epipolar_distance_px(fundamental, before[i], now[i]) > kMaxDistancePx) moving.push_back(matches[i].now);
  }
  return moving;
}

CellMask moving_masks(const Scene& scene, const std::vector<cv::Point2f>& moving_points, int min_points,
                      int dilate_cells) {
  const std::vector<int> points = cells_of_points(scene, moving_points);
  CellMask moving(static_cast<std::size_t>(scene.shape().size()), 0);
  for (const SceneObject& object : scene.objects) {
    if (object.class_name != kPerson) continue;
    CellMask mask(moving.size(), 0);
    for (const int cell : object.cells) mask[static_cast<std::size_t>(cell)] = 1;
    mask = dilate(scene.shape(), mask, dilate_cells);
    const auto on_mask = std::count_if(points.begin(), points.end(),
                                       [&](int cell) { return mask[static_cast<std::size_t>(cell)] != 0; });
    if (on_mask <= min_points) continue;
    for (std::size_t cell = 0; cell < mask.size(); ++cell) moving[cell] = std::max(moving[cell], mask[cell]);
  }
  return moving;
}

Verdict EpipolarJudge::judge(const Scene& scene, std::vector<msg::Feature> features, StageClock& clock) {
  cv::Mat grey;
  cv::cvtColor(scene.image.color_bgr, grey, cv::COLOR_BGR2GRAY);
  std::vector<cv::Point2f> moving_points;
  if (grey_before_.size() == grey.size()) {
    moving_points = find_moving_points(follow_corners(grey_before_, grey), scene.image.camera);
  }
  grey_before_ = grey;
  const CellMask moving = moving_masks(scene, moving_points, config_.max_still_points, dilate_cells_);
  for (msg::Feature& feature : features) {
    const bool moves = moving[static_cast<std::size_t>(scene.shape().nearest_cell(feature.u_px, feature.v_px))] != 0;
    if (moves) feature.flags |= msg::kFeatureInHighMask | msg::kFeatureGeometryMoving;
    mark(feature, moves);
  }
  clock.finish(msg::kStageDepthCheck);
  return {.features = std::move(features), .motion = to_cell_motion(moving, false)};
}

}  // namespace rtd::filter
