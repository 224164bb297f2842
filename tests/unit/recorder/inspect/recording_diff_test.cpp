// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/recorder/inspect/recording_diff.hpp"

#include <gmock/gmock.h>

#include <cstring>

#include "common/msg/tracking.hpp"
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

}  // namespace
}  // namespace rtd::recordings
