// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/core/live/live_options.hpp"

#include <sstream>
#include <vector>

#include "common/io/text.hpp"
#include "services/camera/core/source_uri.hpp"

namespace rtd::camera {
namespace {

constexpr const char* kForm = "ros2:COLOR_TOPIC,DEPTH_TOPIC[,INFO_TOPIC][?calibration=FILE&tolerance_ms=20]";

std::vector<std::string> split_topics(const std::string& list) {
  std::vector<std::string> topics;
  std::istringstream words(list);
  for (std::string topic; std::getline(words, topic, ',');) {
    if (!topic.empty() && topic.front() != '/') topic.insert(topic.begin(), '/');
    topics.push_back(topic);
  }
  return topics;
}

/// "camera_info" beside the image, as image_transport has it.
std::string info_beside(std::string color) {
  constexpr const char* kTransport = "/compressed";
  if (color.ends_with(kTransport)) color.resize(color.size() - std::string(kTransport).size());
  return color.substr(0, color.rfind('/')) + "/camera_info";
}

std::int64_t parse_tolerance_ns(const std::string& text, const std::string& value) {
  constexpr double kMaxMs = 1000;
  const std::optional<double> ms = io::parse_number(value);
  if (!ms || !(*ms > 0) || *ms > kMaxMs) {
    throw SourceError("source '" + text + "': tolerance_ms is '" + value + "', allowed: more than 0, at most 1000");
  }
  return static_cast<std::int64_t>(*ms * 1e6);
}

}  // namespace

bool is_live(const std::string& uri) {
  return uri.starts_with("ros2:");
}

LiveOptions parse_live_options(const std::string& text) {
  const SourceUri uri = parse_source_uri(text);
  const std::vector<std::string> topics = split_topics(uri.path);
  bool complete = topics.size() == 2 || topics.size() == 3;
  for (const std::string& topic : topics) complete = complete && topic.size() > 1;
  if (!complete) throw SourceError("source '" + text + "' does not name its topics: " + kForm);
  LiveOptions options;
  options.topics = {topics[0], topics[1], topics.size() == 3 ? topics[2] : info_beside(topics[0])};
  if (topics[0] == topics[1]) throw SourceError("source '" + text + "': colour and depth are one topic: " + kForm);
  for (const auto& [key, value] : uri.parameters) {
    if (key == "calibration") {
      options.calibration_file = value;
    } else if (key == "tolerance_ms") {
      options.tolerance_ns = parse_tolerance_ns(text, value);
    } else {
      throw SourceError("source '" + text + "': unknown parameter '" + key +
                        "'; ros2: knows calibration, tolerance_ms");
    }
  }
  return options;
}

}  // namespace rtd::camera
