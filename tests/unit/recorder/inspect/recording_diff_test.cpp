// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cstring>

#include "common/msg/tracking.hpp"
#include "services/recorder/inspect/recording_diff.hpp"
#include "services/recorder/inspect/recording_report.hpp"
#include "tests/unit/recorder/inspect/sample_recording.hpp"

namespace rtd::recordings {
namespace {

using testing::Contains;
using testing::HasSubstr;

RecordingDiff compare(const std::vector<SampleMessage>& a, const std::vector<SampleMessage>& b,
                      const DiffOptions& options = {}, const std::string& type = {}) {
  const io::Bytes file_a = recording_of(a, {}, type), file_b = recording_of(b, {}, type);
  const io::MemorySource source_a(file_a), source_b(file_b);
  RecordingDiff result = diff(contents_of(source_a), contents_of(source_b), options);
  explain(result, source_a, source_b);
  return result;
}

std::string tracking_payload(std::uint64_t seq, double x_m, std::int64_t finished_ns) {
  msg::TrackingResult result{};
  result.seq = seq;
  result.T_world_camera.translation_m[0] = x_m;
  result.finished_ns = finished_ns;
  std::string bytes(4 + sizeof(result), '\0');
  bytes[1] = 1;
  std::memcpy(bytes.data() + 4, &result, sizeof(result));
  return bytes;
}

TEST(RecordingDiff, a_recording_equals_itself_and_its_replay_recorded_later) {
  const std::vector<SampleMessage> a = regular_messages("/pose", 20);
  std::vector<SampleMessage> later = a;
  for (SampleMessage& message : later) {
    message.publish_ns = message.time_ns;
    message.time_ns += 5'000'000'000;
  }
  EXPECT_TRUE(compare(a, a).equal());
  EXPECT_TRUE(compare(a, later).equal());
}

TEST(RecordingDiff, finds_a_payload_that_differs) {
  const std::vector<SampleMessage> a = regular_messages("/pose", 20);
  std::vector<SampleMessage> b = a;
  b[7].payload[6] = 'X';
  const RecordingDiff result = compare(a, b);
  EXPECT_FALSE(result.equal());
  ASSERT_TRUE(result.topics[0].first);
  EXPECT_EQ(result.topics[0].payloads, 1U);
  EXPECT_EQ(result.topics[0].first->index_a, 7U);
  EXPECT_THAT(result.topics[0].first->why, Contains("first at byte 6 of the payload"));
}

TEST(RecordingDiff, a_lost_message_makes_no_difference_of_all_that_follow) {
  const std::vector<SampleMessage> a = regular_messages("/pose", 20);
  std::vector<SampleMessage> b = a;
  b.erase(b.begin() + 3);
  const RecordingDiff result = compare(a, b);
  EXPECT_EQ(result.topics[0].only_a, 1U);
  EXPECT_EQ(result.topics[0].first_missing, 3U);
  EXPECT_EQ(result.topics[0].payloads, 0U);
  EXPECT_FALSE(result.equal());
}

TEST(RecordingDiff, finds_another_order_and_other_stamps) {
  const std::vector<SampleMessage> a = regular_messages("/pose", 20);
  std::vector<SampleMessage> swapped = a, shifted = a;
  std::swap(swapped[4].payload, swapped[5].payload);
  for (std::size_t i : {4, 5}) swapped[i].publish_ns = a[9 - i].time_ns;
  shifted[4].publish_ns = 77;
  EXPECT_EQ(compare(a, swapped).topics[0].out_of_order, 1U);
  EXPECT_FALSE(compare(a, swapped).equal());
  EXPECT_FALSE(compare(a, shifted).equal());
}

TEST(RecordingDiff, measures_how_well_the_times_between_messages_were_kept) {
  const std::vector<SampleMessage> a = regular_messages("/pose", 11);
  std::vector<SampleMessage> b = a;
  for (std::size_t i = 0; i < b.size(); ++i) {
    b[i].publish_ns = b[i].time_ns;
    b[i].time_ns += 7'000'000'000 + (i == 10 ? 3'000'000 : 0);
  }
  const RecordingDiff result = compare(a, b);
  EXPECT_EQ(result.topics[0].timing_p50_ms, 0);
  EXPECT_EQ(result.topics[0].timing_p99_ms, 3);
  EXPECT_TRUE(result.equal());
}

TEST(RecordingDiff, a_topic_on_one_side_is_a_difference) {
  std::vector<SampleMessage> a = regular_messages("/pose", 5), b = a;
  b.push_back({"/frame", 2'000'000'000, "x"});
  const RecordingDiff result = compare(a, b);
  ASSERT_EQ(result.topics.size(), 2U);
  EXPECT_FALSE(result.equal());
  EXPECT_THAT(to_text(result), HasSubstr("only in B"));
}

TEST(RecordingDiff, the_same_bytes_in_another_encoding_are_a_difference) {
  const std::vector<SampleMessage> messages = regular_messages("/pose", 5);
  const io::Bytes cdr = recording_of(messages), json = recording_of(messages, {}, {}, "json");
  const io::MemorySource source_cdr(cdr), source_json(json);
  const RecordingDiff result = diff(contents_of(source_cdr), contents_of(source_json));
  EXPECT_FALSE(result.equal());
  EXPECT_THAT(to_text(result), HasSubstr("differs in encoding: cdr | json"));
  EXPECT_EQ(to_json(result)["topics"][0]["encoding_b"], "json");
  EXPECT_TRUE(diff(contents_of(source_json), contents_of(source_json)).equal());
}

/// CDR of that type would be too short.
TEST(RecordingDiff, messages_that_are_not_cdr_are_compared_by_bytes) {
  std::vector<SampleMessage> messages = regular_messages("rtd/tracking", 5);
  const io::Bytes a = recording_of(messages, {}, "rtd_msgs/msg/TrackingResult", "json");
  messages[3].payload[2] = 'X';
  const io::Bytes b = recording_of(messages, {}, "rtd_msgs/msg/TrackingResult", "json");
  const io::MemorySource source_a(a), source_b(b);
  RecordingDiff result = diff(contents_of(source_a), contents_of(source_b));
  explain(result, source_a, source_b);
  ASSERT_TRUE(result.topics[0].first);
  EXPECT_THAT(result.topics[0].first->why, Contains("first at byte 2 of the payload"));
}

TEST(RecordingDiff, two_runs_are_paired_by_frame_and_distinguished_by_their_times) {
  std::vector<SampleMessage> a, b;
  for (std::uint64_t i = 0; i < 20; ++i) {
    a.push_back({"rtd/tracking", 1000 + i, tracking_payload(i, 0.1, 50), 0});
    b.push_back({"rtd/tracking", 9000 + i, tracking_payload(i, i == 12 ? 0.2 : 0.1, 60), 0});
  }
  b.erase(b.begin() + 2);
  const RecordingDiff strict = compare(a, b, {}, "rtd_msgs/msg/TrackingResult");
  EXPECT_EQ(strict.topics[0].paired_by, PairedBy::kContent);
  EXPECT_EQ(strict.topics[0].payloads, 19U);
  EXPECT_EQ(strict.topics[0].run_fields_only, 18U);
  const RecordingDiff loose =
      compare(a, b, {.ignore_run_fields = true, .ignore_stamps = true}, "rtd_msgs/msg/TrackingResult");
  EXPECT_EQ(loose.topics[0].first->index_a, 12U);
  EXPECT_THAT(loose.topics[0].first->why, Contains("T_world_camera.translation_m:[0] 0.1 | 0.2"));
  b[11].payload = tracking_payload(12, 0.1, 60);
  a.erase(a.begin() + 2);
  EXPECT_TRUE(compare(a, b, {.ignore_run_fields = true, .ignore_stamps = true}, "rtd_msgs/msg/TrackingResult").equal());
}

TEST(Timing, reports_rate_median_and_the_gaps_of_a_channel) {
  const Timing timing = timing_of({0, 10, 20, 30, 60, 70, 95, 100});  // one period of 30, one of exactly 2.5 medians
  EXPECT_EQ(timing.messages, 8U);
  EXPECT_EQ(timing.median_period_ns, 10U);
  EXPECT_EQ(timing.largest_gap_ns, 30U);
  EXPECT_EQ(timing.largest_gap_at_ns, 30U);
  EXPECT_EQ(timing.gaps, 1U) << "2.5 medians are no gap yet";
  EXPECT_DOUBLE_EQ(timing.rate_hz, 7 * 1e9 / 100);
}

TEST(Timing, handles_no_message_one_and_many_at_one_time) {
  EXPECT_EQ(timing_of({}).messages, 0U);
  EXPECT_EQ(timing_of({5}).first_ns, 5U);
  EXPECT_EQ(timing_of({5}).rate_hz, 0);
  EXPECT_EQ(timing_of({5, 5, 5}).rate_hz, 0);
  EXPECT_EQ(timing_of({5, 5, 5}).gaps, 0U);
}

TEST(Timing, does_not_depend_on_the_order_in_the_file) {
  EXPECT_EQ(timing_of({20, 0, 10}).largest_gap_ns, 10U);
}

TEST(SequenceCount, counts_what_is_missing_and_writers_that_begin_again) {
  SequenceCount count;
  for (const std::uint32_t sequence : {4, 5, 8, 9}) count.add(sequence);
  EXPECT_EQ(count.missing(), 2U);
  for (const std::uint32_t sequence : {1, 2}) count.add(sequence);
  EXPECT_EQ(count.missing(), std::nullopt) << "several writers";
  EXPECT_EQ(count.gaps(), 1U);
  EXPECT_EQ(count.restarts(), 1U);
  EXPECT_TRUE(count.numbered());
}

TEST(SequenceCount, knows_a_recording_without_numbers) {
  SequenceCount count;
  for (int i = 0; i < 3; ++i) count.add(0);
  EXPECT_FALSE(count.numbered());
}

TEST(SharedCounter, is_recognised_by_numbers_that_only_all_channels_together_have) {
  EXPECT_EQ(missing_of_shared_counter({{1, 3, 5, 7}, {2, 4, 6}, {8}}), 0U);
  EXPECT_EQ(missing_of_shared_counter({{1, 3, 5, 9}, {2, 4, 6, 8}}), 1U) << "7 is lost";
  EXPECT_EQ(missing_of_shared_counter({{5, 3, 1}, {6, 2, 4}}), 0U) << "in any order";
}

TEST(SharedCounter, channels_that_count_for_themselves_are_distinguished) {
  EXPECT_EQ(missing_of_shared_counter({}), std::nullopt);
  EXPECT_EQ(missing_of_shared_counter({{1, 2, 5}}), std::nullopt) << "one channel";
  EXPECT_EQ(missing_of_shared_counter({{1, 2, 5}, {1, 2, 3}}), std::nullopt);
  EXPECT_EQ(missing_of_shared_counter({{1, 2, 3}, {5000, 5001, 5003}}), std::nullopt) << "an older writer";
  EXPECT_EQ(missing_of_shared_counter({{1, 2, 3}, {4, 5}}), std::nullopt) << "nothing is missing in either";
}

}  // namespace
}  // namespace rtd::recordings
