// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>

#include "common/camera/frame_source.hpp"
#include "common/geometry/camera_model.hpp"

namespace rtd::camera {

/// What is known about one of the two images of a frame.
struct ImageOrigin {
  std::string topic, frame_id;
  cv::Size size_px;                             ///< empty when unknown
  std::optional<geometry::CameraModel> camera;  ///< by a CameraInfo of its own
};

/// Why depth is not, or cannot be trusted to be, registered to colour; empty when it is. It is not when sizes or
/// intrinsics differ by more than half a pixel. Otherwise it is when its topic has the name that drivers give to
/// registered depth, when both images are in one frame that has a name, or when the image is that of the left infrared
/// camera (infra1), which RealSense computes depth for, with the same intrinsics; in RealSense SDK bags all are in
/// frame "0".
std::string why_unregistered(const ImageOrigin& color, const ImageOrigin& depth);

/// Whether a frame id says where an image was taken: neither empty nor the "0" of RealSense SDK bags.
bool names_a_place(const std::string& frame_id);
/// The frame without a slash in front; empty when it names no place.
std::string place_named(const std::string& frame_id);

/// Both images are in one frame that has a name: what differs is the raster alone.
bool same_place(const ImageOrigin& color, const ImageOrigin& depth);

/// Why an image in frame `frame_id` is not of this camera: another one sends on its topic. Empty when it is.
std::string of_other_camera(const ImageOrigin& followed, const std::string& frame_id);

/// The farthest that a point of the image lies apart in the two pinhole images, px; infinite for images of two sizes.
double difference_px(const geometry::CameraModel& a, const geometry::CameraModel& b);

/// The error for depth that cannot be registered: why it must be, what is missing and what the user can do. Depth of
/// another shape than colour cannot be taken as it is, and that is not advised.
SourceError unregistered(const std::string& source, const ImageOrigin& color, const ImageOrigin& depth,
                         const std::string& missing);

/// Depth that is registered (?registered=1) in fewer or more pixels, as many as colour has; as it is when it has the
/// size or another shape.
cv::Mat scaled_to(cv::Size color_px, const cv::Mat& depth);

}  // namespace rtd::camera
