// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/unit/mcap/sample_file.hpp"

namespace rtd::mcap {
namespace {

using ::testing::IsEmpty;

struct WriterShape {
  Compression compression;
  bool use_chunks;
  std::uint64_t chunk_size;
  std::size_t message_size;
};

class RoundTrip : public ::testing::TestWithParam<WriterShape> {
 protected:
  static WriterOptions options() {
    WriterOptions options;
    options.profile = "ros2";
    options.compression = GetParam().compression;
    options.use_chunks = GetParam().use_chunks;
    options.chunk_size = GetParam().chunk_size;
    return options;
  }
};

TEST_P(RoundTrip, gives_the_same_messages_in_file_order_and_by_index) {
  const auto messages = sample_messages(100, GetParam().message_size);
  const Bytes file = file_of(messages, options());
  const ReadBack streamed = stream(file);
  EXPECT_EQ(streamed.messages, messages);
  EXPECT_THAT(streamed.problems, IsEmpty()) << texts(streamed.problems);
  const ReadBack indexed = by_index(file);
  EXPECT_EQ(indexed.messages, messages);
}

TEST_P(RoundTrip, finds_times_and_topics) {
  const auto messages = sample_messages(100, GetParam().message_size);
  MessageQuery query{305, 620, [](const Channel& channel) { return channel.topic == "/pose"; }};
  std::vector<StoredMessage> wanted;
  std::ranges::copy_if(messages, std::back_inserter(wanted), [](const StoredMessage& message) {
    return message.topic == "/pose" && message.log_time >= 305 && message.log_time <= 620;
  });
  ASSERT_FALSE(wanted.empty());
  EXPECT_EQ(by_index(file_of(messages, options()), query).messages, wanted);
}

TEST_P(RoundTrip, reads_what_is_there_of_a_file_that_was_never_closed) {
  const auto messages = sample_messages(100, GetParam().message_size);
  io::MemorySink sink;
  Writer writer(sink, options());
  write_all(writer, messages);
  const Written written = writer.written();
  ASSERT_EQ(written.offset, sink.bytes().size());
  const ReadBack streamed = stream(sink.bytes());
  EXPECT_EQ(streamed.messages.size(), written.messages);
  EXPECT_TRUE(std::ranges::equal(streamed.messages, std::span(messages).first(written.messages)));
  ASSERT_EQ(streamed.problems.size(), 1U) << texts(streamed.problems);
  EXPECT_EQ(streamed.problems[0].kind, ProblemKind::kTruncated);
  EXPECT_EQ(by_index(sink.bytes()).messages.size(), written.messages);
}

INSTANTIATE_TEST_SUITE_P(
    Shapes, RoundTrip,
    ::testing::Values(WriterShape{Compression::kNone, true, 1000, 50}, WriterShape{Compression::kNone, true, 1, 50},
                      WriterShape{Compression::kNone, true, 1 << 20, 50},
                      WriterShape{Compression::kNone, false, 1000, 50}, WriterShape{Compression::kLz4, true, 1000, 50},
                      WriterShape{Compression::kZstd, true, 1000, 50}, WriterShape{Compression::kNone, true, 1000, 0},
                      WriterShape{Compression::kLz4, true, 1 << 20, 100000},
                      WriterShape{Compression::kZstd, true, 1 << 20, 100000},
                      WriterShape{Compression::kNone, true, 65536 - 31, 65536}));

TEST(IndexedReader, orders_messages_of_overlapping_chunks_by_time_and_then_by_place) {
  std::vector<StoredMessage> messages = sample_messages(200, 20);
  for (std::size_t i = 0; i < messages.size(); ++i) messages[i].log_time = (i * 37) % 50;
  WriterOptions options;
  options.chunk_size = 300;
  ReaderOptions tight;
  tight.cache_bytes = 700;
  const ReadBack indexed = by_index(file_of(messages, options), {}, tight);
  std::ranges::stable_sort(messages, {}, &StoredMessage::log_time);
  EXPECT_EQ(indexed.messages, messages);
  EXPECT_THAT(indexed.problems, IsEmpty()) << texts(indexed.problems);
}

TEST(IndexedReader, gives_attachments_and_metadata) {
  io::MemorySink sink;
  Writer writer(sink);
  writer.write(Attachment{1, 2, "calibration.yaml", "text/yaml", io::bytes_of("fx: 525"), 0});
  writer.write(Metadata{"rtd", {{"robot", "r2"}}});
  writer.close();
  const io::MemorySource source(sink.bytes());
  IndexedReader reader(source);
  ASSERT_EQ(reader.summary().attachment_indexes.size(), 1U);
  const auto attachment = reader.attachment(reader.summary().attachment_indexes[0]);
  ASSERT_TRUE(attachment);
  EXPECT_TRUE(std::ranges::equal(attachment->data, io::bytes_of("fx: 525")));
  const auto metadata = reader.metadata(reader.summary().metadata_indexes.at(0));
  ASSERT_TRUE(metadata);
  EXPECT_EQ(metadata->metadata.at("robot"), "r2");
  EXPECT_THAT(reader.problems().listed(), IsEmpty());
}

TEST(IndexedReader, reads_a_closed_file_without_scanning_it) {
  const Bytes file = file_of(sample_messages(10, 10));
  const io::MemorySource source(file);
  EXPECT_FALSE(IndexedReader(source).summary().scanned);
}

}  // namespace
}  // namespace rtd::mcap
