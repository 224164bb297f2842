// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/replay/outputs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <utility>

#include "common/bus/frame_topics.hpp"
#include "common/bus/offered_qos.hpp"
#include "common/msg/ros.hpp"
#include "common/ros2/names.hpp"
#include "common/ros2/schema_texts.hpp"
#include "common/ros2/type_description.hpp"
#include "common/ros_codec/wire.hpp"
#include "common/service/config.hpp"
#include "common/service/monotonic_clock.hpp"

namespace rtd::replay {
namespace {

constexpr std::size_t kCdrHeaderBytes = 4;
constexpr std::size_t kPublishedAt = kCdrHeaderBytes + 16;  // behind seq and stamp_ns
constexpr char kFeaturesType[] = "rtd_msgs::msg::dds_::FeatureFrame_";
constexpr char kTrackingType[] = "rtd_msgs::msg::dds_::TrackingResult_";
// History for late readers. DDS does not announce the depth of a writer, so a recording seldom knows it.
constexpr int kFrameDepth = 8, kLatchedDepth = 10, kUsualDepth = 64;
constexpr int kSlowReaderMs = 2000;

/// Size of a frame of this DDS type; 0 for other types.
std::size_t frame_bytes_of(const std::string& dds_type) {
  for (const bus::FrameTopic& topic : bus::frame_topics())
    if (bus::dds_type_name(topic.type) == dds_type) return topic.message_bytes;
  return 0;
}

/// As recorded, but a sample of the past has not expired.
bus::RawQos qos_of(const mcap::Channel& channel) {
  const auto text = channel.metadata.find("offered_qos_profiles");
  std::vector<bus::RawQos> offered;
  if (text != channel.metadata.end()) offered = bus::parse_offered_qos(text->second);
  bus::RawQos qos = offered.empty() ? bus::RawQos{} : offered.front();
  qos.lifespan_ns = bus::kUnlimitedNs;
  if (qos.depth <= 0) qos.depth = qos.durability == bus::RawQos::Durability::kVolatile ? kUsualDepth : kLatchedDepth;
  return qos;
}

/// A sample with other fields would be dropped by every reader, and at pace lockstep the replay would wait in vain.
void check_layout(const mcap::Channel& channel, const mcap::Schema& schema, const std::string& dds_type) {
  constexpr std::string_view kOurs = "rtd_msgs::msg::dds_::";
  if (!dds_type.starts_with(kOurs) || schema.encoding != "omgidl") return;
  const std::string name = dds_type.substr(kOurs.size());
  const std::string recorded = ros2::layout_in(schema.data, name), ours = ros2::layout_in(ros2::own_idl(), name);
  if (recorded.empty() || ours.empty() || recorded == ours) return;
  throw service::ConfigError(
      fmt::format("topic {} was recorded by another version of RTD-SLAM, whose {} has other fields: replay it with "
                  "that version, or leave it out with --exclude {}",
                  channel.topic, name.substr(0, name.size() - 1), channel.topic));
}

std::string type_of(const mcap::Channel& channel, const mcap::Summary& summary) {
  const auto schema = summary.schemas.find(channel.schema_id);
  if (schema == summary.schemas.end() || schema->second.name.empty())
    throw service::ConfigError("topic " + channel.topic +
                               " has no type in the recording: leave it out with --exclude " + channel.topic);
  const std::string type = ros2::dds_type(schema->second.name);
  check_layout(channel, schema->second, type);
  return type;
}

}  // namespace

Outputs::Outputs(bus::RawBus& bus, const std::vector<const mcap::Channel*>& channels, const mcap::Summary& summary,
                 OutputOptions options)
    : bus_(bus), options_(std::move(options)) {
  for (const mcap::Channel* channel : channels) {
    Output output = make_output(*channel, summary);
    const auto [known, is_new] = outputs_.try_emplace(output.topic.name, std::move(output));
    if (!is_new && known->second.topic.type != ros2::dds_type(type_of(*channel, summary)))
      throw service::ConfigError("topic " + known->first + " has two types in the recording or by --remap: " +
                                 known->second.topic.type + " and " + type_of(*channel, summary) + "; leave one out");
    by_channel_[channel->id] = &known->second;
  }
  publish_schemas(channels, summary);  // first, so that a recorder knows of them before it sees the topics
  for (auto& [topic, output] : outputs_) output.writer = bus_.writer(output.topic, output.options);
  if (!options_.frames_apart) return;
  frame_thread_ = std::thread([this] {
    while (const std::optional<PlayedMessage> frame = frames_.pop()) write(*by_channel_.at(frame->channel), *frame);
  });
}

Outputs::~Outputs() {
  finish();
}

void Outputs::finish() {
  frames_.close();
  if (frame_thread_.joinable()) frame_thread_.join();
}

/// Of the types that a recorder does not know by itself.
void Outputs::publish_schemas(const std::vector<const mcap::Channel*>& channels, const mcap::Summary& summary) {
  std::map<std::string, ros2::SchemaText> texts;
  for (const mcap::Channel* channel : channels) {
    const mcap::Schema& schema = summary.schemas.at(channel->schema_id);
    const std::string type = ros2::dds_type(schema.name);
    if (schema.encoding.empty() || ros2::definition_of(type).known()) continue;
    texts.try_emplace(type, ros2::SchemaText{type, {schema.name, schema.encoding, schema.data}});
  }
  if (texts.empty()) return;
  std::vector<ros2::SchemaText> schemas;
  for (auto& [type, text] : texts) schemas.push_back(std::move(text));
  bus::RawWriterOptions latched;
  latched.qos.durability = bus::RawQos::Durability::kTransientLocal;
  latched.qos.depth = 1;
  schemas_ = bus_.writer({ros2::kSchemasTopic, ros2::kSchemasType}, latched);
  schemas_->write(ros2::encode_schemas(schemas));
}

Output Outputs::make_output(const mcap::Channel& channel, const mcap::Summary& summary) const {
  Output output;
  output.topic.name = ros2::dds_topic(channel.topic);
  if (!options_.robot.empty())
    output.topic.name = bus::topic_of_robot(bus::split_robot(output.topic.name).topic, options_.robot);
  if (const auto renamed = options_.remaps.find(ros2::dds_topic(channel.topic)); renamed != options_.remaps.end())
    output.topic.name = renamed->second;
  output.topic.type = type_of(channel, summary);
  output.options.qos = qos_of(channel);
  const std::size_t frame_bytes = frame_bytes_of(output.topic.type);
  const bool frames = frame_bytes > 0;
  output.carries_published = frames || output.topic.type == kFeaturesType;
  output.carries_seq = output.carries_published || output.topic.type == kTrackingType;
  if (frames) {
    output.options.qos.depth = kFrameDepth;
    output.options.fixed_bytes = static_cast<std::uint32_t>(kCdrHeaderBytes + frame_bytes);
  }
  return output;
}

void Outputs::send(const PlayedMessage& message) {
  Output& output = *by_channel_.at(message.channel);
  if (options_.frames_apart && output.options.fixed_bytes > 0) {
    frames_.push(message);
  } else {
    write(output, message);
  }
}

void Outputs::write(Output& output, const PlayedMessage& message) const {
  std::span<const std::byte> cdr = *message.cdr;
  if (options_.restamp && output.carries_published && cdr.size() >= kPublishedAt + sizeof(std::int64_t)) {
    output.restamped.assign(cdr.begin(), cdr.end());
    const std::int64_t now_ns = service::monotonic_ns();
    std::memcpy(output.restamped.data() + kPublishedAt, &now_ns, sizeof(now_ns));
    cdr = output.restamped;
  }
  // One less than the history, so that what is acknowledged is never overtaken by what is not.
  if (options_.wait_for_readers &&
      ++output.since_acknowledged + 1 >= static_cast<std::uint64_t>(output.options.qos.depth)) {
    output.writer->wait_acknowledged(kSlowReaderMs);
    output.since_acknowledged = 0;
  }
  if (output.writer->write(cdr, message.publish_ns)) {
    ++output.sent;
  } else {
    ++output.refused;
  }
}

void Outputs::send_clock(std::int64_t recorded_ns) {
  if (!clock_) clock_ = bus_.writer({"rt/clock", "rosgraph_msgs::msg::dds_::Clock_"}, {});
  const std::vector<std::uint8_t> cdr = ros::encode<ros::Wire::kCdr>(msg::to_time(recorded_ns));
  clock_->write(std::as_bytes(std::span(cdr)));
}

std::vector<std::string> Outputs::unread() const {
  std::vector<std::string> unread;
  for (const auto& [topic, output] : outputs_)
    if (output.options.qos.reliable && output.writer->matched() == 0) unread.push_back(topic);
  return unread;
}

void Outputs::wait_acknowledged(int timeout_ms) {
  for (auto& [topic, output] : outputs_)
    if (output.options.qos.reliable) output.writer->wait_acknowledged(timeout_ms);
}

}  // namespace rtd::replay
