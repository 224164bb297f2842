// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/recording/recording.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "common/camera/frame_source.hpp"
#include "common/mcap/indexed_reader.hpp"
#include "common/mcap/recording_file.hpp"
#include "common/recordings/open.hpp"

namespace rtd::camera {
namespace {

namespace fs = std::filesystem;

std::optional<ros::Wire> wire_of(const mcap::Channel& channel) {
  if (channel.message_encoding == "cdr") return ros::Wire::kCdr;
  if (channel.message_encoding == "ros1") return ros::Wire::kRos1;
  return std::nullopt;
}

class McapRecording final : public Recording {
 public:
  McapRecording(const fs::path& file, recordings::Opened opened)
      : Recording(file.string()), opened_(std::move(opened)), reader_(*opened_.source) {
    const mcap::Summary& summary = reader_.summary();
    if (summary.channels.empty()) throw SourceError(name_ + " has no messages" + first_problem());
    const auto counts = message_counts();
    for (const auto& [id, channel] : summary.channels) {
      const auto schema = summary.schemas.find(channel.schema_id);
      if (!wire_of(channel) || schema == summary.schemas.end()) continue;
      add_topic({channel.topic, plain_type(schema->second.name), counts.count(id) != 0 ? counts.at(id) : 0,
                 channel.metadata, schema->second.encoding, schema->second.data});
    }
  }

  std::optional<RecordedMessage> first(const std::string& topic) override {
    mcap::MessageCursor cursor = messages({topic});
    const mcap::Message* message = cursor.next();
    if (message == nullptr) return std::nullopt;
    return to_message(cursor, *message);
  }

  std::vector<std::int64_t> first_times_ns(const std::string& topic, std::size_t most) override {
    std::vector<std::int64_t> times_ns;
    mcap::MessageCursor cursor = messages({topic});
    while (times_ns.size() < most) {
      const mcap::Message* message = cursor.next();
      if (message == nullptr) break;
      times_ns.push_back(static_cast<std::int64_t>(message->log_time));
    }
    return times_ns;
  }

  void play(const std::vector<std::string>& topics) override { playing_.emplace(messages(topics)); }

  std::optional<RecordedMessage> next() override {
    const mcap::Message* message = playing_ ? playing_->next() : nullptr;
    if (message == nullptr) return std::nullopt;
    return to_message(*playing_, *message);
  }

  std::vector<std::string> take_damages() override {
    std::vector<std::string> damages = std::exchange(opened_.damages, {});
    const auto& problems = reader_.problems().listed();
    for (; reported_ < problems.size(); ++reported_) {
      const mcap::Problem& problem = problems[reported_];
      if (mcap::is_damage(problem)) damages.push_back(name_ + ", " + mcap::to_string(problem));
    }
    return damages;
  }

 private:
  RecordedMessage to_message(const mcap::MessageCursor& cursor, const mcap::Message& message) const {
    RecordedMessage recorded{
        cursor.channel().topic, static_cast<std::int64_t>(message.log_time), *wire_of(cursor.channel()), {}};
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(message.data.data());
    recorded.bytes.assign(bytes, bytes + message.data.size());
    if (const RecordedTopic* topic = topic_named(*this, recorded.topic)) recorded.type = topic->type;
    return recorded;
  }

  mcap::MessageCursor messages(const std::vector<std::string>& topics) {
    mcap::MessageQuery query;
    query.wanted = [topics](const mcap::Channel& channel) {
      return wire_of(channel) && std::ranges::find(topics, channel.topic) != topics.end();
    };
    return reader_.messages(std::move(query));
  }

  std::map<mcap::ChannelId, std::uint64_t> message_counts() {
    if (const auto& statistics = reader_.summary().statistics) return statistics->channel_message_counts;
    std::map<mcap::ChannelId, std::uint64_t> counts;  // statistics may be left out
    mcap::MessageCursor cursor = reader_.messages();
    while (const mcap::Message* message = cursor.next()) ++counts[message->channel_id];
    return counts;
  }

  void add_topic(RecordedTopic topic) {
    const auto same =
        std::ranges::find_if(topics_, [&](const RecordedTopic& other) { return other.name == topic.name; });
    if (same == topics_.end()) {
      topics_.push_back(std::move(topic));
    } else {
      same->messages += topic.messages;  // several publishers
    }
  }

  std::string first_problem() const {
    const auto& problems = reader_.problems().listed();
    return problems.empty() ? std::string() : ": " + mcap::to_string(problems.front());
  }

  recordings::Opened opened_;
  mcap::IndexedReader reader_;
  std::optional<mcap::MessageCursor> playing_;
  std::size_t reported_ = 0;
};

}  // namespace

std::unique_ptr<Recording> open_mcap(const fs::path& file) {
  try {
    return std::make_unique<McapRecording>(file, recordings::open(file.string()));
  } catch (const mcap::RecordingFileError& error) {
    throw SourceError(error.what());
  }
}

}  // namespace rtd::camera
