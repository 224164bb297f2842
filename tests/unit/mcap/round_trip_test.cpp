// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <algorithm>

#include "common/mcap/copy.hpp"
#include "tests/unit/mcap/raw_file.hpp"
#include "tests/unit/mcap/sample_file.hpp"

namespace rtd::mcap {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

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

Bytes joined(const std::vector<Bytes>& parts, CopyReport& report) {
  std::vector<io::MemorySource> sources;
  for (const Bytes& part : parts) sources.emplace_back(part);
  std::vector<const io::ByteSource*> pointers;
  for (const io::MemorySource& source : sources) pointers.push_back(&source);
  io::MemorySink sink;
  report = join(pointers, sink);
  return sink.bytes();
}

/// A file with one channel whose ids are not those of sample_file.hpp.
Bytes file_with_other_ids(const std::vector<StoredMessage>& messages) {
  io::MemorySink sink;
  Writer writer(sink);
  writer.write(Schema{7, "geometry_msgs/msg/PoseStamped", "ros2msg", "std_msgs/Header header"});
  writer.write(Channel{1, 0, "/log", "json", {}});
  writer.write(Channel{9, 7, "/pose", "cdr", {{"offered_qos_profiles", "- history: 1"}}});
  for (const StoredMessage& message : messages)
    writer.write(Message{9, message.sequence, message.log_time, message.publish_time, io::bytes_of(message.data)});
  writer.write(Metadata{"rosbag2", {{"a", "b"}}});
  writer.close();
  return sink.bytes();
}

TEST(Join, gives_every_message_of_all_parts_in_their_order) {
  const std::vector<StoredMessage> all = sample_messages(100, 300);
  std::vector<StoredMessage> last;
  for (std::uint32_t i = 0; i < 10; ++i) last.push_back({"/pose", i, 5000 + i, 5000 + i, "some bytes"});
  CopyReport report;
  const Bytes file = joined({file_of({all.begin(), all.begin() + 60}), file_of({all.begin() + 60, all.end()}),
                             file_with_other_ids(last), file_with_other_ids({})},
                            report);
  std::vector<StoredMessage> expected = all;
  expected.insert(expected.end(), last.begin(), last.end());
  const ReadBack back = stream(file);
  EXPECT_TRUE(back.problems.empty()) << texts(back.problems);
  EXPECT_TRUE(back.messages == expected);
  EXPECT_EQ(by_index(file).messages.size(), expected.size());
  EXPECT_FALSE(report.data_lost);
  EXPECT_EQ(report.copied.message_count, 110U);
  EXPECT_EQ(report.copied.channel_count, 3U) << "/pose, /frame and /log once each";
  EXPECT_EQ(report.copied.schema_count, 1U);
  EXPECT_EQ(report.copied.metadata_count, 1U);
}

TEST(Join, takes_the_intact_part_of_a_damaged_file_and_reports_it) {
  const std::vector<StoredMessage> all = sample_messages(100, 300);
  WriterOptions small;
  small.chunk_size = 2000;
  Bytes cut = file_of({all.begin(), all.begin() + 50}, small);
  cut.resize(cut.size() / 2);
  CopyReport report;
  const Bytes file = joined({cut, file_of({all.begin() + 50, all.end()})}, report);
  EXPECT_TRUE(report.data_lost);
  EXPECT_GT(report.problem_count, 0U);
  const ReadBack back = stream(file);
  EXPECT_TRUE(back.problems.empty()) << texts(back.problems);
  EXPECT_GT(back.messages.size(), 60U);
  EXPECT_LT(back.messages.size(), 100U);
  EXPECT_TRUE(back.messages.back() == all.back());
}

TEST(Join, of_nothing_is_an_empty_file) {
  CopyReport report;
  EXPECT_TRUE(stream(joined({}, report)).messages.empty());
}

/// Whole files with the peculiarities of other libraries: no problem is reported.

/// Python's mcap names groups without records: their length is 0.
TEST(OtherWriters, summary_offsets_of_empty_groups_are_no_damage) {
  const Bytes records = message_record(1, "abc");
  RawFile file;
  file.add_channel().add(chunk_of(records));
  const std::uint64_t start = file.data_end();
  Bytes summary;
  append_record(summary, Channel{1, 0, "/a", "cdr", {}});
  const std::uint64_t length = summary.size();
  append_record(summary, SummaryOffset{Opcode::kChannel, start, length});
  append_record(summary, SummaryOffset{Opcode::kAttachmentIndex, start + length, 0});
  append_record(summary, SummaryOffset{Opcode::kMetadataIndex, start + length, 0});
  const ReadBack result = stream(file.finish(summary, Footer{start, start + length, 0}));
  EXPECT_THAT(result.problems, IsEmpty()) << texts(result.problems);
  EXPECT_THAT(result.messages, SizeIs(1));
}

TEST(OtherWriters, a_missing_group_with_a_length_is_still_reported) {
  RawFile file;
  const std::uint64_t start = file.add_channel().data_end();
  Bytes summary;
  append_record(summary, SummaryOffset{Opcode::kMetadataIndex, start, 20});
  EXPECT_THAT(stream(file.finish(summary, Footer{start, start, 0})).problems, SizeIs(1));
}

/// Python's mcap and libmcap give the place of a summary that they left out.
TEST(OtherWriters, the_place_of_an_absent_summary_is_no_damage) {
  for (const bool names_summary : {false, true}) {
    RawFile file;
    const std::uint64_t end = file.add_channel().add(Message{1, 0, 5, 5, io::bytes_of("abc")}).data_end();
    const ReadBack result = stream(file.finish({}, Footer{names_summary ? end : 0, end, 0}));
    EXPECT_THAT(result.problems, IsEmpty()) << texts(result.problems);
    EXPECT_THAT(result.messages, SizeIs(1));
  }
}

/// libmcap repeats all channels in the summary, but counts only those with messages.
TEST(OtherWriters, a_channel_count_without_silent_channels_keeps_the_summary) {
  const Bytes records = message_record(1, "abc");
  const auto file_with = [&](std::uint32_t channel_count, ChannelId counted) {
    RawFile file;
    file.add_channel(1).add_channel(2);
    const ChunkIndex index = index_of(chunk_of(records), file.size(), 49 + records.size());
    file.add(chunk_of(records));
    Statistics statistics;
    statistics.message_count = statistics.chunk_count = 1;
    statistics.channel_count = channel_count;
    statistics.message_start_time = statistics.message_end_time = 5;
    statistics.channel_message_counts[counted] = 1;
    Bytes summary;
    append_record(summary, Channel{1, 0, "/a", "cdr", {}});
    append_record(summary, Channel{2, 0, "/a", "cdr", {}});
    append_record(summary, statistics);
    append_record(summary, index);
    return file.finish(summary);
  };
  const auto is_scanned = [](const Bytes& file) {
    const io::MemorySource source(file);
    return IndexedReader(source).summary().scanned;
  };
  EXPECT_FALSE(is_scanned(file_with(1, 1)));
  EXPECT_FALSE(is_scanned(file_with(2, 1)));
  EXPECT_TRUE(is_scanned(file_with(3, 1))) << "a channel is missing";
  EXPECT_TRUE(is_scanned(file_with(2, 3))) << "messages of an unknown channel";
}

TEST(OtherWriters, optional_parts_may_be_missing) {
  const auto messages = sample_messages(12, 20);
  for (const bool chunks : {true, false})
    for (const bool index : {true, false})
      for (const bool repeated : {true, false}) {
        WriterOptions options;
        options.use_chunks = chunks;
        options.use_message_index = options.use_chunk_index = index;
        options.use_statistics = options.use_repeated_channels = options.use_repeated_schemas = repeated;
        options.chunk_size = 200;
        const Bytes file = file_of(messages, options);
        const ReadBack streamed = stream(file), indexed = by_index(file);
        EXPECT_THAT(streamed.problems, IsEmpty()) << texts(streamed.problems);
        EXPECT_EQ(indexed.messages, messages);
        for (const Problem& problem : indexed.problems) EXPECT_FALSE(is_damage(problem)) << to_string(problem);
      }
}

}  // namespace
}  // namespace rtd::mcap
