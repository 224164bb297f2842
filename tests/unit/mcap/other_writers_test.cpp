// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// Whole files with the peculiarities of other libraries: no problem is reported.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/mcap/raw_file.hpp"
#include "tests/unit/mcap/sample_file.hpp"

namespace rtd::mcap {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

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
