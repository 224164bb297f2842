// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// What our reader finds in a recording, as JSON, for other readers to compare with: mcap_digest FILE
#include <cstdio>
#include <exception>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "common/io/byte_source.hpp"
#include "common/io/bytes.hpp"
#include "common/mcap/indexed_reader.hpp"

namespace {

using rtd::mcap::Message;

/// The messages of one topic, in order of log time.
struct TopicDigest {
  std::string type;
  std::uint64_t count = 0;
  std::uint32_t crc = 0;  ///< of all payloads in a row
};

int print_digest(const char* path) {
  const rtd::io::FileSource source(path);
  rtd::mcap::IndexedReader reader(source);
  std::map<std::string, TopicDigest> topics;
  std::uint64_t first = 0, last = 0, count = 0;
  rtd::mcap::MessageCursor cursor = reader.messages();
  while (const Message* message = cursor.next()) {
    TopicDigest& topic = topics[cursor.channel().topic];
    const auto schema = reader.summary().schemas.find(cursor.channel().schema_id);
    if (schema != reader.summary().schemas.end()) topic.type = schema->second.name;
    topic.crc = rtd::io::crc32(message->data, topic.crc);
    ++topic.count;
    if (count++ == 0) first = message->log_time;
    last = message->log_time;
  }
  nlohmann::json digest{{"first_log_time", std::to_string(first)}, {"last_log_time", std::to_string(last)}};
  for (const auto& [name, topic] : topics)
    digest["topics"][name] = {{"type", topic.type}, {"count", topic.count}, {"crc", topic.crc}};
  std::cout << digest.dump(1) << '\n';
  return reader.problems().listed().empty() ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: mcap_digest FILE\n", stderr);
    return 2;
  }
  try {
    return print_digest(argv[1]);
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 1;
  }
}
