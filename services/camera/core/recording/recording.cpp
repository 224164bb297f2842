// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/core/recording/recording.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "services/camera/core/frame_source.hpp"

namespace rtd::camera {
namespace {

void replace(std::string& text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from))
    text.replace(at, from.size(), to);
}

using Topics = std::vector<RecordedTopic>;
using Fits = bool (*)(const RecordedTopic&);

/// How known drivers name them, behind the camera's own name. Raw images before compressed ones; depth must be
/// registered to the colour image.
constexpr std::array kColorNames = {"/rgb/image_color",
                                    "/rgb/image_rect_color",
                                    "/color/image_raw",
                                    "/rgb/image_raw",
                                    "/color/image_raw/compressed",
                                    "/rgb/image_color/compressed",
                                    "/rgb/image_rect_color/compressed",
                                    "/rgb/image_raw/compressed"};
constexpr std::array kDepthNames = {"/aligned_depth_to_color/image_raw",
                                    "/depth_registered/hw_registered/image_rect_raw",
                                    "/depth_registered/image",
                                    "/depth_registered/image_raw",
                                    "/depth/image",
                                    "/aligned_depth_to_color/image_raw/compressedDepth",
                                    "/depth_registered/image_raw/compressedDepth",
                                    "/depth/image/compressedDepth"};

bool is_image(const RecordedTopic& topic) {
  return topic.type == "sensor_msgs/Image" || topic.type == "sensor_msgs/CompressedImage";
}
bool is_depth(const RecordedTopic& topic) {
  return is_image(topic) && topic.name.find("depth") != std::string::npos;
}
bool is_color(const RecordedTopic& topic) {
  const auto has = [&topic](const char* part) { return topic.name.find(part) != std::string::npos; };
  return is_image(topic) && !has("depth") && !has("/ir") && !has("infra") && !has("mask");
}
bool is_info(const RecordedTopic& topic) {
  return topic.type == "sensor_msgs/CameraInfo";
}

SourceError error(const Recording& recording, const std::string& cause) {
  return SourceError(recording.name() + ": " + cause + "; its topics are:\n" + list_topics(recording));
}

Topics fitting(const Recording& recording, Fits fits) {
  Topics chosen;
  for (const RecordedTopic& topic : recording.topics()) {
    if (topic.messages > 0 && fits(topic)) chosen.push_back(topic);
  }
  return chosen;
}

bool contains(const Topics& topics, const std::string& name) {
  return std::ranges::any_of(topics, [&name](const RecordedTopic& topic) { return topic.name == name; });
}

std::string check_named(const Recording& recording, const std::string& key, const std::string& name, Fits fits) {
  const RecordedTopic* topic = topic_named(recording, name);
  if (topic == nullptr) throw error(recording, "has no topic " + name + " (" + key + "=)");
  if (!fits(*topic)) throw error(recording, key + "=" + name + " is of type " + topic->type + ", which does not fit");
  if (topic->messages == 0) throw error(recording, "topic " + name + " (" + key + "=) has no messages");
  return name;
}

/// The one candidate; the user must choose among several.
std::string only(const Recording& recording, const std::string& key, const Topics& candidates) {
  if (candidates.size() == 1) return candidates.front().name;
  const std::string fix = "name it: ?" + key + "=TOPIC";
  if (candidates.empty()) throw error(recording, "has no " + key + " images that can be recognised by name; " + fix);
  throw error(recording, "has several topics that could be " + key + "; " + fix);
}

template <class Names>
std::string choose_image(const Recording& recording, const std::string& key, Fits fits, const Names& names) {
  const Topics candidates = fitting(recording, fits);
  for (const char* name : names) {
    Topics known = candidates;
    std::erase_if(known, [name](const RecordedTopic& topic) { return !topic.name.ends_with(name); });
    if (!known.empty()) return only(recording, key, known);
  }
  return only(recording, key, candidates);
}

/// The calibration topic lies next to the image topic: /camera/rgb/image_color, /camera/rgb/camera_info; in bags of the
/// RealSense SDK .../Color_0/image/data, .../Color_0/info/camera_info. Empty when there is none.
std::string info_beside(const Topics& infos, std::string image) {
  for (std::size_t slash = image.rfind('/'); slash != std::string::npos; slash = image.rfind('/')) {
    image.resize(slash);
    for (const char* name : {"/camera_info", "/info/camera_info"}) {
      if (contains(infos, image + name)) return image + name;
    }
  }
  return {};
}

/// The one beside the image, else the only one.
std::string choose_info(const Recording& recording, const std::string& color) {
  const Topics infos = fitting(recording, is_info);
  const std::string beside = info_beside(infos, color);
  return beside.empty() && infos.size() == 1 ? infos.front().name : beside;
}

}  // namespace

std::string plain_type(std::string type) {
  if (type.find("::dds_::") != std::string::npos && type.back() == '_') type.pop_back();
  replace(type, "::dds_::", "::");
  replace(type, "::", "/");
  replace(type, "/msg/", "/");
  return type;
}

RecordedMessage first_of(Recording& recording, const std::string& topic) {
  std::optional<RecordedMessage> message = recording.first(topic);
  if (message) return std::move(*message);
  std::string cause = "none of its messages can be read";
  if (const auto damages = recording.take_damages(); !damages.empty()) cause += ": " + damages.front();
  throw SourceError(recording.name() + ", topic " + topic + ": " + cause);
}

ImageTopics choose_topics(const Recording& recording, const ImageTopics& named) {
  ImageTopics topics;
  topics.color = named.color.empty() ? choose_image(recording, "color", is_color, kColorNames)
                                     : check_named(recording, "color", named.color, is_image);
  topics.depth = named.depth.empty() ? choose_image(recording, "depth", is_depth, kDepthNames)
                                     : check_named(recording, "depth", named.depth, is_image);
  topics.info =
      named.info.empty() ? choose_info(recording, topics.color) : check_named(recording, "info", named.info, is_info);
  topics.depth_info = named.depth_info.empty() ? info_beside(fitting(recording, is_info), topics.depth)
                                               : check_named(recording, "depth_info", named.depth_info, is_info);
  return topics;
}

const RecordedTopic* topic_named(const Recording& recording, const std::string& name) {
  const Topics& all = recording.topics();
  const auto found = std::ranges::find_if(all, [&](const RecordedTopic& topic) { return topic.name == name; });
  return found == all.end() ? nullptr : &*found;
}

std::vector<std::string> transform_topics(const Recording& recording) {
  std::vector<std::string> names;
  for (const RecordedTopic& topic : recording.topics()) {
    if (topic.type == "tf/tfMessage" || topic.type == "tf2_msgs/TFMessage") names.push_back(topic.name);
  }
  return names;
}

std::string list_topics(const Recording& recording) {
  std::string text;
  for (const RecordedTopic& topic : recording.topics()) {
    text += "  " + topic.name + " (" + topic.type + ", " + std::to_string(topic.messages) + " messages)\n";
  }
  if (text.empty()) return "  none";
  text.pop_back();
  return text;
}

}  // namespace rtd::camera
