// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gmock/gmock.h>
#include <sqlite3.h>
#include <unistd.h>
#include <zstd.h>

#include <filesystem>
#include <string>
#include <vector>

#include "common/mcap/indexed_reader.hpp"
#include "common/mcap/writer.hpp"
#include "common/recordings/open.hpp"
#include "tests/support/temporary_folder.hpp"

namespace rtd::recordings::test {

namespace fs = std::filesystem;

/// A message of a test: its topic, its time and its bytes.
struct Sample {
  std::string topic;
  std::int64_t time_ns = 0;
  std::string data;
  bool operator==(const Sample&) const = default;
};

/// Messages of two topics, alternating.
inline std::vector<Sample> samples(int first, int count) {
  std::vector<Sample> all;
  for (int i = first; i < first + count; ++i) {
    all.push_back({i % 2 == 0 ? "/imu" : "/odom", 1'000'000'000LL + i * 1'000'000, "payload " + std::to_string(i)});
  }
  return all;
}

inline std::string packed(const std::string& bytes) {
  std::string out(ZSTD_compressBound(bytes.size()), '\0');
  out.resize(ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), 3));
  return out;
}

class Folder : public rtd::test::TemporaryFolder {
 public:
  std::string operator/(const std::string& name) const { return file(name); }
  /// A rosbag2 database with these messages, as versions from Iron on have it.
  std::string db3(const std::string& name, const std::vector<Sample>& messages) const {
    const std::string path = *this / name;
    fs::create_directories(fs::path(path).parent_path());
    sqlite3* database = nullptr;
    EXPECT_EQ(sqlite3_open(path.c_str(), &database), SQLITE_OK);
    sqlite3_exec(database,
                 "CREATE TABLE topics(id INTEGER PRIMARY KEY,name,type,serialization_format,offered_qos_profiles);"
                 "CREATE TABLE messages(id INTEGER PRIMARY KEY,topic_id,timestamp,data);"
                 "CREATE TABLE message_definitions(id INTEGER PRIMARY KEY,topic_type,encoding,"
                 "encoded_message_definition);"
                 "INSERT INTO topics VALUES(1,'/imu','std_msgs/msg/String','cdr','- history: 1'),"
                 "(2,'/odom','my_msgs/msg/Odd','cdr','');"
                 "INSERT INTO message_definitions VALUES(1,'my_msgs/msg/Odd','ros2msg','int8 odd');",
                 nullptr, nullptr, nullptr);
    sqlite3_stmt* insert = nullptr;
    sqlite3_prepare_v2(database, "INSERT INTO messages VALUES(NULL,?,?,?)", -1, &insert, nullptr);
    for (const Sample& message : messages) {
      sqlite3_reset(insert);
      sqlite3_bind_int(insert, 1, message.topic == "/imu" ? 1 : 2);
      sqlite3_bind_int64(insert, 2, message.time_ns);
      sqlite3_bind_blob(insert, 3, message.data.data(), static_cast<int>(message.data.size()), SQLITE_TRANSIENT);
      EXPECT_EQ(sqlite3_step(insert), SQLITE_DONE);
    }
    sqlite3_finalize(insert);
    sqlite3_close(database);
    return path;
  }
  std::string mcap(const std::string& name, const std::vector<Sample>& messages) const {
    io::MemorySink sink;
    mcap::Writer writer(sink);
    std::map<std::string, mcap::ChannelId> ids;
    for (const Sample& message : messages) {
      const auto [id, first] = ids.try_emplace(message.topic);
      if (first) {
        const mcap::SchemaId schema = writer.add(mcap::Schema{0, "std_msgs/msg/String", "ros2msg", "string data"});
        id->second = writer.add(mcap::Channel{0, schema, message.topic, "cdr", {}});
      }
      const auto time = static_cast<mcap::Timestamp>(message.time_ns);
      writer.write(mcap::Message{id->second, 0, time, time, io::bytes_of(message.data)});
    }
    writer.close();
    return write(name, {reinterpret_cast<const char*>(sink.bytes().data()), sink.bytes().size()});
  }
  /// As rosbag2 writes it.
  void metadata(const std::vector<std::string>& files, const std::string& format = "",
                const std::string& mode = "") const {
    std::string text = "rosbag2_bagfile_information:\n  version: 5\n  compression_format: \"" + format +
                       "\"\n  compression_mode: \"" + mode + "\"\n  relative_file_paths:\n";
    for (const std::string& name : files) text += "    - " + name + '\n';
    write("metadata.yaml", text);
  }
};

/// The messages of a recording, by time.
inline std::vector<Sample> messages_of(const io::ByteSource& source) {
  mcap::IndexedReader reader(source);
  std::vector<Sample> all;
  mcap::MessageCursor cursor = reader.messages();
  while (const mcap::Message* const message = cursor.next()) {
    all.push_back({cursor.channel().topic,
                   static_cast<std::int64_t>(message->log_time),
                   {reinterpret_cast<const char*>(message->data.data()), message->data.size()}});
  }
  return all;
}

}  // namespace rtd::recordings::test
