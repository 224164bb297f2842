// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/mcap/writer.hpp"

namespace rtd::recordings {

struct SampleMessage {
  std::string topic;
  std::uint64_t time_ns = 0;
  std::string payload;
  std::uint32_t sequence = 0;
  std::uint64_t publish_ns = 0;  ///< 0: as time_ns
};

/// A file of these messages; the type of a topic is "test_msgs/msg/" and its last word unless `type` is given.
inline io::Bytes recording_of(const std::vector<SampleMessage>& messages, mcap::WriterOptions options = {},
                              const std::string& type = {}, const std::string& encoding = "cdr") {
  options.profile = "ros2";
  io::MemorySink sink;
  mcap::Writer writer(sink, options);
  std::map<std::string, mcap::ChannelId> channels;
  for (const SampleMessage& message : messages) {
    if (!channels.contains(message.topic)) {
      const std::string name =
          type.empty() ? "test_msgs/msg/" + message.topic.substr(message.topic.rfind('/') + 1) : type;
      const mcap::SchemaId schema = writer.add(mcap::Schema{0, name, "omgidl", "struct X {};"});
      channels[message.topic] = writer.add(mcap::Channel{0, schema, message.topic, encoding, {}});
    }
    writer.write(mcap::Message{channels.at(message.topic), message.sequence, message.time_ns,
                               message.publish_ns != 0 ? message.publish_ns : message.time_ns,
                               io::bytes_of(message.payload)});
  }
  writer.write(mcap::Metadata{"note", {{"made_by", "test"}}});
  writer.close();
  return sink.bytes();
}

/// `count` messages of one topic, 10 ms apart.
inline std::vector<SampleMessage> regular_messages(const std::string& topic, std::uint32_t count) {
  std::vector<SampleMessage> messages;
  for (std::uint32_t i = 0; i < count; ++i)
    messages.push_back({topic, 1'000'000'000 + i * 10'000'000ULL, topic + " payload " + std::to_string(i), i + 1});
  return messages;
}

}  // namespace rtd::recordings
