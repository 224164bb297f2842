// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/recording/recording.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>
#include <utility>

#include "common/camera/recording/sdk_topics.hpp"

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
    DriverNames{"/color/image_raw", "/depth/image_rect_raw"},                     // RealSense, not registered
    DriverNames{"/rgb/image_raw", "/stereo/image_raw"},                           // OAK (depthai-ros)
    DriverNames{"/rgb/image_rect", "/stereo/image_raw"},                          //
    DriverNames{"/color/image", "/stereo/depth"},                                 //
    DriverNames{"/rgb/image_raw", "/depth/image_raw"},                            // Azure Kinect, not registered
    DriverNames{"/sensor_1/Color_0/image/data", "/sensor_0/Depth_0/image/data"},  // RealSense SDK
    DriverNames{"/cam/sensor_2/frameType_2", "/cam/sensor_3/frameType_3"}};       // Orbbec SDK

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
  return topic.type == "sensor_msgs/CameraInfo" || (of_sdk && topic.name.ends_with("/camera_info")) ||
         topic.type.ends_with("StreamProfileInfo");
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
std::string info_topic(const Topics& infos, std::string image) {
  if (const std::string profile = orbbec_profile_topic(image); contains(infos, profile)) return profile;
  for (std::size_t slash = image.rfind('/'); slash != std::string::npos; slash = image.rfind('/')) {
    image.resize(slash);
    for (const char* name : {"/camera_info", "/info/camera_info"}) {
      if (contains(infos, image + name)) return image + name;
    }
  }
  return {};
}

/// The one next to the image, else the only one.
std::string choose_info(const Reader& recording, const std::string& color) {
  const Topics infos = fitting(recording, is_info);
  const std::string own = info_topic(infos, color);
  return own.empty() && infos.size() == 1 ? infos.front().name : own;
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
  return contains_any(topic, {"depth", "/stereo/image_raw", "/cam/sensor_3/"});
}

bool named_as_other_than_color(const std::string& topic) {
  if (topic.starts_with("/cam/sensor_")) return !topic.starts_with("/cam/sensor_2/");  // Orbbec SDK
  return named_as_depth(topic) || contains_any(topic, {"/ir", "infra", "mask"});
}

bool named_as_infrared(const std::string& topic) {
  return !named_as_depth(topic) && contains_any(topic, {"/infra1/", "/infra/", "/ir/", "/infrared_1/", "/left_ir/",
                                                        "/cam/sensor_1/", "/cam/sensor_6/"});
}

std::string sdk_depth_unit_topic(const std::string& depth_topic) {
  constexpr std::string_view kData = "/Depth_0/image/data";
  const std::size_t data = depth_topic.find(kData);
  if (!depth_topic.starts_with("/device_") || data == std::string::npos) return {};
  return depth_topic.substr(0, data) + "/option/Depth_Units/value";
}

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
  topics.depth_info = named.depth_info.empty() ? info_topic(fitting(recording, is_info), topics.depth)
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

std::unique_ptr<FrameSource> open_recording(std::string uri, std::unique_ptr<recordings::Reader> recording,
                                            const RecordingOptions& options) {
  const bool named = !options.topics.color.empty() || !options.topics.depth.empty();
  if (!named && !own_frames_topic(*recording).empty()) return make_own_frames(std::move(uri), std::move(recording));
  return make_image_pairs(std::move(uri), std::move(recording), options);
}

RecordingSource::RecordingSource(std::string uri, std::unique_ptr<recordings::Reader> recording)
    : recording_(std::move(recording)) {
  info_.uri = std::move(uri);
}

void RecordingSource::describe_rate(const std::string& topic) {
  constexpr std::size_t kTimes = 16;  // each may have to be unpacked
  constexpr double kMinHz = 0.1, kMaxHz = 1000;
  info_.frames = topic_named(*recording_, topic)->messages;
  const std::vector<std::int64_t> times_ns = recording_->first_times_ns(topic, kTimes);
  std::vector<std::int64_t> periods_ns;
  for (std::size_t i = 1; i < times_ns.size(); ++i) periods_ns.push_back(times_ns[i] - times_ns[i - 1]);
  std::ranges::sort(periods_ns);
  if (periods_ns.empty()) return;
  const auto median_ns = static_cast<double>(periods_ns[periods_ns.size() / 2]);
  if (median_ns > 0) info_.fps = std::clamp(1e9 / median_ns, kMinHz, kMaxHz);
}

void RecordingSource::take_damages() {
  for (std::string& damage : recording_->take_damages()) skips_.add({SkipReason::kDamagedRecord, std::move(damage)});
}

}  // namespace rtd::camera
