// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <lz4.h>
#include <sys/resource.h>
#include <unistd.h>
#include <zstd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>

#include "common/mcap/writer.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/mcap/sample_file.hpp"

namespace rtd::mcap {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// A sink that is full after `room` bytes, until it is given more.
class SmallSink final : public io::ByteSink {
 public:
  explicit SmallSink(std::uint64_t room) : room_(room) {}
  void append(std::initializer_list<ByteView> parts) override {
    std::uint64_t size = 0;
    for (const ByteView part : parts) size += part.size();
    if (memory_.position() + size > room_) throw io::IoError(ENOSPC, "sink");
    memory_.append(parts);
  }
  std::uint64_t position() const override { return memory_.position(); }
  std::uint64_t sync() override { return memory_.sync(); }
  const Bytes& bytes() const { return memory_.bytes(); }
  void give_room() { room_ = 1 << 30; }

 private:
  io::MemorySink memory_;
  std::uint64_t room_;
};

TEST(Writer, refuses_what_the_format_does_not_allow) {
  io::MemorySink sink;
  Writer writer(sink);
  EXPECT_THROW(writer.write(Message{7}), std::invalid_argument);
  EXPECT_THROW(writer.write(Channel{1, 9, "/a", "cdr"}), std::invalid_argument);
  EXPECT_THROW(writer.write(Schema{0, "a", "b", "c"}), std::invalid_argument);
  writer.write(Schema{1, "a", "b", "c"});
  writer.write(Schema{1, "a", "b", "c"});
  EXPECT_THROW(writer.write(Schema{1, "other", "b", "c"}), std::invalid_argument);
  writer.close();
  writer.close();
  EXPECT_THROW(writer.write(Metadata{}), std::invalid_argument);
  EXPECT_THROW(Writer(sink, {}), std::invalid_argument);
  EXPECT_THAT(stream(sink.bytes()).problems, IsEmpty());
}

TEST(Writer, gives_free_ids) {
  io::MemorySink sink;
  Writer writer(sink);
  writer.write(Schema{2, "taken", "ros2msg", "x"});
  EXPECT_EQ(writer.add(Schema{0, "a", "ros2msg", "x"}), 1);
  EXPECT_EQ(writer.add(Schema{0, "b", "ros2msg", "x"}), 3);
  EXPECT_EQ(writer.add(Channel{0, 3, "/b", "cdr"}), 1);
}

TEST(Writer, ends_a_chunk_on_request) {
  io::MemorySink sink;
  Writer writer(sink);
  const auto messages = sample_messages(3, 100);
  write_all(writer, messages);
  EXPECT_EQ(writer.written().messages, 0U);
  EXPECT_EQ(writer.open_chunk_messages(), 3U);
  writer.end_chunk();
  EXPECT_EQ(writer.written().messages, 3U);
  EXPECT_EQ(writer.written().offset, sink.position());
  EXPECT_EQ(writer.open_chunk_bytes(), 0U);
  EXPECT_EQ(stream(sink.bytes()).messages, messages);
}

TEST(Writer, makes_no_chunk_without_messages) {
  io::MemorySink sink;
  Writer writer(sink);
  write_all(writer, sample_messages(3, 100));
  writer.end_chunk();
  writer.add(Channel{0, 0, "/silent", "cdr"});
  writer.end_chunk();
  writer.close();
  const io::MemorySource source(sink.bytes());
  const IndexedReader reader(source);
  ASSERT_EQ(reader.summary().chunk_indexes.size(), 1U);
  EXPECT_GT(reader.summary().chunk_indexes[0].message_index_length, 0U);
  EXPECT_EQ(reader.problems().total(), 0U);
  EXPECT_EQ(reader.summary().channels.rbegin()->second.topic, "/silent");
}

TEST(Writer, continues_after_a_full_disk_without_loss_or_repetition) {
  const auto messages = sample_messages(200, 100);
  SmallSink sink(5000);
  WriterOptions options;
  options.chunk_size = 2000;
  Writer writer(sink, options);
  write_all(writer, {});
  int refusals = 0;
  for (const StoredMessage& message : messages) {
    const ChannelId channel = message.topic == "/pose" ? 1 : 2;
    const Message record{channel, message.sequence, message.log_time, message.publish_time, io::bytes_of(message.data)};
    try {
      writer.write(record);
    } catch (const io::IoError& error) {
      ++refusals;
      EXPECT_EQ(error.code().value(), ENOSPC);
      EXPECT_EQ(writer.written().offset, sink.position());
      sink.give_room();
      writer.write(record);
    }
  }
  writer.close();
  EXPECT_EQ(refusals, 1);
  const ReadBack result = stream(sink.bytes());
  EXPECT_EQ(result.messages, messages);
  EXPECT_THAT(result.problems, IsEmpty()) << texts(result.problems);
}

TEST(Writer, splits_into_files_that_each_stand_alone) {
  const auto messages = sample_messages(30, 50);
  io::MemorySink first, second;
  Writer writer(first);
  write_all(writer, {messages.begin(), messages.begin() + 20});
  writer.split(second);
  write_all(writer, {});  // the ids of the first file are still known: these are two more channels
  for (std::size_t i = 20; i < 30; ++i)
    writer.write(Message{static_cast<ChannelId>(messages[i].topic == "/pose" ? 1 : 2), messages[i].sequence,
                         messages[i].log_time, messages[i].publish_time, io::bytes_of(messages[i].data)});
  writer.close();
  ReadBack both = stream(first.bytes());
  const ReadBack rest = stream(second.bytes());
  EXPECT_THAT(both.problems, IsEmpty()) << texts(both.problems);
  EXPECT_THAT(rest.problems, IsEmpty()) << texts(rest.problems);
  both.messages.insert(both.messages.end(), rest.messages.begin(), rest.messages.end());
  EXPECT_EQ(both.messages, messages);
}

TEST(Writer, self_contained_chunks_survive_the_loss_of_the_first) {
  WriterOptions options;
  options.chunk_size = 400;
  for (const bool self_contained : {false, true}) {
    options.self_contained_chunks = self_contained;
    Bytes file = file_of(sample_messages(60, 50), options);
    file[200] ^= std::byte{1};  // in the first chunk, which has the channels
    file.resize(file.size() / 2);
    const std::size_t read = stream(file).messages.size();
    EXPECT_EQ(read > 20, self_contained) << read;
  }
}

class FileSinkTest : public ::testing::Test {
 protected:
  const rtd::test::TemporaryFolder folder_;
  const std::filesystem::path path_ = folder_ / "a.mcap";
};

std::string reason_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const io::IoError& error) {
    return error.what();
  }
  return "";
}

TEST_F(FileSinkTest, round_trip_and_durable_position) {
  const auto messages = sample_messages(50, 5000);
  io::FileSink sink(path_);
  Writer writer(sink);
  write_all(writer, messages);
  writer.end_chunk();
  EXPECT_EQ(sink.sync(), writer.written().offset);
  EXPECT_EQ(std::filesystem::file_size(path_), writer.written().offset);
  EXPECT_TRUE(io::FileSource(path_).being_written());
  writer.close();
  const io::FileSource source(path_);
  StreamReader reader(source);
  std::size_t count = 0;
  while (const Record* record = reader.next()) count += std::holds_alternative<Message>(*record);
  EXPECT_EQ(count, messages.size());
  EXPECT_THAT(reader.problems().listed(), IsEmpty());
}

TEST_F(FileSinkTest, names_the_reason_when_it_cannot_write) {
  { io::FileSink sink(path_); }
  EXPECT_FALSE(io::FileSource(path_).being_written());
  EXPECT_THAT(reason_of([&] { io::FileSink sink(path_); }), HasSubstr("exists already"));
  io::FileSink open(path_, io::IfExists::kReplace);
  EXPECT_THAT(reason_of([&] { io::FileSink sink(path_, io::IfExists::kReplace); }),
              HasSubstr("another process is writing it"));
  EXPECT_THAT(reason_of([&] { io::FileSink sink(folder_ / "no" / "a.mcap"); }), HasSubstr("no such folder"));
  EXPECT_THAT(reason_of([&] { io::FileSink sink("/proc/a.mcap"); }), HasSubstr("/proc/a.mcap"));
  EXPECT_THAT(reason_of([&] { io::FileSource source(folder_ / "none.mcap"); }), HasSubstr("none.mcap"));
  EXPECT_THAT(reason_of([&] { io::FileSource source(folder_); }), HasSubstr("this is a folder: name a file in it"));
}

/// Files of this process cannot grow beyond `bytes` while it lives: a disk that is full in the middle of a record.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }

 private:
  rlimit before_{};
  void (*handler_)(int);
};

TEST_F(FileSinkTest, full_disk_leaves_whole_records) {
  io::FileSink sink(path_);
  Writer writer(sink);
  const auto messages = sample_messages(10, 5000);
  write_all(writer, messages);
  {
    const FileSizeLimit limit(20000);
    EXPECT_THAT(reason_of([&] { writer.end_chunk(); }), HasSubstr(path_.string()));
    EXPECT_EQ(std::filesystem::file_size(path_), writer.written().offset);
  }
  writer.close();
  const io::FileSource source(path_);
  EXPECT_EQ(IndexedReader(source).summary().statistics->message_count, messages.size());
  EXPECT_FALSE(IndexedReader(source).summary().scanned);
}

TEST(Files, a_folder_in_place_of_a_file_is_named_with_the_fix) {
  const std::string folder = ::testing::TempDir();
  const auto message_of = [](const auto& open) -> std::string {
    try {
      open();
    } catch (const io::IoError& error) {
      EXPECT_EQ(error.code().value(), EISDIR);
      return error.what();
    }
    return "it was opened";
  };
  const std::string expected = folder + ": this is a folder: name a file in it";
  EXPECT_EQ(message_of([&] { io::FileSource source(folder); }), expected);
  EXPECT_EQ(message_of([&] { io::FileSink sink(folder, io::IfExists::kReplace); }), expected);
}

/// Two files with everything that a writer can write: three topics in several chunks, an attachment, metadata, a split.
Bytes written_with(const WriterOptions& options) {
  io::MemorySink first, second;
  Writer writer(first, options);
  const SchemaId pose = writer.add(Schema{0, "geometry_msgs/msg/PoseStamped", "ros2msg", "Header header"});
  const ChannelId channels[] = {writer.add(Channel{0, pose, "/camera_pose", "cdr", {{"qos", "- depth: 10"}}}),
                                writer.add(Channel{0, 0, "/raw", "", {}}),
                                writer.add(Channel{0, pose, "/odom", "cdr", {{"a", "1"}, {"b", "2"}}})};
  std::uint32_t state = 1;
  for (std::uint32_t i = 0; i < 400; ++i) {
    std::string data(i * 7 % 90, '\0');
    for (char& byte : data) byte = static_cast<char>((state = state * 1664525 + 1013904223) >> 27);
    writer.write(Message{channels[i % 3], i, 1000 + 10 * i, 990 + 10 * i, io::bytes_of(data)});
    if (i == 100) writer.write(Attachment{5, 6, "calibration.yaml", "text/yaml", io::bytes_of("fx: 525"), 0});
    if (i == 200) writer.write(Metadata{"run", {{"mode", "rtd"}}});
    if (i == 300) writer.split(second);
    if (i % 150 == 60) writer.end_chunk();
  }
  writer.close();
  Bytes both = first.bytes();
  both.insert(both.end(), second.bytes().begin(), second.bytes().end());
  return both;
}

struct Expected {
  Compression compression;
  bool self_contained_chunks;
  std::size_t size;
  std::uint32_t crc;
};

class WriterIdentity : public testing::TestWithParam<Expected> {};

TEST_P(WriterIdentity, same_messages_give_the_same_bytes_as_ever) {
  const auto [compression, self_contained_chunks, size, crc] = GetParam();
  if (compression == Compression::kLz4 && LZ4_versionNumber() != 10904) GTEST_SKIP() << "recorded with LZ4 1.9.4";
  if (compression == Compression::kZstd && ZSTD_versionNumber() != 10504) GTEST_SKIP() << "recorded with zstd 1.5.4";
  WriterOptions options{.profile = "ros2", .library = "test", .compression = compression, .chunk_size = 2048};
  options.self_contained_chunks = self_contained_chunks;
  const Bytes bytes = written_with(options);
  EXPECT_EQ(bytes.size(), size);
  EXPECT_EQ(io::crc32(bytes), crc);
}

INSTANTIATE_TEST_SUITE_P(Compressions, WriterIdentity,
                         testing::Values(Expected{Compression::kNone, false, 41732, 0x9bc54b36},
                                         Expected{Compression::kNone, true, 46825, 0xe9b775cd},
                                         Expected{Compression::kLz4, false, 37644, 0x31484829},
                                         Expected{Compression::kLz4, true, 41133, 0x1e96d7ce},
                                         Expected{Compression::kZstd, false, 29382, 0x90c888e9},
                                         Expected{Compression::kZstd, true, 32620, 0x11d9ce85}));

}  // namespace
}  // namespace rtd::mcap
