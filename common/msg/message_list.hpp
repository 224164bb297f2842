// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/msg/atlas.hpp"
#include "common/msg/features.hpp"
#include "common/msg/map_update.hpp"
#include "common/msg/movers.hpp"
#include "common/msg/rgbd_frame.hpp"
#include "common/msg/ros.hpp"
#include "common/msg/status.hpp"
#include "common/msg/tracking.hpp"

namespace rtd::msg {

template <class... T>
struct TypeList {};

/// Every message type that the bus carries.
using MessageTypes =
    TypeList<RgbdFrame, RgbdFrame848, RgbdFrame1280, RgbdFrame1920, FeatureFrame, KeyframeEvent, TrackingResult,
             ServiceStatus, CompressedImage, Image, CameraInfo, Detection2DArray, Odometry, PoseStamped, TFMessage,
             Path, PointCloud2, DiagnosticArray, MapUpdate, Movers, Detection3DArray, MarkerArray, OccupancyGrid,
             TransformStamped, KeyframeFeatures, KeyframeRequest, Submap, AtlasState, PoseArray>;

}  // namespace rtd::msg
