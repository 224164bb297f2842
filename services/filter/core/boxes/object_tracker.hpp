// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "common/vision/motion_levels.hpp"
#include "common/vision/rgbd_image.hpp"
#include "services/filter/core/boxes/box_tracks.hpp"
#include "services/filter/core/boxes/kalman.hpp"
#include "services/filter/core/config/filter_config.hpp"
#include "services/filter/core/motion/view_store.hpp"
#include "services/filter/core/surfaces/depth_grid.hpp"
#include "services/filter/core/surfaces/object_masks.hpp"

namespace rtd::filter {

/// How the points on an object moved from one image to another.
struct PointsMotion {
  BoxFlow flow;
  std::vector<cv::Point2f> landed_px;  ///< where they are now, those that were found again
};

/// Median shift of a box's centre and its median change of size from points on the object; empty with fewer than
/// kMinFlowPoints.
std::optional<BoxFlow> motion_of_points(const Box& box, const std::vector<cv::Point2f>& from_px,
                                        const std::vector<cv::Point2f>& to_px);
inline constexpr std::size_t kMinFlowPoints = 6;

/// Sparse optical flow (Lucas-Kanade in pyramids) between recent images at half resolution: follows points on objects
/// without a detection. A point counts if the flow backwards leads to where it started. Bounded: the last kMaxImages
/// images. All pixels are those of the camera's own image.
class MaskFlow {
 public:
  void see(std::int64_t stamp_ns, const cv::Mat& color_bgr);
  /// Empty when one of the images is not known or too few points are found again.
  std::optional<PointsMotion> follow(std::int64_t from_ns, std::int64_t to_ns, const Box& box,
                                     const std::vector<cv::Point2f>& points_px);
  void clear() { images_.clear(); }

  static constexpr std::size_t kMaxImages = 32;

 private:
  struct Image {
    std::int64_t stamp_ns;
    cv::Mat grey;
    std::vector<cv::Mat> pyramid;  ///< made when it is first needed
  };
  Image* find(std::int64_t stamp_ns);
  std::deque<Image> images_;
};

/// Finds the objects of every frame, whether the detector's boxes come early, late or not at all: box tracks, carried
/// by optical flow of the features on the object where no detection came, and the mask of each box.
/// docs/theory/dynamic_points.md section 6.
class ObjectTracker {
 public:
  explicit ObjectTracker(const FilterConfig& config);

  /// Once per frame, in order of time. `views` are earlier frames.
  std::vector<SceneObject> track(const DetectorUpdate& detector, const vision::RgbdImage& image, const DepthGrid& grid,
                                 const DepthClusters& clusters, const ViewStore& views);
  void clear();

 private:
  /// Detections of known classes; masks of pixels only when they are used and fit the image.
  DetectionBatch usable_part(const DetectionBatch& batch, const vision::RgbdImage& image) const;
  std::vector<ObjectBox> boxes_of_frame(const DetectorUpdate& detector, const vision::RgbdImage& image) const;
  std::vector<ObjectBox> tracked_boxes(const DetectorUpdate& detector, const vision::RgbdImage& image,
                                       const DepthGrid& grid, const ViewStore& views);
  std::optional<CarriedBox> measure(const CarryStep& step, const vision::RgbdImage& image, const DepthGrid& grid,
                                    const ViewStore& views);
  void learn_depths(const std::vector<SceneObject>& objects, const DepthGrid& grid);

  MaskConfig masks_;
  bool use_tracks_, use_flow_;
  MotionLevels levels_;
  BoxTracks tracks_;
  MaskFlow flow_;
  std::int64_t detector_active_ns_ = 0;  ///< stamp of the last frame for which a detector was active
};

}  // namespace rtd::filter
