// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

#include "common/msg/ros.hpp"

/// The standard messages as JSON, each field by its name: what another implementation reads and gives.
namespace rtd::msg {

// clang-format off
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Time, sec, nanosec)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Header, stamp, frame_id)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Point, x, y, z)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Vector3, x, y, z)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Quaternion, x, y, z, w)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Pose, position, orientation)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(PoseStamped, header, pose)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(PoseWithCovariance, pose, covariance)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Twist, linear, angular)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(TwistWithCovariance, twist, covariance)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(RosTransform, translation, rotation)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(TransformStamped, header, child_frame_id, transform)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(TFMessage, transforms)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Odometry, header, child_frame_id, pose, twist)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Path, header, poses)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(CompressedImage, header, format, data)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Image, header, height, width, encoding, is_bigendian, step, data)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(RegionOfInterest, x_offset, y_offset, height, width, do_rectify)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(CameraInfo, header, height, width, distortion_model, d, k, r, p, binning_x, binning_y, roi)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(PointField, name, offset, datatype, count)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(PointCloud2, header, height, width, fields, is_bigendian, point_step, row_step, data, is_dense)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Point2D, x, y)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Pose2D, position, theta)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(BoundingBox2D, center, size_x, size_y)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ObjectHypothesis, class_id, score)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ObjectHypothesisWithPose, hypothesis, pose)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Detection2D, header, results, bbox, id)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Detection2DArray, header, detections)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(KeyValue, key, value)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(DiagnosticStatus, level, name, message, hardware_id, values)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(DiagnosticArray, header, status)
// clang-format on

}  // namespace rtd::msg
