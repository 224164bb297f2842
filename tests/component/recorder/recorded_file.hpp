// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "common/io/byte_source.hpp"
#include "common/mcap/indexed_reader.hpp"

namespace rtd::recorder {

/// A recorded message with its bytes.
struct ReadMessage {
  std::uint32_t sequence = 0;
  std::uint64_t log_time = 0, publish_time = 0;
  std::vector<std::byte> cdr;
};

struct RecordedFile {
  std::map<std::string, std::vector<ReadMessage>> topics;  ///< by name, also those without a message
  std::map<std::string, std::string> type_of;
  std::uint64_t problems = 0;
  bool has_summary = false;
};

inline RecordedFile read_recording(const std::filesystem::path& path) {
  const io::FileSource source(path);
  mcap::IndexedReader reader(source);
  RecordedFile file;
  for (const auto& [id, channel] : reader.summary().channels) {
    file.topics[channel.topic];
    file.type_of[channel.topic] = reader.summary().schemas.at(channel.schema_id).name;
  }
  mcap::MessageCursor cursor = reader.messages();
  while (const mcap::Message* message = cursor.next()) {
    file.topics[cursor.channel().topic].push_back(
        {message->sequence, message->log_time, message->publish_time, {message->data.begin(), message->data.end()}});
  }
  file.problems = reader.problems().total();
  file.has_summary = !reader.summary().scanned;
  return file;
}

}  // namespace rtd::recorder
