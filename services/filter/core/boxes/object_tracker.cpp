// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/boxes/object_tracker.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "common/msg/stamps.hpp"
#include "common/vision/samples.hpp"

namespace rtd::filter {
namespace {

constexpr double kUnwatchedS = 0.5;  ///< without a detector for this long: geometry only

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

constexpr std::size_t kMaxPoints = 14;  // of one object

/// Features of a view inside a box at about the object's depth: corners that the optical flow can follow.
std::vector<cv::Point2f> points_on(const View& view, const Box& box, double depth_m, double tolerance_m) {
  std::vector<cv::Point2f> points;
  for (const msg::Feature& f : view.features) {
    const Eigen::Vector2d from_centre = Eigen::Vector2d(f.u_raw_px, f.v_raw_px) - box.centre_px;
    if ((from_centre.cwiseAbs() - 0.5 * box.size_px).maxCoeff() > 0 || f.depth_m <= 0) continue;
    if (depth_m > 0 && std::abs(static_cast<double>(f.depth_m) - depth_m) > tolerance_m) continue;
    points.emplace_back(f.u_raw_px, f.v_raw_px);
  }
  return vision::thin_out(std::move(points), kMaxPoints);
}

/// Median depth of a grid at some raw pixels, 0 = nothing measured.
double depth_at(const std::vector<cv::Point2f>& points_px, const geometry::CameraModel& camera, const DepthGrid& grid) {
  std::vector<float> depths;
  for (const cv::Point2f& p : points_px) {
    const Eigen::Vector2d pixel = camera.undistort({p.x, p.y});
    const int cell = grid.shape.cell_at(pixel.x(), pixel.y());
    if (cell >= 0 && grid.depth_m[static_cast<std::size_t>(cell)] > 0)
      depths.push_back(grid.depth_m[static_cast<std::size_t>(cell)]);
  }
  return static_cast<double>(vision::median(std::move(depths)));
}

/// Masks of an image of this size.
bool fit(const vision::PersonMasks& masks, const cv::Size& image_px) {
  const auto places = [](int px) { return (px + vision::kMaskStepPx - 1) / vision::kMaskStepPx; };
  return masks.columns == places(image_px.width) && masks.rows == places(image_px.height);
}

/// The detections that usable_detections() leaves, with the masks of those.
DetectionBatch usable_batch(const DetectionBatch& batch, const MotionLevels& levels) {
  DetectionBatch usable{batch.stamp_ns, {}, {}};
  std::array<std::uint8_t, vision::kMaxMasks + 1> renumbered{};
  for (const std::size_t index : usable_indices(batch.detections, levels)) {
    usable.detections.push_back(batch.detections[index]);
    if (index < vision::kMaxMasks) renumbered[index + 1] = static_cast<std::uint8_t>(usable.detections.size());
  }
  usable.masks = batch.masks;
  for (std::uint8_t& label : usable.masks.labels) label = renumbered[label];
  return usable;
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
  constexpr int kMaxRounds = 10;
  constexpr double kLastStepPx = 0.05;  // of the reduced image: less than the flow's own error
  const cv::TermCriteria enough(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, kMaxRounds, kLastStepPx);
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

ObjectTracker::ObjectTracker(const FilterConfig& config)
    : masks_(config.masks),
      use_tracks_(config.techniques.box_tracks),
      use_flow_(config.techniques.mask_flow),
      levels_(config.techniques.motion_levels ? MotionLevels(config.motion_levels)
                                              : MotionLevels(config.motion_levels).all_high()),
      tracks_(config.tracks) {}

std::vector<SceneObject> ObjectTracker::track(const DetectorUpdate& detector, const vision::RgbdImage& image,
                                              const DepthGrid& grid, const DepthClusters& clusters,
                                              const ViewStore& views) {
  const std::vector<ObjectBox> boxes =
      use_tracks_ ? tracked_boxes(detector, image, grid, views) : boxes_of_frame(detector, image);
  std::vector<SceneObject> objects = find_objects(boxes, levels_, image.camera, grid, clusters, masks_);
  learn_depths(objects, grid);
  return objects;
}

DetectionBatch ObjectTracker::usable_part(const DetectionBatch& batch, const vision::RgbdImage& image) const {
  DetectionBatch usable = usable_batch(batch, levels_);
  if (!fit(usable.masks, image.color_bgr.size())) usable.masks = {};
  return usable;
}

std::vector<ObjectBox> ObjectTracker::boxes_of_frame(const DetectorUpdate& detector,
                                                     const vision::RgbdImage& image) const {
  std::vector<ObjectBox> boxes;
  for (const DetectionBatch& batch : detector.batches) {
    if (batch.stamp_ns != image.stamp_ns) continue;
    const DetectionBatch usable = usable_part(batch, image);
    for (std::size_t i = 0; i < usable.detections.size(); ++i) {
      const vision::Detection& d = usable.detections[i];
      boxes.push_back({d, -1, 0, false, 0, BoxMask(usable.masks, static_cast<std::uint8_t>(i + 1), d)});
    }
  }
  return boxes;
}

std::vector<ObjectBox> ObjectTracker::tracked_boxes(const DetectorUpdate& detector, const vision::RgbdImage& image,
                                                    const DepthGrid& grid, const ViewStore& views) {
  if (detector.active) detector_active_ns_ = image.stamp_ns;
  if (static_cast<double>(msg::apart_ns(image.stamp_ns, detector_active_ns_)) > 1e9 * kUnwatchedS) {
    clear();  // geometry only
    return {};
  }
  if (use_flow_) flow_.see(image.stamp_ns, image.color_bgr);
  tracks_.begin_frame(
      {image.stamp_ns, static_cast<double>(image.color_bgr.cols), static_cast<double>(image.color_bgr.rows)});
  const auto depth_of = [&](std::int64_t stamp_ns, const vision::Detection& box) {
    if (stamp_ns == image.stamp_ns) return depth_in_box(box, image.camera, grid);
    const View* view = views.at(stamp_ns);
    return view == nullptr ? 0.0 : depth_in_box(box, image.camera, view->grid);
  };
  for (const DetectionBatch& batch : detector.batches) {
    tracks_.update(usable_part(batch, image), depth_of);
  }
  if (use_flow_) tracks_.carry([&](const CarryStep& step) { return measure(step, image, grid, views); });
  std::vector<ObjectBox> boxes;
  for (TrackedBox& box : tracks_.boxes())
    boxes.push_back({box.detection, box.id, box.age_s, box.carried, box.depth_m, std::move(box.mask)});
  return boxes;
}

std::optional<CarriedBox> ObjectTracker::measure(const CarryStep& step, const vision::RgbdImage& image,
                                                 const DepthGrid& grid, const ViewStore& views) {
  if (levels_.find(step.class_name) != MotionLevel::kHigh) return std::nullopt;  // geometry decides: not worth the time
  const View *from = views.at(step.from_ns), *to = views.at(step.to_ns);
  if (from == nullptr || (to == nullptr && step.to_ns != image.stamp_ns)) return std::nullopt;
  const auto points = points_on(*from, step.box, step.depth_m, masks_.max_object_depth_m);
  const std::optional<PointsMotion> motion = flow_.follow(step.from_ns, step.to_ns, step.box, points);
  if (!motion) return std::nullopt;
  return CarriedBox{motion->flow, depth_at(motion->landed_px, image.camera, to == nullptr ? grid : to->grid)};
}

/// The depths at which the masks of this frame lie: where the objects are expected next.
void ObjectTracker::learn_depths(const std::vector<SceneObject>& objects, const DepthGrid& grid) {
  for (const SceneObject& object : objects) {
    if (object.track_id < 0) continue;
    std::vector<float> depths;
    for (const int cell : object.cells) {
      const float depth_m = grid.depth_m[static_cast<std::size_t>(cell)];
      if (depth_m > 0) depths.push_back(depth_m);
    }
    if (!depths.empty()) tracks_.set_depth(object.track_id, static_cast<double>(vision::median(std::move(depths))));
  }
}

void ObjectTracker::clear() {
  tracks_.clear();
  flow_.clear();
}

}  // namespace rtd::filter
