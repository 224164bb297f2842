// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/mcap/indexed_reader.hpp"
#include "common/mcap/stream_reader.hpp"
#include "common/mcap/writer.hpp"

namespace rtd::mcap {

/// A message that owns its data.
struct StoredMessage {
  std::string topic;
  std::uint32_t sequence = 0;
  Timestamp log_time = 0, publish_time = 0;
  std::string data;
  bool operator==(const StoredMessage&) const = default;
};

inline StoredMessage stored(const Message& message, const Channel& channel) {
  return {channel.topic, message.sequence, message.log_time, message.publish_time,
          std::string(reinterpret_cast<const char*>(message.data.data()), message.data.size())};
}

struct ReadBack {
  std::vector<StoredMessage> messages;
  std::vector<Problem> problems;
};

/// All messages in file order, and what the reader found wrong.
inline ReadBack stream(ByteView file, const ReaderOptions& options = {}) {
  const io::MemorySource source(file);
  StreamReader reader(source, options);
  ReadBack result;
  while (const Record* record = reader.next())
    if (const auto* message = std::get_if<Message>(record))
      result.messages.push_back(stored(*message, reader.channels().at(message->channel_id)));
  result.problems = reader.problems().listed();
  return result;
}

/// The messages of the query by time.
inline ReadBack by_index(ByteView file, const MessageQuery& query = {}, const ReaderOptions& options = {}) {
  const io::MemorySource source(file);
  IndexedReader reader(source, options);
  MessageCursor cursor = reader.messages(query);
  ReadBack result;
  while (const Message* message = cursor.next()) result.messages.push_back(stored(*message, cursor.channel()));
  result.problems = reader.problems().listed();
  return result;
}

/// Two topics, log_time 0, 10, 20, ... ns, `size` bytes each, no two alike.
inline std::vector<StoredMessage> sample_messages(std::size_t count, std::size_t size) {
  std::vector<StoredMessage> messages;
  for (std::size_t i = 0; i < count; ++i) {
    std::string data(size, '\0');
    for (std::size_t k = 0; k < size; ++k) data[k] = static_cast<char>(i * 131 + k * 7 + (k >> 3) * i);
    messages.push_back({i % 3 == 0 ? "/pose" : "/frame", static_cast<std::uint32_t>(i), i * 10, i * 10 + 1, data});
  }
  return messages;
}

inline void write_all(Writer& writer, const std::vector<StoredMessage>& messages) {
  const SchemaId schema = writer.add(Schema{0, "geometry_msgs/msg/PoseStamped", "ros2msg", "std_msgs/Header header"});
  std::map<std::string, ChannelId> channels;
  for (const char* const topic : {"/pose", "/frame"})
    channels[topic] = writer.add(Channel{0, schema, topic, "cdr", {{"offered_qos_profiles", "- history: 1"}}});
  for (const StoredMessage& message : messages)
    writer.write(Message{channels.at(message.topic), message.sequence, message.log_time, message.publish_time,
                         io::bytes_of(message.data)});
}

/// A closed file of these messages.
inline Bytes file_of(const std::vector<StoredMessage>& messages, const WriterOptions& options = {}) {
  io::MemorySink sink;
  Writer writer(sink, options);
  write_all(writer, messages);
  writer.close();
  return sink.bytes();
}

inline std::string texts(const std::vector<Problem>& problems) {
  std::string all;
  for (const Problem& problem : problems) all += to_string(problem) + '\n';
  return all;
}

}  // namespace rtd::mcap
