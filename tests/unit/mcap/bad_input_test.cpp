// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// Files that lie: each lie has its own problem, and nothing is allocated for it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/mcap/raw_file.hpp"
#include "tests/unit/mcap/sample_file.hpp"

namespace rtd::mcap {
namespace {

using namespace ::testing;

auto kind(ProblemKind kind) {
  return Field(&Problem::kind, kind);
}

TEST(BadInput, not_an_mcap) {
  for (const std::string text : {"", "x", "#ROSBAG V2.0\n and much more than a header", "\x89MCAP1\r\n"}) {
    EXPECT_THAT(stream(io::bytes_of(text)).problems, ElementsAre(kind(ProblemKind::kNotMcap))) << text;
    EXPECT_THAT(by_index(io::bytes_of(text)).messages, IsEmpty());
  }
}

TEST(BadInput, unknown_compression) {
  const Bytes records = message_record(1, "abc");
  Chunk chunk = chunk_of(records);
  chunk.compression = "brotli";
  const ReadBack result = stream(RawFile().add_channel().add(chunk).finish());
  ASSERT_THAT(result.problems, ElementsAre(kind(ProblemKind::kUnknownCompression)));
  EXPECT_THAT(result.problems[0].what, ::testing::HasSubstr("\"brotli\""));
  EXPECT_TRUE(result.problems[0].data_lost);
}

TEST(BadInput, missing_schema_is_reported_and_loses_nothing) {
  const Bytes records = message_record(1, "abc");
  const ReadBack result = stream(RawFile().add_channel(1, 9).add(chunk_of(records)).finish());
  ASSERT_THAT(result.problems, ElementsAre(kind(ProblemKind::kMissingSchema)));
  EXPECT_FALSE(result.problems[0].data_lost);
  EXPECT_THAT(result.messages, SizeIs(1));
}

TEST(BadInput, messages_without_channel_are_counted) {
  Bytes records = message_record(8, "abc");
  const Bytes second = message_record(8, "def");
  records.insert(records.end(), second.begin(), second.end());
  const ReadBack result = stream(RawFile().add_channel().add(chunk_of(records)).finish());
  ASSERT_THAT(result.problems, ElementsAre(kind(ProblemKind::kMissingChannel)));
  EXPECT_EQ(result.problems[0].count, 2U);
  EXPECT_THAT(result.messages, IsEmpty());
}

TEST(BadInput, chunk_that_claims_four_gigabytes_is_not_allocated) {
  const Bytes records = message_record(1, "abc");
  for (const char* const compression : {"", "lz4", "zstd"}) {
    Chunk chunk = chunk_of(records);
    chunk.compression = compression;
    chunk.uncompressed_size = std::uint64_t{4} << 30;
    const ReadBack result = stream(RawFile().add_channel().add(chunk).finish());
    EXPECT_THAT(result.problems, ElementsAre(kind(ProblemKind::kTooLarge))) << texts(result.problems);
  }
}

TEST(BadInput, record_that_claims_four_gigabytes) {
  const ReadBack cut = stream(RawFile().add_channel().add_raw(0x06, std::uint64_t{4} << 30, {}).finish());
  EXPECT_THAT(cut.problems, Contains(kind(ProblemKind::kDamagedRecord))) << texts(cut.problems);
}

TEST(BadInput, record_above_the_limit_of_the_reader) {
  ReaderOptions options;
  options.max_record_bytes = 1000;
  const Bytes large = message_record(1, std::string(2000, 'x'));
  const Bytes small = message_record(1, "abc");
  const Bytes file = RawFile().add_channel().add(chunk_of(large)).add(chunk_of(small)).finish();
  const ReadBack result = stream(file, options);
  EXPECT_THAT(result.problems, ElementsAre(kind(ProblemKind::kTooLarge))) << texts(result.problems);
  EXPECT_THAT(result.messages, SizeIs(1));
}

TEST(BadInput, message_longer_than_its_chunk) {
  Bytes records = message_record(1, "whole");
  const std::size_t first = records.size();
  const Bytes second = message_record(1, "longer than it should be");
  records.insert(records.end(), second.begin(), second.end() - 4);
  const ReadBack result = stream(RawFile().add_channel().add(chunk_of(records)).finish());
  ASSERT_THAT(result.problems, ElementsAre(kind(ProblemKind::kDamagedRecord)));
  EXPECT_THAT(result.problems[0].what, ::testing::HasSubstr("at " + std::to_string(first)));
  EXPECT_THAT(result.messages, SizeIs(1));
  EXPECT_THAT(by_index(RawFile().add_channel().add(chunk_of(records)).finish()).messages, SizeIs(1));
}

TEST(BadInput, index_with_wrong_offsets_is_not_used) {
  const Bytes records = message_record(1, "abc");
  for (const std::uint64_t offset : {std::uint64_t{9}, std::uint64_t{60}, std::uint64_t{1} << 40, ~std::uint64_t{0}}) {
    RawFile file;
    file.add_channel().add(chunk_of(records));
    Bytes summary;
    append_record(summary, Channel{1, 0, "/a", "cdr", {}});
    append_record(summary, ChunkIndex{5, 5, offset, 49 + records.size(), {}, 0, "", records.size(), records.size()});
    const Bytes bytes = file.finish(summary);
    EXPECT_THAT(stream(bytes).problems, ElementsAre(kind(ProblemKind::kIndexMismatch)));
    const ReadBack indexed = by_index(bytes);
    EXPECT_THAT(indexed.problems, Contains(kind(ProblemKind::kIndexMismatch)));
    EXPECT_THAT(indexed.messages, SizeIs(1));
  }
}

TEST(BadInput, reports_a_wrong_message_index) {
  const Bytes records = message_record(1, "abc");
  for (const MessageIndex& index : {MessageIndex{1, {{5, 7}}}, MessageIndex{1, {{6, 0}}}, MessageIndex{2, {{5, 0}}},
                                    MessageIndex{1, {{5, 0}, {5, 0}}}, MessageIndex{1, {}}}) {
    const ReadBack result = stream(RawFile().add_channel().add(chunk_of(records)).add(index).finish());
    EXPECT_THAT(result.problems, ElementsAre(kind(ProblemKind::kIndexMismatch)));
    EXPECT_THAT(result.messages, SizeIs(1));
  }
}

TEST(BadInput, unknown_records_are_skipped) {
  const Bytes records = message_record(1, "abc");
  const ReadBack result =
      stream(RawFile().add_raw(0x85, 3, io::bytes_of("own")).add_channel().add(chunk_of(records)).finish());
  ASSERT_THAT(result.problems, ElementsAre(kind(ProblemKind::kUnknownRecord)));
  EXPECT_FALSE(result.problems[0].data_lost);
  EXPECT_THAT(result.messages, SizeIs(1));
}

TEST(BadInput, contradicting_definitions) {
  const ReadBack result = stream(RawFile().add_channel().add(Channel{1, 0, "/other", "cdr", {}}).finish());
  EXPECT_THAT(result.problems, ElementsAre(kind(ProblemKind::kConflictingDefinition)));
}

TEST(BadInput, bytes_behind_the_end) {
  Bytes file = RawFile().add_channel().finish();
  Encoder(file).rest(io::bytes_of("something appended later"));
  EXPECT_THAT(stream(file).problems, ElementsAre(kind(ProblemKind::kMisplacedRecord)));
}

TEST(BadInput, damaged_attachment_is_left_out) {
  io::MemorySink sink;
  Writer writer(sink);
  writer.write(Attachment{1, 1, "notes", "text/plain", io::bytes_of("abcdef"), 0});
  writer.close();
  Bytes file = sink.bytes();
  const auto data = std::ranges::search(file, io::bytes_of("abcdef"));
  data.front() = std::byte{'x'};
  EXPECT_THAT(stream(file).problems, Contains(kind(ProblemKind::kCrcMismatch)));
  const io::MemorySource source(file);
  IndexedReader reader(source);
  EXPECT_FALSE(reader.attachment(reader.summary().attachment_indexes.at(0)));
  EXPECT_TRUE(reader.problems().data_lost());
}

TEST(BadInput, decompression_bomb_is_bounded_by_what_the_format_can_do) {
  EXPECT_EQ(largest_uncompressed_size(Compression::kLz4, 100), 25500U);
  Buffer buffer;
  const std::string zeros(1 << 20, '\0');
  for (const Compression compression : {Compression::kLz4, Compression::kZstd}) {
    const ByteView packed = compress(compression, io::bytes_of(zeros), buffer);
    EXPECT_LE(zeros.size(), largest_uncompressed_size(compression, packed.size()));
  }
}

TEST(Problems, are_bounded_and_counted) {
  Bytes records;
  for (ChannelId id = 10; id < 30; ++id) {
    const Bytes message = message_record(id, "abc");
    records.insert(records.end(), message.begin(), message.end());
  }
  const Bytes file = RawFile().add_channel().add(chunk_of(records)).finish();
  const io::MemorySource source(file);
  ReaderOptions options;
  options.max_problems = 5;
  StreamReader reader(source, options);
  while (reader.next() != nullptr) continue;
  EXPECT_THAT(reader.problems().listed(), SizeIs(5));
  EXPECT_EQ(reader.problems().total(), 20U);
}

}  // namespace
}  // namespace rtd::mcap
