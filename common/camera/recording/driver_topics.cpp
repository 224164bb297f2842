// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/recording/driver_topics.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>

namespace rtd::camera {
namespace {

/// How a driver names the two images, behind the camera's own name and namespaces.
struct DriverNames {
  std::string_view color, depth;
};

/// In the order of preference: depth that is registered to colour comes first.
constexpr std::array kDrivers = {
    DriverNames{"/color/image_raw", "/aligned_depth_to_color/image_raw"},                    // RealSense, ROS 1 and 2
    DriverNames{"/rgb/image_raw", "/depth_to_rgb/image_raw"},                                // Azure Kinect
    DriverNames{"/rgb/image_rect_color", "/depth/depth_registered"},                         // ZED
    DriverNames{"/rgb/color/rect/image", "/depth/depth_registered"},                         // ZED, from version 5 on
    DriverNames{"/qhd/image_color_rect", "/qhd/image_depth_rect"},                           // Kinect v2 (iai)
    DriverNames{"/qhd/image_color", "/qhd/image_depth_rect"},                                //
    DriverNames{"/hd/image_color_rect", "/hd/image_depth_rect"},                             //
    DriverNames{"/hd/image_color", "/hd/image_depth_rect"},                                  //
    DriverNames{"/rgb/image_rect_color", "/depth_registered/hw_registered/image_rect_raw"},  // OpenNI
    DriverNames{"/rgb/image_rect_color", "/depth_registered/image"},                         //
    DriverNames{"/rgb/image_color", "/depth_registered/image"},                              //
    DriverNames{"/rgb/image_raw", "/depth_registered/image_raw"},                            //
    DriverNames{"/rgb/image_color", "/depth/image"},                                         // TUM
    DriverNames{"/color/image_raw", "/depth_registered/image_raw"},                          // Orbbec
    DriverNames{"/color/image_raw", "/depth/image_raw"},                                     // Orbbec
    DriverNames{"/color/image_raw", "/depth/image_rect_raw"},                      // RealSense, not registered
    DriverNames{"/rgb/image_raw", "/stereo/image_raw"},                            // OAK (depthai-ros)
    DriverNames{"/rgb/image_rect", "/stereo/image_raw"},                           //
    DriverNames{"/color/image", "/stereo/depth"},                                  //
    DriverNames{"/rgb/image_raw", "/depth/image_raw"},                             // Azure Kinect, not registered
    DriverNames{"/sensor_1/Color_0/image/data", "/sensor_0/Depth_0/image/data"}};  // RealSense SDK

constexpr std::array<std::string_view, 3> kColorTransports = {"", "/compressed", "/zstd"};
constexpr std::array<std::string_view, 3> kDepthTransports = {"", "/compressedDepth", "/zstd"};

std::optional<std::string> camera_of(const std::string& topic, const std::string& ending) {
  if (!topic.ends_with(ending)) return std::nullopt;
  return topic.substr(0, topic.size() - ending.size());
}

std::vector<TopicPair> pairs_ending(const std::vector<std::string>& color, const std::vector<std::string>& depth,
                                    const std::string& color_ending, const std::string& depth_ending) {
  std::vector<TopicPair> pairs;
  for (const std::string& topic : color) {
    const std::optional<std::string> camera = camera_of(topic, color_ending);
    if (!camera) continue;
    const std::string partner = *camera + depth_ending;
    if (std::ranges::find(depth, partner) != depth.end()) pairs.push_back({topic, partner});
  }
  return pairs;
}

std::string lower(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

bool contains_any(const std::string& topic, std::initializer_list<std::string_view> parts) {
  const std::string name = lower(topic);
  return std::ranges::any_of(parts, [&](std::string_view part) { return name.find(part) != std::string::npos; });
}

}  // namespace

std::vector<TopicPair> driver_pairs(const std::vector<std::string>& color, const std::vector<std::string>& depth) {
  for (const DriverNames& driver : kDrivers) {
    for (const std::string_view color_transport : kColorTransports) {
      for (const std::string_view depth_transport : kDepthTransports) {
        auto pairs = pairs_ending(color, depth, std::string(driver.color).append(color_transport),
                                  std::string(driver.depth).append(depth_transport));
        if (!pairs.empty()) return pairs;
      }
    }
  }
  return {};
}

bool named_as_depth(const std::string& topic) {
  return contains_any(topic, {"depth", "/stereo/image_raw"});
}

bool named_as_other_than_color(const std::string& topic) {
  return named_as_depth(topic) || contains_any(topic, {"/ir", "infra", "mask"});
}

bool named_as_infrared(const std::string& topic) {
  return !named_as_depth(topic) && contains_any(topic, {"/infra1/", "/infra/", "/ir/", "/infrared_1/", "/left_ir/"});
}

std::string sdk_depth_unit_topic(const std::string& depth_topic) {
  constexpr std::string_view kData = "/Depth_0/image/data";
  const std::size_t data = depth_topic.find(kData);
  if (!depth_topic.starts_with("/device_") || data == std::string::npos) return {};
  return depth_topic.substr(0, data) + "/option/Depth_Units/value";
}

}  // namespace rtd::camera
