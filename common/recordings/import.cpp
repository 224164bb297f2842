// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/recordings/import.hpp"

#include <zstd.h>

#include <algorithm>
#include <array>

#include "common/io/recording_forms.hpp"
#include "common/mcap/indexed_reader.hpp"
#include "common/mcap/recording_file.hpp"
#include "common/rosbag1/bag_reader.hpp"
#include "common/rosbag2/db3_reader.hpp"

namespace rtd::recordings {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kMaxDamages = 100;
constexpr std::uint64_t kMaxMessageBytes = 256ULL << 20;

std::string first_bytes(const fs::path& file) {
  std::array<std::byte, 16> begin{};
  const std::size_t count = io::FileSource(file).read(0, begin);
  return {reinterpret_cast<const char*>(begin.data()), count};
}

mcap::Timestamp time_of(std::int64_t time_ns) {
  return static_cast<mcap::Timestamp>(std::max<std::int64_t>(0, time_ns));
}

io::ByteView view_of(const auto& bytes) {
  return std::as_bytes(std::span(bytes.data(), bytes.size()));
}

/// Reports every thousandth message, and the end.
class Steps {
 public:
  Steps(const Share& progress, std::uint64_t messages) : progress_(progress), messages_(messages) {}
  ~Steps() { progress_(1); }
  void step() {
    constexpr std::uint64_t kStep = 1000;
    if (++done_ % kStep != 0 || messages_ == 0) return;
    progress_(std::min(1.0, static_cast<double>(done_) / static_cast<double>(messages_)));
  }

 private:
  const Share& progress_;
  const std::uint64_t messages_;
  std::uint64_t done_ = 0;
};

}  // namespace

Import::Import(io::ByteSink& sink, bool packed_messages)
    : writer_(sink, {.profile = "ros2"}), packed_messages_(packed_messages) {}

void Import::add(const fs::path& file, const std::string& name, const Share& progress) {
  const std::string begin = first_bytes(file);
  if (begin.starts_with(io::kDb3Magic)) return add_db3(file, name, progress);
  if (begin.starts_with(io::kBagMagic)) return add_bag(file, name, progress);
  mcap::require_recording(io::FileSource(file), name);
  add_mcap(file, name, progress);
}

mcap::ChannelId Import::channel(const mcap::Schema& schema, mcap::Channel channel) {
  channel.schema_id = 0;
  if (!schema.name.empty()) {
    const Definition definition{schema.name, schema.encoding, schema.data};
    const auto [known, first] = schemas_.try_emplace(definition, 0);
    if (first) known->second = writer_.add(schema);
    channel.schema_id = known->second;
  }
  const auto [known, first] =
      channels_.try_emplace({channel.topic, channel.schema_id, channel.message_encoding, channel.metadata}, 0);
  if (first) known->second = writer_.add(std::move(channel));
  return known->second;
}

void Import::write(mcap::Message message, const std::string& topic) {
  if (packed_messages_) {
    const unsigned long long size = ZSTD_getFrameContentSize(message.data.data(), message.data.size());
    const bool sensible =
        size != ZSTD_CONTENTSIZE_UNKNOWN && size != ZSTD_CONTENTSIZE_ERROR && size <= kMaxMessageBytes;
    unpacked_.resize(sensible ? size : 0);
    const std::size_t result =
        ZSTD_decompress(unpacked_.data(), unpacked_.size(), message.data.data(), message.data.size());
    if (!sensible || ZSTD_isError(result) != 0 || result != size) {
      if (damages_.size() < kMaxDamages) note("a message of " + topic + " cannot be unpacked (zstd); it is left out");
      return;
    }
    message.data = unpacked_;
  }
  writer_.write(message);
}

void Import::add_mcap(const fs::path& file, const std::string& name, const Share& progress) {
  const io::FileSource source(file);
  mcap::IndexedReader reader(source);
  const auto& statistics = reader.summary().statistics;
  Steps steps(progress, statistics ? statistics->message_count : 0);
  std::map<mcap::ChannelId, mcap::ChannelId> ids;
  mcap::MessageCursor cursor = reader.messages();
  while (const mcap::Message* const message = cursor.next()) {
    const auto [id, first] = ids.try_emplace(message->channel_id, 0);
    if (first) {
      const auto schema = reader.summary().schemas.find(cursor.channel().schema_id);
      id->second =
          channel(schema == reader.summary().schemas.end() ? mcap::Schema{} : schema->second, cursor.channel());
    }
    mcap::Message copy = *message;
    copy.channel_id = id->second;
    write(copy, cursor.channel().topic);
    steps.step();
  }
  for (const mcap::Problem& problem : reader.problems().listed()) {
    if (mcap::is_damage(problem)) note(name + ", " + mcap::to_string(problem));
  }
}

void Import::add_db3(const fs::path& file, const std::string& name, const Share& progress) {
  try {
    rosbag2::Db3Reader reader(file);
    std::map<std::int64_t, mcap::ChannelId> ids;
    std::vector<std::string> topics;
    for (const auto& [id, topic] : reader.topics()) {
      mcap::Channel entry{0, 0, topic.name, topic.serialization_format, {}};
      if (!topic.offered_qos.empty()) entry.metadata["offered_qos_profiles"] = topic.offered_qos;
      ids[id] = channel({0, topic.type, topic.definition_encoding, topic.definition}, std::move(entry));
      topics.push_back(topic.name);
    }
    const std::vector<rosbag2::Db3Place> places = reader.messages(topics);
    Steps steps(progress, places.size());
    std::uint32_t sequence = 0;
    for (const rosbag2::Db3Place& place : places) {
      try {
        const std::vector<std::uint8_t> bytes = reader.read(place);
        const mcap::Timestamp time = time_of(place.time_ns);
        write({ids.at(place.topic), ++sequence, time, time, view_of(bytes)}, reader.topics().at(place.topic).name);
      } catch (const rosbag2::Db3Error& error) {
        if (damages_.size() < kMaxDamages) note(name + ": " + error.what());
      }
      steps.step();
    }
    for (const std::string& damage : reader.damages()) note(damage);
  } catch (const rosbag2::Db3Error& error) {
    throw mcap::RecordingFileError(error.what());
  }
}

void Import::add_bag(const fs::path& file, const std::string& name, const Share& progress) {
  try {
    rosbag1::BagReader reader(file);
    std::map<std::uint32_t, mcap::ChannelId> ids;
    std::vector<std::string> topics;
    for (const auto& [id, connection] : reader.connections()) {
      ids[id] = channel({0, connection.type, "ros1msg", connection.definition},
                        {0, 0, connection.topic, "ros1", {{"md5sum", connection.md5sum}}});
    }
    for (const rosbag1::Topic& topic : reader.topics()) topics.push_back(topic.name);
    const std::vector<rosbag1::MessagePlace> places = reader.messages(topics);
    Steps steps(progress, places.size());
    std::uint32_t sequence = 0;
    for (const rosbag1::MessagePlace& place : places) {
      try {
        const mcap::Timestamp time = time_of(place.time_ns);
        write({ids.at(place.connection), ++sequence, time, time, view_of(reader.read(place))},
              reader.connections().at(place.connection).topic);
      } catch (const rosbag1::BagError& error) {
        if (damages_.size() < kMaxDamages) note(name + ": " + error.what());
      }
      steps.step();
    }
    for (const std::string& damage : reader.damages()) note(damage);
  } catch (const rosbag1::BagError& error) {
    throw mcap::RecordingFileError(error.what());
  }
}

}  // namespace rtd::recordings
