// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace rtd::camera {

/// Two topics that make frames.
struct TopicPair {
  std::string color, depth;
};

/// The pairs that the best known driver makes of these topics: colour and depth behind the same names of camera and
/// namespace, raw images before compressed ones, depth registered to colour before depth that is not. One element: the
/// choice is clear; several: that many cameras; none: the names are not those of a driver in the table of
/// driver_topics.cpp (TUM, OpenNI, Orbbec, RealSense in ROS 1 and 2 and its SDK, OAK, Azure Kinect, Kinect v2, ZED).
std::vector<TopicPair> driver_pairs(const std::vector<std::string>& color, const std::vector<std::string>& depth);

/// Whether a driver gives this name to depth, or the name says so itself.
bool named_as_depth(const std::string& topic);

/// Whether the name is that of images without colour, of depth or of masks.
bool named_as_other_than_color(const std::string& topic);

/// Whether a driver gives this name to the left infrared camera of a stereo pair, or to the only one.
bool named_as_infrared(const std::string& topic);

/// The topic at which the RealSense SDK records the unit of a depth topic; empty for topics of others.
std::string sdk_depth_unit_topic(const std::string& depth_topic);

}  // namespace rtd::camera
