// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/recording/recording.hpp"

#include <algorithm>
#include <utility>

#include "common/camera/frame_source.hpp"
#include "common/camera/recording/driver_topics.hpp"

namespace rtd::camera {
namespace {

using recordings::Reader;
using Topics = std::vector<RecordedTopic>;
using Fits = bool (*)(const RecordedTopic&);

bool is_image(const RecordedTopic& topic) {
  return topic.type == "sensor_msgs/Image" || topic.type == "sensor_msgs/CompressedImage";
}
bool is_depth(const RecordedTopic& topic) {
  return is_image(topic) && named_as_depth(topic.name);
}
bool is_color(const RecordedTopic& topic) {
  return is_image(topic) && !named_as_other_than_color(topic.name);
}
bool is_infrared(const RecordedTopic& topic) {
  return is_image(topic) && named_as_infrared(topic.name);
}
bool is_info(const RecordedTopic& topic) {
  const bool of_sdk = topic.type == "std_msgs/String" && topic.name.starts_with("/device_");
  return topic.type == "sensor_msgs/CameraInfo" || (of_sdk && topic.name.ends_with("/camera_info"));
}

bool is_video(const RecordedTopic& topic) {
  return topic.type.ends_with("/FFMPEGPacket") || topic.type.ends_with("/CompressedVideo");
}

SourceError error(const Reader& recording, const std::string& cause) {
  return SourceError(recording.name() + ": " + cause + "; its topics are:\n" + list_topics(recording));
}

Topics fitting(const Reader& recording, Fits fits) {
  Topics chosen;
  for (const RecordedTopic& topic : recording.topics()) {
    if (topic.messages > 0 && fits(topic)) chosen.push_back(topic);
  }
  return chosen;
}

bool contains(const Topics& topics, const std::string& name) {
  return std::ranges::any_of(topics, [&name](const RecordedTopic& topic) { return topic.name == name; });
}

std::string check_named(const Reader& recording, const std::string& key, const std::string& name, Fits fits) {
  const RecordedTopic* topic = topic_named(recording, name);
  if (topic == nullptr) throw error(recording, "has no topic " + name + " (" + key + "=)");
  if (!fits(*topic)) throw error(recording, key + "=" + name + " is of type " + topic->type + ", which does not fit");
  if (topic->messages == 0) throw error(recording, "topic " + name + " (" + key + "=) has no messages");
  return name;
}

constexpr const char* kNameThem = "name them: ?color=TOPIC&depth=TOPIC";

SourceError several(const Reader& recording, const std::string& what, const std::vector<std::string>& candidates) {
  std::string text = "has several topics that could be " + what + ": ";
  for (const std::string& candidate : candidates) text += candidate + (&candidate == &candidates.back() ? "" : ", ");
  return error(recording, text + "; " + kNameThem);
}

std::vector<std::string> names_of(const Topics& topics) {
  std::vector<std::string> names;
  for (const RecordedTopic& topic : topics) names.push_back(topic.name);
  return names;
}

/// The one named, else all that fit.
std::vector<std::string> image_candidates(const Reader& recording, const std::string& key, const std::string& named,
                                          Fits fits) {
  if (named.empty()) return names_of(fitting(recording, fits));
  return {check_named(recording, key, named, is_image)};
}

/// The one candidate; the user must choose among several.
std::string only(const Reader& recording, const std::string& key, const std::vector<std::string>& candidates) {
  if (candidates.size() == 1) return candidates.front();
  if (!candidates.empty()) throw several(recording, key, candidates);
  if (const auto videos = fitting(recording, is_video); !videos.empty())
    throw error(recording,
                "has " + key + " only as video (" + videos.front().name + ", " + videos.front().type +
                    "), and H.264 and H.265 are not read: decode it while it plays ('ros2 run image_transport "
                    "republish ffmpeg raw', for foxglove_msgs with its own decoder), and record the images");
  throw error(recording, "has no " + key + " images that can be recognised by name; " + kNameThem);
}

/// In the dark there may be no colour: then the infrared camera that depth is computed for.
std::vector<std::string> color_candidates(const Reader& recording, const std::string& named) {
  auto color = image_candidates(recording, "color", named, is_color);
  return color.empty() ? names_of(fitting(recording, is_infrared)) : color;
}

TopicPair choose_images(const Reader& recording, const ImageTopics& named) {
  const auto color = color_candidates(recording, named.color);
  const auto depth = image_candidates(recording, "depth", named.depth, is_depth);
  const std::vector<TopicPair> known = driver_pairs(color, depth);
  if (known.size() == 1) return known.front();
  if (known.empty()) return {only(recording, "color", color), only(recording, "depth", depth)};
  std::vector<std::string> pairs;
  for (const TopicPair& pair : known) pairs.push_back("?color=" + pair.color + "&depth=" + pair.depth);
  throw several(recording, "color and depth", pairs);
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
std::string choose_info(const Reader& recording, const std::string& color) {
  const Topics infos = fitting(recording, is_info);
  const std::string beside = info_beside(infos, color);
  return beside.empty() && infos.size() == 1 ? infos.front().name : beside;
}

}  // namespace

RecordedMessage first_of(Reader& recording, const std::string& topic) {
  std::optional<RecordedMessage> message = recording.first(topic);
  if (message) return std::move(*message);
  std::string cause = "none of its messages can be read";
  if (const auto damages = recording.take_damages(); !damages.empty()) cause += ": " + damages.front();
  throw SourceError(recording.name() + ", topic " + topic + ": " + cause);
}

ImageTopics choose_topics(const Reader& recording, const ImageTopics& named) {
  ImageTopics topics;
  const TopicPair images = choose_images(recording, named);
  topics.color = images.color;
  topics.depth = images.depth;
  topics.info =
      named.info.empty() ? choose_info(recording, topics.color) : check_named(recording, "info", named.info, is_info);
  topics.depth_info = named.depth_info.empty() ? info_beside(fitting(recording, is_info), topics.depth)
                                               : check_named(recording, "depth_info", named.depth_info, is_info);
  return topics;
}

std::vector<std::string> transform_topics(const Reader& recording) {
  std::vector<std::string> names;
  for (const RecordedTopic& topic : recording.topics()) {
    if (is_tf(topic)) names.push_back(topic.name);
  }
  return names;
}

}  // namespace rtd::camera
