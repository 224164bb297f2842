// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/recordings/reader.hpp"

#include <zstd.h>

#include <algorithm>
#include <array>
#include <set>
#include <string_view>

#include "common/io/byte_sink.hpp"
#include "common/io/recording_forms.hpp"
#include "common/mcap/compression.hpp"
#include "common/mcap/indexed_reader.hpp"
#include "common/mcap/recording_file.hpp"
#include "common/recordings/indexed_reader.hpp"
#include "common/recordings/open.hpp"

namespace rtd::recordings {
namespace {

/// Empty for a channel that is not read.
std::optional<ros::Wire> wire_of(const mcap::Channel& channel) {
  if (!is_name(channel.topic)) return std::nullopt;
  if (channel.message_encoding == "cdr") return ros::Wire::kCdr;
  if (channel.message_encoding == "ros1") return ros::Wire::kRos1;
  return std::nullopt;
}

class McapReader final : public Reader {
 public:
  explicit McapReader(const std::filesystem::path& path)
      : Reader(path.string()), opened_(open(path.string())), reader_(*opened_.source) {
    const mcap::Summary& summary = reader_.summary();
    if (summary.channels.empty()) throw mcap::RecordingFileError(name_ + " has no messages" + first_problem());
    const auto counts = message_counts();
    for (const auto& [id, channel] : summary.channels) {
      const auto schema = summary.schemas.find(channel.schema_id);
      if (!wire_of(channel) || schema == summary.schemas.end() || !is_name(schema->second.name)) continue;
      add_topic({channel.topic, plain_type(schema->second.name), counts.count(id) != 0 ? counts.at(id) : 0,
                 channel.metadata, schema->second.encoding, schema->second.data});
    }
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
    const mcap::Channel& channel = playing_->channel();
    RecordedMessage recorded{channel.topic, static_cast<std::int64_t>(message->log_time), *wire_of(channel), {}};
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(message->data.data());
    const ros::Bytes stored(bytes, message->data.size());
    auto unpacked = recorded.wire == ros::Wire::kCdr ? unpacked_message(stored) : std::nullopt;
    recorded.bytes = unpacked ? std::move(*unpacked) : std::vector<std::uint8_t>(stored.begin(), stored.end());
    const auto place = place_of_topic_.find(recorded.topic);
    if (place != place_of_topic_.end()) recorded.type = topics_[place->second].type;
    return recorded;
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
  mcap::MessageCursor messages(const std::vector<std::string>& topics) {
    mcap::MessageQuery query;
    query.wanted = [wanted = std::set(topics.begin(), topics.end())](const mcap::Channel& channel) {
      return wire_of(channel) && wanted.contains(channel.topic);
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
    const auto [same, first] = place_of_topic_.try_emplace(topic.name, topics_.size());
    if (first) {
      topics_.push_back(std::move(topic));
    } else {
      topics_[same->second].messages += topic.messages;  // several publishers
    }
  }

  std::string first_problem() const {
    const auto& problems = reader_.problems().listed();
    return problems.empty() ? std::string() : ": " + mcap::to_string(problems.front());
  }

  Opened opened_;
  mcap::IndexedReader reader_;
  std::map<std::string, std::size_t> place_of_topic_;  ///< in topics_
  std::optional<mcap::MessageCursor> playing_;
  std::size_t reported_ = 0;
};

void replace(std::string& text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from))
    text.replace(at, from.size(), to);
}

}  // namespace

Form form_of(const io::ByteSource& source) {
  std::array<std::byte, io::kMagicBytes> bytes{};
  const std::size_t count = source.read(0, bytes);
  const std::string_view begin(reinterpret_cast<const char*>(bytes.data()), count);
  if (begin.starts_with(io::kBagMagic)) return Form::kBag;
  if (begin.starts_with(io::kDb3Magic)) return Form::kDb3;
  if (begin.starts_with(io::kZstdMagic)) return Form::kPacked;
  return mcap::looks_like_recording(source) ? Form::kMcap : Form::kOther;
}

Form form_of(const std::filesystem::path& path) {
  try {
    return form_of(io::FileSource(path));
  } catch (const io::IoError&) {
    return Form::kOther;
  }
}

std::unique_ptr<Reader> open_reader(const std::filesystem::path& path, Form form) {
  if (form == Form::kBag || form == Form::kDb3) return open_indexed(path, form);
  return std::make_unique<McapReader>(path);
}

std::unique_ptr<Reader> open_reader(const std::filesystem::path& path) {
  return open_reader(path, form_of(path));
}

std::optional<RecordedMessage> Reader::first(const std::string& topic) {
  play({topic});
  return next();
}

std::optional<std::vector<std::uint8_t>> unpacked_message(ros::Bytes bytes) {
  constexpr std::uint64_t kMost = 256ULL << 20;
  const std::string_view packed(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (!packed.starts_with(io::kZstdMagic)) return std::nullopt;
  const unsigned long long size = ZSTD_getFrameContentSize(bytes.data(), bytes.size());  // errors are the largest
  if (size > std::min(kMost, mcap::largest_uncompressed_size(mcap::Compression::kZstd, bytes.size())))
    return std::nullopt;
  std::vector<std::uint8_t> unpacked(size);
  if (ZSTD_decompress(unpacked.data(), size, bytes.data(), bytes.size()) != size) return std::nullopt;
  return unpacked;
}

bool is_name(const std::string& text) {
  constexpr std::size_t kLongest = 255;  // of a topic in ROS 2
  return text.size() <= kLongest;
}

std::string plain_type(std::string type) {
  if (type.find("::dds_::") != std::string::npos && type.back() == '_') type.pop_back();
  replace(type, "::dds_::", "::");
  replace(type, "::", "/");
  replace(type, "/msg/", "/");
  return type;
}

const RecordedTopic* topic_named(const Reader& recording, const std::string& name) {
  const auto& all = recording.topics();
  const auto found = std::ranges::find_if(all, [&](const RecordedTopic& topic) { return topic.name == name; });
  return found == all.end() ? nullptr : &*found;
}

bool is_tf(const RecordedTopic& topic) {
  return topic.type == "tf2_msgs/TFMessage" || topic.type == "tf/tfMessage";
}

std::string list_topics(const Reader& recording) {
  std::string text;
  for (const RecordedTopic& topic : recording.topics()) {
    text += "  " + topic.name + " (" + topic.type + ", " + std::to_string(topic.messages) + " messages)\n";
  }
  if (text.empty()) return "  none";
  text.pop_back();
  return text;
}

}  // namespace rtd::recordings
