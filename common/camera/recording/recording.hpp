// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/ros_codec/wire.hpp"

namespace rtd::camera {

/// A topic of a recording.
struct RecordedTopic {
  std::string name, type;  ///< plain_type()
  std::uint64_t messages = 0;
  std::map<std::string, std::string> metadata;  ///< MCAP: of the channel
  /// How the file defines the type: "ros1msg", "ros2msg", "omgidl", ... and the text; empty when it does not.
  std::string schema_encoding = {}, schema_text = {};
};

/// "sensor_msgs/msg/Image" (ROS 2), "sensor_msgs::msg::dds_::Image_" (DDS) -> "sensor_msgs/Image" (ROS 1).
std::string plain_type(std::string type);

/// A message of a recording, not yet decoded.
struct RecordedMessage {
  std::string topic;
  std::int64_t recorded_ns = 0;
  ros::Wire wire = ros::Wire::kRos1;
  std::vector<std::uint8_t> bytes;
  std::string type = {};  ///< plain_type()
};

/// A file with messages of many topics, whatever its format. Throws SourceError when the file cannot be used; damaged
/// pieces are left out and reported by take_damages(). Not thread-safe.
class Recording {
 public:
  virtual ~Recording() = default;
  const std::string& name() const { return name_; }
  const std::vector<RecordedTopic>& topics() const { return topics_; }
  /// Empty when the topic has no message that can be read.
  virtual std::optional<RecordedMessage> first(const std::string& topic) = 0;
  /// When its first messages were recorded, at most so many.
  virtual std::vector<std::int64_t> first_times_ns(const std::string& topic, std::size_t most) = 0;
  /// Begins to play these topics: next() gives their messages in the order of recording.
  virtual void play(const std::vector<std::string>& topics) = 0;
  virtual std::optional<RecordedMessage> next() = 0;
  /// What was found damaged since the last call, one line each.
  virtual std::vector<std::string> take_damages() = 0;

 protected:
  explicit Recording(std::string name) : name_(std::move(name)) {}

  const std::string name_;
  std::vector<RecordedTopic> topics_;
};

/// Opens a ROS 1 bag. Throws SourceError.
std::unique_ptr<Recording> open_bag(const std::filesystem::path& file);

/// Opens a rosbag2 file of the storage plugin sqlite3 (.db3). Throws SourceError.
std::unique_ptr<Recording> open_db3(const std::filesystem::path& file);

/// Opens a recording of any form (recordings::open()) as MCAP: also folders of rosbag2, and files packed with zstd.
/// Messages in CDR (ROS 2, ours) and in ROS 1's encoding. Throws SourceError.
std::unique_ptr<Recording> open_mcap(const std::filesystem::path& file);

/// Opens a recording of any form by its first bytes: bags and databases where they lie, all else with open_mcap().
/// Throws SourceError.
std::unique_ptr<Recording> open_any(const std::filesystem::path& path);

/// The first message of a topic. Throws SourceError when there is none that can be read.
RecordedMessage first_of(Recording& recording, const std::string& topic);

/// The topics that make RGB-D frames. As options: what the user named, else empty.
struct ImageTopics {
  std::string color, depth, info, depth_info;
};

/// Completes what the user named: by the names that known drivers give (driver_topics.hpp), else the only topic of a
/// fitting type; the calibrations are those beside the images. `info` and `depth_info` stay empty
/// when there is none. Throws SourceError for a topic that is absent, of another type or ambiguous, listing the
/// topics there are.
ImageTopics choose_topics(const Recording& recording, const ImageTopics& named);

/// Null when there is none of this name.
const RecordedTopic* topic_named(const Recording& recording, const std::string& name);

/// The topics of type tf.
std::vector<std::string> transform_topics(const Recording& recording);

/// "  /camera/rgb/image_color (sensor_msgs/Image, 798 messages)", a line each: for messages.
std::string list_topics(const Recording& recording);

}  // namespace rtd::camera
