// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// Cut and damaged files: every whole chunk is delivered, every damage is reported, nothing crashes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "common/mcap/copy.hpp"
#include "tests/unit/mcap/sample_file.hpp"

namespace rtd::mcap {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

struct Shape {
  Compression compression;
  bool use_chunks;
};

WriterOptions options_of(const Shape& shape, std::uint64_t chunk_size) {
  WriterOptions options;
  options.compression = shape.compression;
  options.use_chunks = shape.use_chunks;
  options.chunk_size = chunk_size;
  return options;
}

/// By how many bytes of the file each message is whole: the end of its chunk, or its own without chunks.
std::vector<std::uint64_t> ends_of_messages(const Bytes& file) {
  const io::MemorySource source(file);
  StreamReader reader(source);
  std::vector<std::uint64_t> ends;
  while (const Record* record = reader.next())
    if (std::holds_alternative<Message>(*record)) ends.push_back(reader.location().record.end());
  return ends;
}

/// The same for recover(), which opens a cut uncompressed chunk: by how many bytes the message itself is whole.
std::vector<std::uint64_t> ends_in_chunks(const Bytes& file) {
  const io::MemorySource source(file);
  StreamReader reader(source);
  std::vector<std::uint64_t> ends;
  while (const Record* record = reader.next()) {
    const auto* message = std::get_if<Message>(record);
    if (message == nullptr) continue;
    constexpr std::uint64_t kChunkHead = 9 + 40, kMessageHead = 9 + 22;
    const Location& location = reader.location();
    ends.push_back(location.in_chunk ? location.record.offset + kChunkHead + location.offset_in_chunk + kMessageHead +
                                           message->data.size()
                                     : location.record.end());
  }
  return ends;
}

std::size_t whole_messages(const std::vector<std::uint64_t>& ends, std::uint64_t cut) {
  return static_cast<std::size_t>(std::ranges::upper_bound(ends, cut) - ends.begin());
}

bool is_first_of(const std::vector<StoredMessage>& part, const std::vector<StoredMessage>& all, std::size_t count) {
  return part.size() == count && std::equal(part.begin(), part.end(), all.begin());
}

bool is_part_of(const std::vector<StoredMessage>& part, const std::vector<StoredMessage>& all) {
  auto at = all.begin();
  for (const StoredMessage& message : part) {
    at = std::find(at, all.end(), message);
    if (at++ == all.end()) return false;
  }
  return true;
}

class Damage : public ::testing::TestWithParam<Shape> {};

TEST_P(Damage, a_file_cut_at_any_byte_gives_every_whole_chunk) {
  const auto messages = sample_messages(24, 20);
  const Bytes file = file_of(messages, options_of(GetParam(), 200));
  const std::vector<std::uint64_t> ends = ends_of_messages(file);
  for (std::size_t cut = 0; cut < file.size(); ++cut) {
    const ByteView part = ByteView(file).first(cut);
    const std::size_t whole = whole_messages(ends, cut);
    const ReadBack streamed = stream(part);
    ASSERT_TRUE(is_first_of(streamed.messages, messages, whole)) << "cut at " << cut << '\n'
                                                                 << texts(streamed.problems);
    ASSERT_FALSE(streamed.problems.empty()) << "cut at " << cut;
    ASSERT_TRUE(is_first_of(by_index(part).messages, messages, whole)) << "cut at " << cut;
  }
}

TEST_P(Damage, a_file_cut_at_any_byte_is_made_whole_again) {
  const auto messages = sample_messages(12, 20);
  const Bytes file = file_of(messages, options_of(GetParam(), 200));
  const bool compressed = GetParam().compression != Compression::kNone;
  const std::vector<std::uint64_t> ends = compressed ? ends_of_messages(file) : ends_in_chunks(file);
  for (std::size_t cut = 0; cut < file.size(); ++cut) {
    io::MemorySink sink;
    const CopyReport report = recover(io::MemorySource(ByteView(file).first(cut)), sink);
    ASSERT_FALSE(report.problems.empty()) << "cut at " << cut;
    const ReadBack again = stream(sink.bytes());
    ASSERT_THAT(again.problems, IsEmpty()) << "cut at " << cut << '\n' << texts(again.problems);
    ASSERT_TRUE(is_first_of(again.messages, messages, whole_messages(ends, cut))) << "cut at " << cut;
  }
}

TEST_P(Damage, ten_thousand_random_cuts_of_a_bigger_file_give_every_whole_chunk) {
  const auto messages = sample_messages(600, 200);
  const Bytes file = file_of(messages, options_of(GetParam(), 8000));
  const std::vector<std::uint64_t> ends = ends_of_messages(file);
  std::mt19937 random(1);
  constexpr int kCuts = 10000 / 4;  // a quarter for each shape
  for (int i = 0; i < kCuts; ++i) {
    const std::size_t cut = random() % file.size();
    const io::MemorySource source(ByteView(file).first(cut));
    StreamReader reader(source);
    std::size_t count = 0;
    while (const Record* record = reader.next()) count += std::holds_alternative<Message>(*record) ? 1 : 0;
    ASSERT_EQ(count, whole_messages(ends, cut)) << "cut at " << cut;
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, Damage,
                         ::testing::Values(Shape{Compression::kNone, true}, Shape{Compression::kLz4, true},
                                           Shape{Compression::kZstd, true}, Shape{Compression::kNone, false}));

class BitFlips : public ::testing::TestWithParam<Compression> {
 protected:
  static constexpr std::size_t kMessagesPerChunk = 4;
  const std::vector<StoredMessage> messages_ = sample_messages(5 * kMessagesPerChunk, 15);

  Bytes file() const {
    WriterOptions options;
    options.compression = GetParam();
    options.self_contained_chunks = true;
    io::MemorySink sink;
    Writer writer(sink, options);
    write_all(writer, {});
    for (std::size_t i = 0; i < messages_.size(); ++i) {
      if (i % kMessagesPerChunk == 0) writer.end_chunk();
      const StoredMessage& message = messages_[i];
      writer.write(Message{static_cast<ChannelId>(message.topic == "/pose" ? 1 : 2), message.sequence, message.log_time,
                           message.publish_time, io::bytes_of(message.data)});
    }
    writer.write(Attachment{1, 1, "a", "text/plain", io::bytes_of("abc"), 0});
    writer.write(Metadata{"m", {{"k", "v"}}});
    writer.close();
    return sink.bytes();
  }
};

TEST_P(BitFlips, each_single_one_is_reported_and_costs_one_chunk_at_most) {
  Bytes bytes = file();
  for (std::size_t bit = 0; bit < bytes.size() * 8; ++bit) {
    bytes[bit / 8] ^= std::byte{1} << bit % 8;
    const ReadBack result = stream(bytes);
    ASSERT_FALSE(result.problems.empty()) << "bit " << bit;
    ASSERT_TRUE(is_part_of(result.messages, messages_)) << "bit " << bit;
    ASSERT_GE(result.messages.size() + kMessagesPerChunk, messages_.size())
        << "bit " << bit % 8 << " of byte " << bit / 8 << '\n'
        << texts(result.problems);
    if (bit % 8 == bit / 8 % 8) {
      ASSERT_TRUE(is_part_of(by_index(bytes).messages, messages_)) << "bit " << bit;
    }
    bytes[bit / 8] ^= std::byte{1} << bit % 8;
  }
}

/// Where a record's length is damaged a reader looks for the next record, which may be one inside a chunk: no CRC
/// covers that one alone. It happens to two or three files in 10,000, and the problems say that messages may be wrong.
TEST_P(BitFlips, several_at_once_are_reported_too) {
  const Bytes whole = file();
  int doubtful = 0;
  std::mt19937 random(2);
  for (int i = 0; i < 10000; ++i) {
    Bytes bytes = whole;
    for (std::size_t flips = 2 + random() % 6; flips > 0; --flips) {
      const std::size_t bit = random() % (bytes.size() * 8);
      bytes[bit / 8] ^= std::byte{1} << bit % 8;
    }
    if (bytes == whole) continue;
    const ReadBack result = stream(bytes);
    ASSERT_FALSE(result.problems.empty()) << "round " << i;
    if (is_part_of(result.messages, messages_)) continue;
    ++doubtful;
    ASSERT_THAT(texts(result.problems), HasSubstr("not in a chunk with its own CRC may be wrong")) << "round " << i;
  }
  EXPECT_LE(doubtful, 3);
}

INSTANTIATE_TEST_SUITE_P(Compressions, BitFlips,
                         ::testing::Values(Compression::kNone, Compression::kLz4, Compression::kZstd));

TEST(Recover, keeps_the_whole_messages_of_a_cut_chunk_and_says_that_no_checksum_covers_them) {
  const auto messages = sample_messages(10, 50);
  const Bytes file = file_of(messages);  // one chunk
  const std::uint64_t end_of_seventh = ends_in_chunks(file)[6];
  io::MemorySink sink;
  const CopyReport report = recover(io::MemorySource(ByteView(file).first(end_of_seventh + 20)), sink);
  EXPECT_TRUE(report.data_lost);
  ASSERT_EQ(report.problems.size(), 1U) << texts(report.problems);
  EXPECT_EQ(report.problems[0].kind, ProblemKind::kTruncated);
  EXPECT_THAT(report.problems[0].consequence, ::testing::HasSubstr("no checksum"));
  const ReadBack again = stream(sink.bytes());
  EXPECT_THAT(again.problems, IsEmpty()) << texts(again.problems);
  EXPECT_TRUE(is_first_of(again.messages, messages, 7));
}

TEST(Recover, reports_the_loss_and_keeps_the_rest) {
  const auto messages = sample_messages(40, 50);
  WriterOptions options;
  options.profile = "ros2";
  options.chunk_size = 400;
  Bytes file = file_of(messages, options);
  file[400] ^= std::byte{1};  // in the first chunk: the channels come from the summary then
  io::MemorySink sink;
  const CopyReport report = recover(io::MemorySource(file), sink);
  EXPECT_TRUE(report.data_lost);
  ASSERT_TRUE(report.announced);
  EXPECT_EQ(*report.messages_lost() + report.copied.message_count, messages.size());
  EXPECT_GT(report.copied.message_count, 30U);
  const ReadBack again = stream(sink.bytes());
  EXPECT_THAT(again.problems, IsEmpty()) << texts(again.problems);
  EXPECT_TRUE(is_part_of(again.messages, messages));
  EXPECT_EQ(IndexedReader(io::MemorySource(sink.bytes())).summary().header.profile, "ros2");
}

}  // namespace
}  // namespace rtd::mcap
