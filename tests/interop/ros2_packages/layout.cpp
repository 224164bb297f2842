// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// The C structs that rosidl makes of idl/ros2/rtd_msgs against the plain structs of common/msg: same size, same places.
#include <cstddef>

#include "common/msg/features.hpp"
#include "common/msg/rgbd_frame.hpp"
#include "common/msg/tracking.hpp"
#include "rtd_msgs/msg/feature_frame.h"
#include "rtd_msgs/msg/keyframe_event.h"
#include "rtd_msgs/msg/rgbd_frame.h"
#include "rtd_msgs/msg/tracking_result.h"

using namespace rtd::msg;
static_assert(sizeof(rtd_msgs__msg__TrackingResult) == sizeof(TrackingResult));
static_assert(offsetof(rtd_msgs__msg__TrackingResult, t_world_camera) == offsetof(TrackingResult, T_world_camera));
static_assert(offsetof(rtd_msgs__msg__TrackingResult, stage_ms) == offsetof(TrackingResult, stage_ms));
static_assert(sizeof(rtd_msgs__msg__FeatureFrame) == sizeof(FeatureFrame));
static_assert(offsetof(rtd_msgs__msg__FeatureFrame, features) == offsetof(FeatureFrame, features));
static_assert(sizeof(rtd_msgs__msg__KeyframeEvent) == sizeof(KeyframeEvent));
static_assert(offsetof(rtd_msgs__msg__KeyframeEvent, kind) == offsetof(KeyframeEvent, kind));
static_assert(sizeof(rtd_msgs__msg__RgbdFrame) == sizeof(RgbdFrame));
static_assert(offsetof(rtd_msgs__msg__RgbdFrame, depth) == offsetof(RgbdFrame, depth));

int main() {}
