// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/bus/message_types.hpp"
#include "common/bus/qos.hpp"

namespace rtd::bus {

/// A topic: its DDS name, its type and its QoS profile, written down once for all services.
template <class T>
struct Topic {
  const char* name;
  QosProfile profile;
};

namespace topics {
inline constexpr Topic<msg::RgbdFrame> kFrame{"rtd/frame", QosProfile::kRawFrame};
/// The same for larger frames (common/bus/frame_topics.hpp).
inline constexpr Topic<msg::RgbdFrame848> kFrame848{"rtd/frame_848x480", QosProfile::kRawFrame};
inline constexpr Topic<msg::RgbdFrame1280> kFrame1280{"rtd/frame_1280x720", QosProfile::kRawFrame};
inline constexpr Topic<msg::RgbdFrame1920> kFrame1920{"rtd/frame_1920x1200", QosProfile::kRawFrame};
inline constexpr Topic<msg::FeatureFrame> kFeatures{"rtd/features", QosProfile::kFeatures};
inline constexpr Topic<msg::KeyframeEvent> kKeyframes{"rtd/keyframes", QosProfile::kKeyframes};
inline constexpr Topic<msg::TrackingResult> kTracking{"rtd/tracking", QosProfile::kTracking};
inline constexpr Topic<msg::MapUpdate> kMap{"rtd/map", QosProfile::kTracking};
inline constexpr Topic<msg::KeyframeFeatures> kKeyframeFeatures{"rtd/keyframe_features", QosProfile::kTracking};
inline constexpr Topic<msg::KeyframeRequest> kKeyframeRequest{"rtd/keyframe_request", QosProfile::kDetections};
inline constexpr Topic<msg::Submap> kSubmap{"rtd/submap", QosProfile::kDetections};
inline constexpr Topic<msg::AtlasState> kAtlas{"rtd/atlas", QosProfile::kLatched};
inline constexpr Topic<msg::Movers> kMovers{"rtd/movers", QosProfile::kDetections};
inline constexpr Topic<msg::ServiceStatus> kStatus{"rtd/status", QosProfile::kHeartbeat};
inline constexpr Topic<msg::CompressedImage> kColorJpeg{"rt/camera/color/image_raw/compressed",
                                                        QosProfile::kNetworkFrame};
/// Depth as colours, for people.
inline constexpr Topic<msg::CompressedImage> kDepthJpeg{"rt/camera/depth/preview/compressed",
                                                        QosProfile::kNetworkFrame};
inline constexpr Topic<msg::CameraInfo> kCameraInfo{"rt/camera/color/camera_info", QosProfile::kLatched};
inline constexpr Topic<msg::PoseStamped> kGroundTruth{"rt/camera/ground_truth", QosProfile::kPose};
inline constexpr Topic<msg::Detection2DArray> kDetections{"rt/detector/detections", QosProfile::kDetections};
/// The pixels of the persons among the detections with the same stamp (common/vision/detection.hpp).
inline constexpr Topic<msg::Image> kPersonMasks{"rt/detector/masks", QosProfile::kDetections};
inline constexpr Topic<msg::Image> kDynamicMask{"rt/filter/dynamic_mask", QosProfile::kDetections};
inline constexpr Topic<msg::Detection3DArray> kMoverBoxes{"rt/filter/movers", QosProfile::kDetections};
inline constexpr Topic<msg::MarkerArray> kMoverMarkers{"rt/filter/movers_markers", QosProfile::kDetections};
inline constexpr Topic<msg::Odometry> kOdometry{"rt/slam/odometry", QosProfile::kPose};
inline constexpr Topic<msg::PoseStamped> kPose{"rt/slam/pose", QosProfile::kPose};
inline constexpr Topic<msg::TFMessage> kTf{"rt/tf", QosProfile::kPose};
/// Where the parts of the robot are. Several nodes write it, each its own part: a reader must hold more than one
/// message.
inline constexpr Topic<msg::TFMessage> kTfStatic{"rt/tf_static", QosProfile::kKeyframes};
/// Each step of `map` -> `odom`: what it does to coordinates in `map` (docs/frames.md).
inline constexpr Topic<msg::TransformStamped> kMapJumps{"rt/slam/map_jumps", QosProfile::kLatched};
inline constexpr Topic<msg::Path> kPath{"rt/slam/path", QosProfile::kPose};
inline constexpr Topic<msg::PointCloud2> kMapPoints{"rt/slam/map_points", QosProfile::kLatched};
inline constexpr Topic<msg::PointCloud2> kDensePoints{"rt/dense/points", QosProfile::kLatched};
/// Some of the points of what moved, of the last frames.
inline constexpr Topic<msg::PointCloud2> kMovingPoints{"rt/dense/moving_points", QosProfile::kLatched};
inline constexpr Topic<msg::OccupancyGrid> kOccupancyGrid{"rt/map", QosProfile::kLatched};
/// Where the robots are in the joint map: those of AtlasState::robots that have met it, in their order.
inline constexpr Topic<msg::PoseArray> kAtlasRobots{"rt/atlas/robots", QosProfile::kLatched};
inline constexpr Topic<msg::PointCloud2> kAtlasPoints{"rt/atlas/points", QosProfile::kLatched};
/// The floor plans of the robots that have met, in one.
inline constexpr Topic<msg::OccupancyGrid> kAtlasFloorPlan{"rt/atlas/floor_plan", QosProfile::kLatched};
/// Each step of `map` -> `NAME/map`: what it does to coordinates in `map` (docs/frames.md). Several robots step at
/// once: a reader must hold more than one message.
inline constexpr Topic<msg::TransformStamped> kAtlasMapJumps{"rt/atlas/map_jumps", QosProfile::kKeyframes};
inline constexpr Topic<msg::DiagnosticArray> kDiagnostics{"rt/diagnostics", QosProfile::kPose};
}  // namespace topics

}  // namespace rtd::bus
