// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <sqlite3.h>
#include <zstd.h>

#include <fstream>
#include <memory>

#include "common/mcap/codec.hpp"
#include "common/mcap/stream_reader.hpp"
#include "common/mcap/writer.hpp"
#include "common/recordings/open.hpp"
#include "common/recordings/reader.hpp"
#include "tests/fuzz/worst/worst_case.hpp"
#include "tests/support/rosbag1/bag_writer.hpp"

namespace rtd::worst {
namespace {

namespace fs = std::filesystem;

/// What a camera does with a recording.
void play(const fs::path& file) {
  const auto reader = recordings::open_reader(file);
  std::vector<std::string> topics;
  for (const recordings::RecordedTopic& topic : reader->topics()) topics.push_back(topic.name);
  reader->play(topics);
  while (reader->next()) {
  }
  reader->take_damages();
}

/// What `rtd info` does with MCAP.
void check_mcap(const fs::path& file) {
  const io::FileSource source(file);
  mcap::StreamReader reader(source);
  while (reader.next() != nullptr) {
  }
}

struct Mcap {
  std::size_t bytes;        ///< of the file, about
  std::size_t chunk_bytes;  ///< unpacked
  std::size_t message_bytes;
  bool one_time;  ///< of all messages: chunks overlap
  mcap::Compression compression = mcap::Compression::kZstd;
};

std::string text_of(const mcap::Bytes& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::string mcap_file(const Mcap& of) {
  io::MemorySink sink;
  mcap::WriterOptions options;
  options.compression = of.compression;
  options.chunk_size = of.chunk_bytes;
  options.use_message_index = false;
  mcap::Writer writer(sink, options);
  const mcap::SchemaId schema = writer.add(mcap::Schema{0, "a/msg/A", "ros2msg", "uint8 a"});
  const mcap::ChannelId channel = writer.add(mcap::Channel{0, schema, "/a", "cdr", {}});
  const mcap::Bytes data(of.message_bytes);
  const std::uint64_t most = 80 * of.bytes + (40 << 20);  // readers stop before
  for (std::uint64_t time = 1, bytes = 0; sink.bytes().size() < of.bytes && bytes < most; ++time) {
    writer.write(mcap::Message{channel, 0, of.one_time ? 1 : time, 1, data});
    bytes += 31 + data.size();
  }
  writer.close();
  return text_of(sink.bytes());
}

/// A type with a long text, and as many topics of it as there is room for.
std::string mcap_of_topics(std::size_t bytes, std::size_t schema_bytes, std::size_t topic_bytes) {
  io::MemorySink sink;
  mcap::Writer writer(sink);
  const mcap::SchemaId schema = writer.add(mcap::Schema{0, "a/msg/A", "ros2msg", repeated("uint8 a\n", schema_bytes)});
  for (std::size_t i = 0; sink.bytes().size() + schema_bytes < bytes && i < 60'000; ++i) {
    const mcap::ChannelId channel =
        writer.add(mcap::Channel{0, schema, std::string(topic_bytes, 't') + std::to_string(i), "cdr", {}});
    for (int k = 0; k < 4; ++k) writer.write(mcap::Message{channel, 0, i, i, {}});
  }
  writer.close();
  return text_of(sink.bytes());
}

/// Each record says that it holds all that follows, a little further than the one before.
std::string mcap_of_nested_records(std::size_t bytes) {
  io::MemorySink sink;
  mcap::Writer writer(sink);
  std::string file = text_of(sink.bytes());
  const std::size_t records = bytes / 2 / 17;
  for (std::size_t i = 0; i < records; ++i) {
    file += static_cast<char>(mcap::Opcode::kMetadata);
    file += test::little_endian(bytes / 2 - 16 * i, 8) + std::string(8, '\0');
  }
  return file + std::string(bytes / 2 + 64, '\0');
}

std::string mcap_of_strangers(std::size_t bytes) {
  io::MemorySink sink;
  mcap::Writer writer(sink);
  std::string file = text_of(sink.bytes());
  for (std::size_t i = 0; file.size() < bytes; ++i)
    file += static_cast<char>(mcap::Opcode::kMessage) + test::little_endian(22, 8) + test::little_endian(i, 2) +
            std::string(20, '\0');
  return file;
}

std::string bag_of_chunks(std::size_t unpacked_bytes, const std::string& compression, bool one_time) {
  constexpr std::size_t kMessages = 10'000, kMessageBytes = 100;  // of a chunk, of one of them
  test::BagWriter writer(compression);
  const std::uint32_t connection = writer.connection("/a", "a/A", "uint8 a");
  const std::vector<std::uint8_t> data(kMessageBytes - 60);
  for (std::size_t i = 0; i * kMessageBytes < unpacked_bytes; ++i) {
    writer.message(connection, static_cast<std::int64_t>(one_time ? i % kMessages : i), data);
    if (i % kMessages == kMessages - 1) writer.end_chunk();
  }
  return writer.closed();
}

/// The index names one message again and again.
std::string bag_of_one_message(std::size_t bytes) {
  const auto number = [](std::uint64_t value) { return test::little_endian(value, 4); };
  const auto op = [](int value) { return test::little_endian(static_cast<std::uint64_t>(value), 1); };
  const std::string message = test::bag_record({{"op", op(2)}, {"conn", number(0)}, {"time", number(1) + number(0)}},
                                               std::string(bytes / 2, 'm'));
  const std::string entry = number(1) + number(0) + number(0), index = repeated(entry, bytes / 2 / 12 * 12);
  const std::string connection =
      test::bag_record({{"op", op(7)}, {"conn", number(0)}, {"topic", "/a"}}, test::bag_record({}, "").substr(8));
  return test::BagWriter::kVersion + test::BagWriter::bag_header(4117) +
         test::bag_record({{"op", op(5)}, {"compression", "none"}, {"size", number(message.size())}}, message) +
         test::bag_record(
             {{"op", op(4)}, {"ver", number(1)}, {"conn", number(0)}, {"count", number(index.size() / 12)}}, index) +
         connection;
}

/// Topics with long names that begin alike.
std::string bag_of_long_topics(std::size_t bytes) {
  test::BagWriter writer;
  const std::string name(bytes / 10, 't');
  const std::uint32_t a = writer.connection(name + "a", "a/A"), b = writer.connection(name + "b", "a/A");
  for (std::size_t size = 0; size < bytes / 2; size += 70)
    writer.message(size % 140 == 0 ? a : b, static_cast<std::int64_t>(size), {});
  return writer.closed();
}

std::string packed(const std::string& content) {
  std::string text(ZSTD_compressBound(content.size()), '\0');
  text.resize(ZSTD_compress(text.data(), text.size(), content.data(), content.size(), 3));
  return text;
}

fs::path database(const fs::path& folder, const std::string& statements) {
  const fs::path file = file_of(folder, "a.db3", "");
  sqlite3* made = nullptr;
  sqlite3_open(file.c_str(), &made);
  sqlite3_exec(made, statements.c_str(), nullptr, nullptr, nullptr);
  sqlite3_close(made);
  return file;
}

void put_number(std::string& page, std::size_t at, std::size_t value, std::size_t bytes) {
  for (std::size_t i = 0; i < bytes; ++i) page[at + i] = static_cast<char>(value >> 8 * (bytes - 1 - i));
}

/// A page of SQLite's tree: as many cells as it has room for, all the same.
std::string tree_page(char type, const std::string& cell, std::size_t last_child) {
  constexpr std::size_t kPage = 512;
  const std::size_t head = type == 5 ? 12 : 8, count = (kPage - head) / (cell.size() + 2);
  std::string page(kPage, '\0');
  page[0] = type;
  put_number(page, 3, count, 2);
  put_number(page, 5, kPage - count * cell.size(), 2);
  if (type == 5) put_number(page, 8, last_child, 4);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t at = kPage - (i + 1) * cell.size();
    put_number(page, head + 2 * i, at, 2);
    page.replace(at, cell.size(), cell);
  }
  return page;
}

/// Millions of rows that are one row of half the file, whose time comes last.
fs::path database_of_one_row(const fs::path& folder, std::size_t bytes, const std::string& topics) {
  constexpr std::size_t kPage = 512, kRoot = 2;  // of the first table
  const fs::path file = database(folder,
                                 "PRAGMA page_size=512;CREATE TABLE messages(data BLOB,timestamp INTEGER,topic_id "
                                 "INTEGER);INSERT INTO messages VALUES(zeroblob(" +
                                     std::to_string(bytes / 2) + "),1000,1);" + topics);
  std::ifstream in(file, std::ios::binary);
  std::string content{std::istreambuf_iterator<char>(in), {}};
  const std::size_t pages = content.size() / kPage, root = (kRoot - 1) * kPage;
  const auto cell_at = static_cast<std::size_t>(static_cast<unsigned char>(content[root + 8]) << 8 |
                                                static_cast<unsigned char>(content[root + 9]));
  std::string page = tree_page(13, content.substr(root + cell_at, kPage - cell_at), 0);
  for (std::size_t child = pages + 1; child < pages + 4; ++child) {
    content += page;
    std::string cell(5, '\1');
    put_number(cell, 0, child, 4);
    page = tree_page(5, cell, child);
  }
  content.replace(root, kPage, page);
  put_number(content, 28, pages + 3, 4);
  std::ofstream(file, std::ios::binary) << content;
  return file;
}

std::string rows(std::size_t count, const std::string& insert) {
  return "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < " + std::to_string(count) + ") " +
         insert;
}

std::vector<Case> databases(std::size_t bytes, const fs::path& folder) {
  const std::string topics =
      "CREATE TABLE topics(id INTEGER PRIMARY KEY,name TEXT,type TEXT,serialization_format TEXT,offered_qos_profiles "
      "TEXT);"
      "INSERT INTO topics VALUES(1,'/a','a/msg/A','cdr','');";
  const std::string messages =
      "CREATE TABLE messages(id INTEGER PRIMARY KEY,topic_id INTEGER,timestamp INTEGER,data BLOB);";
  const auto play_of = [&](const std::string& name, const std::string& statements) {
    return Case{"db3: " + name, [file = database(folder, "BEGIN;" + statements + "COMMIT;")] { play(file); }};
  };
  return {
      {"db3: one row again and again", [file = database_of_one_row(folder, bytes, topics)] { play(file); }},
      play_of("many messages", topics + messages + rows(bytes / 20, "INSERT INTO messages SELECT i,1,i,x'' FROM n;")),
      play_of("computed times",
              topics +
                  "CREATE TABLE messages(id INTEGER PRIMARY KEY,topic_id INTEGER,data BLOB,timestamp INTEGER AS "
                  "(length(hex(zeroblob(400000)))));" +
                  rows(bytes / 20, "INSERT INTO messages SELECT i,1,x'' FROM n;")),
      play_of("one definition of many topics",
              topics + messages +
                  "CREATE TABLE message_definitions(id INTEGER,topic_type TEXT,encoding "
                  "TEXT,encoded_message_definition TEXT);"
                  "INSERT INTO message_definitions VALUES(1,'a/msg/A','ros2msg',hex(zeroblob(" +
                  std::to_string(bytes / 4) + ")));" +
                  rows(std::min<std::size_t>(bytes / 100, 9000),
                       "INSERT INTO topics SELECT i+1,'/'||i,'a/msg/A','cdr','' FROM n;")),
      play_of("many definitions",
              topics + messages +
                  "CREATE TABLE message_definitions(id INTEGER,topic_type TEXT,encoding "
                  "TEXT,encoded_message_definition TEXT);" +
                  rows(bytes / 60, "INSERT INTO message_definitions SELECT i,'a/msg/A','','' FROM n;") +
                  rows(std::min<std::size_t>(bytes / 100, 9000),
                       "INSERT INTO topics SELECT i+1,'/'||i,'a/msg/A','cdr','' FROM n;")),
  };
}

}  // namespace

std::vector<Case> recordings(std::size_t bytes, const fs::path& folder) {
  std::vector<Case> cases = databases(bytes, folder);
  const auto add = [&](const std::string& name, const std::string& file, const std::string& content, auto read) {
    cases.push_back({name, [path = file_of(folder, file, content), read] { read(path); }});
  };
  const std::vector<std::pair<std::string, std::string>> files = {
      {"small messages in large chunks", mcap_file({bytes, 4 << 20, 0, false})},
      {"small messages in chunks of one time", mcap_file({bytes, 4 << 20, 0, true})},
      {"small messages in small chunks of one time", mcap_file({bytes, 1000, 0, true})},
      {"large messages", mcap_file({bytes, 4 << 20, 60 << 20, false})},
      {"large messages of one time, lz4", mcap_file({bytes, 4 << 20, 4 << 20, true, mcap::Compression::kLz4})},
      {"many topics of one type", mcap_of_topics(bytes, bytes / 2, 1)},
      {"many topics", mcap_of_topics(bytes, 8, 1)},
      {"long topics", mcap_of_topics(bytes, 8, 200)},
      {"topics of half the file", mcap_of_topics(bytes, 8, bytes / 8)},
      {"records in records", mcap_of_nested_records(bytes)},
      {"messages of no channel", mcap_of_strangers(bytes)}};
  for (const auto& [name, content] : files) {
    add("MCAP played: " + name, "a.mcap", content, play);
    add("MCAP checked: " + name, "a.mcap", content, check_mcap);
  }
  add("MCAP packed: zeros", "a.mcap.zstd", packed(std::string(bytes * 200 + (64 << 20), '\0')), play);
  add("bag: small messages, bz2", "a.bag", bag_of_chunks(8 * bytes, "bz2", false), play);
  add("bag: chunks of one time, lz4", "a.bag", bag_of_chunks(8 * bytes, "lz4", true), play);
  add("bag: chunks of one time, bz2", "a.bag", bag_of_chunks(8 * bytes, "bz2", true), play);
  add("bag: one message again and again", "a.bag", bag_of_one_message(bytes), play);
  add("bag: long topics", "a.bag", bag_of_long_topics(bytes), play);
  return cases;
}

}  // namespace rtd::worst
