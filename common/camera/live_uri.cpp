// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/live_uri.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>
#include <vector>

#include "common/camera/frame_source.hpp"
#include "common/camera/source_schemes.hpp"
#include "common/camera/source_uri.hpp"
#include "common/io/printable.hpp"
#include "common/io/text.hpp"

namespace rtd::camera {
namespace {

double parse_mode_value(const std::string& uri, const std::string& key, const std::string& value, double most) {
  const std::optional<double> number = io::parse_number(value);
  if (number && *number >= 1 && *number <= most) return *number;
  throw SourceError(
      fmt::format("source '{}': {} is '{}', allowed: 1 to {:g}", io::abridged(uri), key, io::abridged(value), most));
}

void take_parameter(DeviceUri& uri, const std::string& key, const std::string& value) {
  constexpr double kMaxSide = 8192, kMaxFps = 300;
  if (key == "calibration") {
    uri.calibration_file = value;
  } else if (key == "tolerance_ms") {
    uri.tolerance_ns = parse_tolerance_ns(uri.text, value);
  } else if (key == "width") {
    uri.mode.width = static_cast<int>(parse_mode_value(uri.text, key, value, kMaxSide));
  } else if (key == "height") {
    uri.mode.height = static_cast<int>(parse_mode_value(uri.text, key, value, kMaxSide));
  } else if (key == "fps") {
    uri.mode.fps = parse_mode_value(uri.text, key, value, kMaxFps);
  } else {
    throw SourceError("source '" + io::abridged(uri.text) + "': unknown parameter '" + io::abridged(key) + "'; " +
                      uri.scheme + ": knows calibration, tolerance_ms, width, height, fps");
  }
}

}  // namespace

bool is_device(const std::string& uri) {
  return is_of_kind(uri, SourceKind::kDevice);
}

DeviceUri parse_device_uri(const std::string& text) {
  const SourceUri parsed = parse_source_uri(text);
  DeviceUri uri{text, parsed.scheme, parsed.path, {}, {}, kPairingToleranceNs, false};
  uri.recorded = uri.scheme == "openni2" && uri.device.ends_with(".oni");
  for (const auto& [key, value] : parsed.parameters) take_parameter(uri, key, value);
  return uri;
}

namespace {

constexpr const char* kForm =
    "ros2:COLOR_TOPIC,DEPTH_TOPIC[,INFO_TOPIC][?calibration=FILE&depth_info=TOPIC&registered=1&tolerance_ms=20]";

std::string absolute(std::string topic) {
  if (!topic.empty() && topic.front() != '/') topic.insert(topic.begin(), '/');
  return topic;
}

std::vector<std::string> split_topics(const std::string& list) {
  std::vector<std::string> topics;
  std::istringstream names(list);
  for (std::string topic; std::getline(names, topic, ',');) {
    topics.push_back(absolute(topic));
  }
  return topics;
}

/// "camera_info" next to the image, as image_transport has it.
std::string info_topic(std::string image) {
  for (const std::string transport : {"/compressed", "/compressedDepth"}) {
    if (image.ends_with(transport)) image.resize(image.size() - transport.size());
  }
  return image.substr(0, image.rfind('/')) + "/camera_info";
}

}  // namespace

bool is_live(const std::string& uri) {
  return is_of_kind(uri, SourceKind::kTopics) || is_device(uri);
}

void check_live_uri(const std::string& uri) {
  is_device(uri) ? static_cast<void>(parse_device_uri(uri)) : static_cast<void>(parse_live_options(uri));
}

LiveOptions parse_live_options(const std::string& text) {
  const SourceUri uri = parse_source_uri(text);
  const std::vector<std::string> topics = split_topics(uri.path);
  bool complete = topics.size() == 2 || topics.size() == 3;
  for (const std::string& topic : topics) complete = complete && topic.size() > 1;
  if (!complete) throw SourceError("source '" + io::abridged(text) + "' does not name its topics: " + kForm);
  LiveOptions options;
  options.topics = {topics[0], topics[1], topics.size() == 3 ? topics[2] : info_topic(topics[0]),
                    info_topic(topics[1])};
  if (topics[0] == topics[1])
    throw SourceError("source '" + io::abridged(text) + "': colour and depth are one topic: " + kForm);
  for (const auto& [key, value] : uri.parameters) {
    if (key == "calibration") {
      options.calibration_file = value;
    } else if (key == "tolerance_ms") {
      options.tolerance_ns = parse_tolerance_ns(text, value);
    } else if (key == "registered") {
      options.registered = parse_flag(text, key, value);
    } else if (key == "depth_info") {
      options.topics.depth_info = absolute(value);
    } else {
      throw SourceError("source '" + io::abridged(text) + "': unknown parameter '" + io::abridged(key) +
                        "'; ros2: knows calibration, depth_info, registered, tolerance_ms");
    }
  }
  return options;
}

}  // namespace rtd::camera
