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

#include "common/io/byte_source.hpp"
#include "common/ros_codec/wire.hpp"

namespace rtd::recordings {

/// What a file of a recording is.
enum class Form {
  kMcap,
  kBag,     ///< of ROS 1
  kDb3,     ///< a database of rosbag2
  kPacked,  ///< with zstd, whatever it holds
  kOther,   ///< no recording
};

/// By how it begins. An MCAP file whose first bytes are damaged is known by the header behind them.
Form form_of(const io::ByteSource& source);

/// The same of a file. kOther for a folder and for what cannot be read.
Form form_of(const std::filesystem::path& path);

/// A topic of a recording.
/// Not longer than names of topics and types are in ROS 2. Others are not read: each message would repeat them.
bool is_name(const std::string& text);

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

/// What the zstd frame holds that a message of rosbag2's MESSAGE mode, or of the RealSense SDK, is; empty for bytes
/// that are none, or a damaged one. CDR never begins as zstd does.
std::optional<std::vector<std::uint8_t>> unpacked_message(ros::Bytes bytes);

/// A recording of any form: its topics, and their messages in the order of recording. Topics in another encoding than
/// CDR and that of ROS 1 are left out. Damaged pieces are left out and reported by take_damages(). Not thread-safe.
class Reader {
 public:
  virtual ~Reader() = default;
  const std::string& name() const { return name_; }
  const std::vector<RecordedTopic>& topics() const { return topics_; }
  /// The first message of a topic that can be read; empty when there is none. Ends what was played before.
  std::optional<RecordedMessage> first(const std::string& topic);
  /// When its first messages were recorded, at most so many.
  virtual std::vector<std::int64_t> first_times_ns(const std::string& topic, std::size_t most) = 0;
  /// Begins to play these topics: next() gives their messages in the order of recording.
  virtual void play(const std::vector<std::string>& topics) = 0;
  virtual std::optional<RecordedMessage> next() = 0;
  /// What was found damaged since the last call, one line each.
  virtual std::vector<std::string> take_damages() = 0;

 protected:
  explicit Reader(std::string name) : name_(std::move(name)) {}

  const std::string name_;
  std::vector<RecordedTopic> topics_;
};

/// Opens a recording. As a bag or a database, a file is read where it lies, and must be one; as any other form, the
/// path may name a recording of every form, which is read as an MCAP file (open.hpp). Throws mcap::RecordingFileError
/// when it cannot be used.
std::unique_ptr<Reader> open_reader(const std::filesystem::path& path, Form form);
/// The same, by the first bytes of the file.
std::unique_ptr<Reader> open_reader(const std::filesystem::path& path);

/// Null when there is none of this name.
const RecordedTopic* topic_named(const Reader& recording, const std::string& name);

/// Whether its messages are transforms of tf, of ROS 1 or ROS 2.
bool is_tf(const RecordedTopic& topic);

/// "  /camera/rgb/image_color (sensor_msgs/Image, 798 messages)", a line each: for messages.
std::string list_topics(const Reader& recording);

}  // namespace rtd::recordings
