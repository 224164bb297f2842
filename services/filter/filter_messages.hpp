// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/msg/camera_frame.hpp"
#include "common/msg/features.hpp"
#include "common/msg/rgbd_frame.hpp"
#include "common/msg/ros.hpp"
#include "common/msg/tracking.hpp"
#include "services/filter/core/dynamic_filter.hpp"

namespace rtd::filter {

/// Best hypothesis of every box. Boxes without a hypothesis, without area or with numbers that are not finite are left
/// out; of more than 300, the best are kept.
DetectionBatch to_detection_batch(const msg::Detection2DArray& message);

/// Labels of the detector's topic of masks; without any where the message is broken.
struct MaskMessage {
  vision::PersonMasks masks;
  std::string problem;  ///< another encoding than mono8, or a step or number of bytes that does not fit the size
};
MaskMessage to_person_masks(const msg::Image& message);
/// Takes masks away that cannot belong to their detections in a frame of this size. Why, of the last one; empty: none.
std::string drop_misfits(std::vector<DetectionBatch>& batches, const msg::FrameView& frame);

/// slam's pose of a frame; nullopt when it did not track that frame.
std::optional<SlamPose> to_slam_pose(const msg::TrackingResult& result);
SlamKeyframe to_slam_keyframe(const msg::KeyframeEvent& event);

/// Fills a feature message. Of more than kMaxFeatures features, the removed ones are left out first.
void fill_message(const msg::FrameView& frame, const FilterResult& result, msg::DetectionUse use,
                  msg::FeatureFrame& message);

/// What moves, as a grey image of grid cells (4x4 undistorted pixels each) with the values of CellMotion and the stamp
/// of the frame. Mode off takes everything to be static: all its cells are.
msg::Image make_mask(const msg::FrameView& frame, const FilterResult& result,
                     const std::string& camera_frame = msg::kCameraFrame);

}  // namespace rtd::filter
