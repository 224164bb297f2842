// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/recorder/inspect/recording_contents.hpp"

#include "common/mcap/codec.hpp"
#include "common/mcap/stream_reader.hpp"
#include "services/recorder/inspect/payload_diff.hpp"

namespace rtd::recording {
namespace {

std::uint64_t hash_of(io::ByteView bytes) {
  return std::hash<std::string_view>{}({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

std::uint64_t stable_hash_of(io::ByteView payload, const std::vector<ByteRange>& left_out) {
  std::uint64_t hash = 0;
  std::size_t from = 0;
  const auto add = [&](std::size_t to) { hash = hash * 31 + hash_of(payload.subspan(from, to - from)); };
  for (const ByteRange& range : left_out) {
    if (range.end > payload.size()) break;
    add(range.begin);
    from = range.end;
  }
  add(payload.size());
  return hash;
}

Fingerprint fingerprint(const mcap::Message& message, const std::vector<ByteRange>& of_the_run) {
  Fingerprint print{message.log_time, message.publish_time, message.sequence, message.data.size()};
  print.hash = hash_of(message.data);
  print.stable_hash = of_the_run.empty() ? print.hash : stable_hash_of(message.data, of_the_run);
  constexpr std::size_t kHeaderBytes = 4;
  if (message.data.size() >= kHeaderBytes + sizeof(print.key))
    print.key = io::load<std::uint64_t>(message.data.data() + kHeaderBytes);
  return print;
}

}  // namespace

Contents contents_of(const io::ByteSource& source, const std::function<void(std::uint64_t bytes)>& on_progress) {
  Contents contents;
  struct Target {
    TopicContents* topic = nullptr;
    std::vector<ByteRange> of_the_run;
  };
  std::map<mcap::ChannelId, Target> targets;
  mcap::StreamReader reader(source);
  while (const mcap::Record* record = reader.next()) {
    if (on_progress) on_progress(reader.bytes_read());
    const auto* message = std::get_if<mcap::Message>(record);
    if (message == nullptr) continue;
    Target& target = targets[message->channel_id];
    if (target.topic == nullptr) {
      const mcap::Channel& channel = reader.channels().at(message->channel_id);
      target.topic = &contents.topics[channel.topic];
      const auto schema = reader.schemas().find(channel.schema_id);
      if (schema != reader.schemas().end()) target.topic->type = schema->second.name;
      target.of_the_run = run_ranges(target.topic->type);
    }
    target.topic->messages.push_back(fingerprint(*message, target.of_the_run));
  }
  contents.problems = reader.problems().listed();
  contents.data_lost = reader.problems().data_lost();
  return contents;
}

}  // namespace rtd::recording
