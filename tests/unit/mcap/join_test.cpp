// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/mcap/copy.hpp"

#include <gtest/gtest.h>

#include "tests/unit/mcap/sample_file.hpp"

namespace rtd::mcap {
namespace {

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

}  // namespace
}  // namespace rtd::mcap
