// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/launcher/core/run/record_builder.hpp"

#include <gmock/gmock.h>
#include <malloc.h>

#include <limits>

#include "services/launcher/process/frame_file.hpp"
#include "tests/support/frame_list.hpp"
#include "tests/support/sanitizers.hpp"
#include "tests/unit/launcher/run_messages.hpp"

namespace rtd::launcher {
namespace {

using testing::ElementsAre;
using testing::Pair;
using testing::UnorderedElementsAre;

std::vector<std::uint64_t> seqs(const run_record::RunRecord& record) {
  std::vector<std::uint64_t> result;
  for (const run_record::FrameRecord& frame : record.frames) result.push_back(frame.tracking.seq);
  return result;
}

class record_builder : public testing::Test {
 protected:
  run_record::RunRecord filled() {
    run_record::RunRecord record;
    builder.fill(record);
    return record;
  }

  FrameList store;
  RecordBuilder builder{store};
};

TEST_F(record_builder, joins_both_streams_by_seq_in_any_order) {
  builder.add(result_of(1));
  builder.add(*features_of(1));
  builder.add(*features_of(0));
  builder.add(result_of(0));
  const run_record::RunRecord record = filled();
  ASSERT_THAT(seqs(record), ElementsAre(0, 1));
  EXPECT_EQ(record.frames[1].tracking.inliers, 101U);
  EXPECT_FLOAT_EQ(record.frames[0].filter_stage_ms[msg::kStageExtract], 7.0F);
  EXPECT_EQ(record.frames_in, 2U);
  EXPECT_EQ(record.frames_dropped, 0U);
}

TEST_F(record_builder, counts_frames_without_result_as_dropped) {
  builder.add(result_of(0));
  builder.add(*features_of(1));
  builder.add(result_of(4));
  const run_record::RunRecord record = filled();
  EXPECT_THAT(seqs(record), ElementsAre(0, 4));
  EXPECT_EQ(record.frames_in, 5U);
  EXPECT_EQ(record.frames_dropped, 3U);
}

TEST_F(record_builder, the_cameras_own_count_wins_when_it_saw_more) {
  builder.add(result_of(0));
  builder.add(status_of("camera", 7, {{"frames_in", 10}}));
  const run_record::RunRecord record = filled();
  EXPECT_EQ(record.frames_in, 10U);
  EXPECT_EQ(record.frames_dropped, 9U);
}

TEST_F(record_builder, the_first_answer_counts_when_a_frame_was_sent_again) {
  builder.add(result_of(0));
  msg::TrackingResult again = result_of(0);
  again.finished_ns += 2000 * kMs;
  builder.add(again);
  const run_record::RunRecord record = filled();
  ASSERT_EQ(record.frames.size(), 1U);
  EXPECT_EQ(record.frames[0].tracking.finished_ns, 20 * kMs);
}

TEST_F(record_builder, drops_are_named_by_place_and_survive_a_restart) {
  builder.add(status_of("filter", 7, {{"queue_dropped", 4}, {"frames_processed", 90}}));
  builder.add(status_of("filter", 8, {{"queue_dropped", 1}}));
  builder.add(status_of("filter", 8, {{"queue_dropped", 2}}));
  builder.add(status_of("camera", 9, {{"frames_late", 3}, {"frames_skipped", 0}}));
  const run_record::RunRecord record = filled();
  EXPECT_THAT(record.drops,
              UnorderedElementsAre(Pair("filter.queue_dropped", 6), Pair("camera.late", 3), Pair("camera.skipped", 0)));
  EXPECT_EQ(builder.live().dropped, 9U);
  builder.add(status_of("detector", 10, {{"frames_dropped", 100}}));
  EXPECT_EQ(builder.live().dropped, 9U) << "the detector only ever looks at the newest frame";
}

TEST_F(record_builder, a_restarted_camera_counts_its_frames_on) {
  builder.add(status_of("camera", 7, {{"frames_in", 3}, {"frames_late", 1}}));
  for (const std::uint64_t seq : {0, 1, 2}) builder.add(result_of(seq));
  builder.add(status_of("camera", 8, {{"frames_late", 1}}));
  EXPECT_EQ(builder.frames_in(), 3U);
  for (const std::uint64_t seq : {2, 5}) builder.add(result_of(seq));
  builder.add(status_of("camera", 8, {{"frames_in", 7}, {"frames_late", 2}}));
  const run_record::RunRecord record = filled();
  EXPECT_THAT(seqs(record), ElementsAre(0, 1, 2, 5));
  EXPECT_EQ(record.frames_in, 7U);
  EXPECT_EQ(record.frames_dropped, 3U);
  EXPECT_EQ(record.drops.at("camera.late"), 3);
}

TEST_F(record_builder, knows_where_a_camera_stopped) {
  EXPECT_FALSE(builder.last_seen() || builder.last_answered());
  builder.add(result_of(3));
  builder.add(*features_of(4));
  msg::FrameView frame;
  frame.seq = 5;
  frame.stamp_ns = 55;
  builder.add(frame);
  builder.add(result_of(2));
  EXPECT_EQ(builder.last_answered()->seq, 3U);
  EXPECT_EQ(builder.last_answered()->published_ns, result_of(3).published_ns);
  EXPECT_EQ(builder.last_seen()->seq, 5U);
  EXPECT_EQ(builder.last_seen()->stamp_ns, 55);
}

TEST_F(record_builder, knows_whether_anything_was_tracked) {
  EXPECT_FALSE(builder.live().tracking);
  builder.add(result_of(0, msg::TrackingState::kLost));
  EXPECT_FALSE(builder.tracked_any());
  EXPECT_TRUE(builder.live().tracking);
  builder.add(result_of(1));
  EXPECT_TRUE(builder.tracked_any());
}

TEST_F(record_builder, live_status_follows_the_newest_frame) {
  for (std::uint64_t seq = 0; seq < 60; ++seq) builder.add(result_of(seq));
  const LiveStatus status = builder.live();
  EXPECT_EQ(status.frames, 60U);
  EXPECT_EQ(status.inliers, 159U);
  EXPECT_NEAR(status.frames_per_s, 1000.0 / 33.0, 1e-9);
  EXPECT_DOUBLE_EQ(status.latency_ms, 20.0);
}

TEST_F(record_builder, reports_a_dead_peer_once_until_it_is_received_again) {
  msg::ServiceStatus filter{.service = "filter"}, slam{.service = "slam"};
  filter.metrics = slam.metrics = {{"peer.detector.dead", 1}};
  builder.add(filter);
  builder.add(slam);
  EXPECT_EQ(builder.take_notice(), "detector is dead: no heartbeat");
  EXPECT_EQ(builder.take_notice(), std::nullopt);

  builder.add(msg::ServiceStatus{.service = "detector"});
  builder.add(filter);
  EXPECT_EQ(builder.take_notice(), "detector is dead: no heartbeat") << "again";
}

TEST_F(record_builder, reports_troubles_once_by_service_and_topic) {
  for (const std::string trouble : {"incompatible_qos", "implausible"}) {
    for (const double times : {1.0, 900.0})
      builder.add(status_of("slam", 7, {{"topic.rtd/features." + trouble, times}}));
    EXPECT_EQ(builder.take_notice(), "slam: rtd/features: " + trouble);
    EXPECT_EQ(builder.take_notice(), std::nullopt);
  }
}

TEST_F(record_builder, reports_a_degraded_service_once) {
  msg::ServiceStatus status = status_of("filter", 7, {});
  status.state = msg::ServiceState::kDegraded;
  status.message = "detector gone, geometry only";
  builder.add(status);
  builder.add(status);
  EXPECT_EQ(builder.take_notice(), "filter: detector gone, geometry only");
  EXPECT_EQ(builder.take_notice(), std::nullopt);
}

TEST_F(record_builder, groups_notices_that_differ_in_their_numbers) {
  for (std::uint64_t seq = 0; seq < 67; ++seq) {
    builder.add(result_of(seq));
    msg::ServiceStatus status = status_of("slam", 7, {});
    status.state = msg::ServiceState::kDegraded;
    status.message = seq % 2 == 0 ? "doubtful: only 42 % agree" : "doubtful: only 43 % agree";
    builder.add(status);
  }
  EXPECT_EQ(builder.take_notice(), "slam: doubtful: only 42 % agree");
  EXPECT_EQ(builder.take_notice(), std::nullopt);
  EXPECT_THAT(builder.repeated_notices(),
              testing::ElementsAre("slam: doubtful: only 42 % agree (67 times, from frame 1 to 67)"));
}

TEST_F(record_builder, names_the_services_that_report_and_have_not_finished) {
  EXPECT_EQ(builder.active_services(), "");
  builder.add(status_of("slam", 8, {}));
  builder.add(status_of("filter", 7, {}));
  msg::ServiceStatus finished = status_of("camera", 9, {});
  finished.state = msg::ServiceState::kFinished;
  builder.add(finished);
  builder.add(status_of("record", 10, {}));
  EXPECT_EQ(builder.active_services(), "filter (pid 7), slam (pid 8)") << "a recorder disturbs no run";
  builder.add(status_of("detector_box", 12, {}));
  builder.add(status_of("link", 13, {}));
  builder.add(status_of("atlas", 14, {}));
  EXPECT_EQ(builder.active_services(), "filter (pid 7), slam (pid 8)") << "it says itself whom it serves";
  builder.add(status_of("detector", 11, {}));
  EXPECT_EQ(builder.active_services(), "detector (pid 11), filter (pid 7), slam (pid 8)");
  EXPECT_EQ(builder.active_services({.detector = true}), "filter (pid 7), slam (pid 8)")
      << "the detector of another host is expected";
}

TEST_F(record_builder, tolerates_a_replay_that_plays_no_topic_of_a_run) {
  const Tolerated live{.harmless_replay = true}, at_first{.harmless_replay = true, .silent_replay = true};
  builder.add(status_of("replay", 7, {}));
  EXPECT_EQ(builder.active_services(at_first), "") << "it may still report what it plays";
  EXPECT_EQ(builder.active_services(live), "replay (pid 7)");
  builder.add(status_of("replay", 7, {{"run_topics", 0}}));
  EXPECT_EQ(builder.active_services(live), "");
  EXPECT_EQ(builder.active_services(), "replay (pid 7)") << "the source of the run is not live";
  builder.add(status_of("replay", 7, {{"run_topics", 2}}));
  EXPECT_EQ(builder.active_services(at_first), "replay (pid 7)");
}

TEST_F(record_builder, knows_the_clocks_of_other_hosts_from_slam) {
  builder.add(status_of("slam", 8, {{"clock.detector.offset_ms", 250.5}, {"clock.detector.round_trip_ms", 0.75}}));
  builder.add(status_of("detector", 9, {{"clock.slam.offset_ms", -250.5}, {"clock.slam.round_trip_ms", 0.75}}));
  const run_record::RunRecord record = filled();
  ASSERT_EQ(record.clocks.size(), 1u);
  EXPECT_EQ(record.clocks[0].service, "detector");
  EXPECT_EQ(record.clocks[0].offset_ms, 250.5);
  EXPECT_EQ(record.clocks[0].round_trip_ms, 0.75);
}

TEST_F(record_builder, keeps_the_frames_of_a_long_run_in_the_store_in_their_order) {
  constexpr std::uint64_t kFrames = 3 * RecordBuilder::kJoined;
  for (std::uint64_t seq = 0; seq < kFrames; seq += 2) {
    builder.add(result_of(seq + 1));  // out of order
    builder.add(result_of(seq));
  }
  EXPECT_EQ(store.frames.size(), kFrames - RecordBuilder::kJoined);
  builder.add(result_of(3, msg::TrackingState::kLost));  // an answer to a frame that was sent again
  const run_record::RunRecord record = filled();
  ASSERT_EQ(record.frames.size(), kFrames);
  for (std::uint64_t seq = 0; seq < kFrames; ++seq) ASSERT_EQ(record.frames[seq].tracking.seq, seq);
  EXPECT_EQ(record.frames[3].tracking.state, msg::TrackingState::kOk);
  EXPECT_EQ(record.frames_dropped, 0U);
}

TEST_F(record_builder, says_once_that_frames_could_not_be_kept) {
  store.room = 10;
  for (std::uint64_t seq = 0; seq < 2 * RecordBuilder::kJoined; ++seq) builder.add(result_of(seq));
  EXPECT_EQ(builder.frames_not_kept(), RecordBuilder::kJoined - 10);
  EXPECT_THAT(builder.take_notice(), testing::Optional(testing::HasSubstr("the disk is full")));
  EXPECT_EQ(builder.take_notice(), std::nullopt);
}

TEST_F(record_builder, ignores_a_forged_number_and_reports_it) {
  builder.add(result_of(0));
  builder.add(result_of(UINT64_MAX - 1));
  builder.add(*features_of(RecordBuilder::kFarthestAhead + 1));
  builder.add(result_of(1));
  EXPECT_EQ(builder.frames_in(), 2U);
  EXPECT_THAT(builder.take_notice(), testing::Optional(testing::HasSubstr("claims to be number 18446744073709551614")));
  EXPECT_EQ(builder.take_notice(), std::nullopt);
}

TEST_F(record_builder, frames_behind_the_end_of_the_source_do_not_count) {
  msg::ServiceStatus camera = status_of("camera", 7, {{"frames_in", 3}});
  builder.add(camera);
  builder.add(result_of(0));
  builder.add(result_of(3));  // of another camera, which the services follow already
  camera.state = msg::ServiceState::kFinished;
  builder.add(camera);
  builder.add(result_of(4));
  builder.add(result_of(2));
  const run_record::RunRecord record = filled();
  EXPECT_THAT(seqs(record), ElementsAre(0, 2));
  EXPECT_EQ(record.frames_in, 3U);
}

TEST_F(record_builder, a_forged_first_number_counts_no_frames) {
  builder.add(result_of(UINT64_MAX));
  EXPECT_EQ(builder.frames_in(), 0U);
}

TEST(record_builders, counters_that_claim_too_much_saturate) {
  for (const double claimed : {1e300, -5.0, std::numeric_limits<double>::quiet_NaN()}) {
    FrameList store;
    RecordBuilder builder(store);
    builder.add(status_of("camera", 7, {{"frames_in", claimed}, {"frames_late", claimed}}));
    EXPECT_LE(builder.frames_in(), std::uint64_t{1} << 53U);
  }
}

TEST_F(record_builder, losses_of_topics_without_frames_are_no_lost_frames) {
  builder.add(status_of("dense", 1, {{"topic.rtd/status.lost", 779}, {"topic.rtd/frame.lost", 2}}));
  const run_record::RunRecord record = filled();
  EXPECT_THAT(record.drops, ElementsAre(testing::Pair("dense.topic.rtd/frame.lost", 2)));
}

TEST_F(record_builder, made_up_services_counters_and_troubles_have_a_largest_number) {
  builder.add(status_of("slam", 1, {{"frames_lost", 1}}));
  for (int i = 0; i < 20'000; ++i) {
    const std::string name = "forged" + std::to_string(i);
    builder.add(status_of(name, i, {{"x_lost", 1}}));
    msg::ServiceStatus forged = status_of("slam", 1, {{name + "_lost", 1}, {"peer." + name + ".dead", 1}});
    forged.state = msg::ServiceState::kDegraded;
    forged.message = name;
    builder.add(forged);
  }
  std::size_t notices = 0;
  while (builder.take_notice()) ++notices;
  EXPECT_EQ(notices, RecordBuilder::kMaxNotices);
  const run_record::RunRecord record = filled();
  EXPECT_LE(record.drops.size(), RecordBuilder::kMaxServices + RecordBuilder::kMaxCounters);
  EXPECT_EQ(record.drops.at("slam.lost"), 1.0) << "the real counter stays";
}

/// Bytes that are allocated now.
std::size_t allocated() {
  const struct mallinfo2 info = mallinfo2();
  return info.uordblks + info.hblkhd;
}

TEST(record_builders, memory_is_level_after_five_minutes_of_an_hour_at_30_hz) {
  if (test_support::kSanitized) GTEST_SKIP() << "sanitizers count their own memory";
  const std::string folder = testing::TempDir();
  FrameFile store(folder);
  RecordBuilder builder(store);
  SampleKeeper samples;
  constexpr std::uint64_t kFrames = 3600 * 30, kSettled = 300 * 30;
  std::size_t after_five_minutes = 0;
  const auto features = features_of(0);
  for (std::uint64_t seq = 0; seq < kFrames; ++seq) {
    features->seq = seq;
    builder.add(*features);
    builder.add(result_of(seq));
    samples.add_features(seq, *features);
    if (samples.wants(seq)) samples.add_image(seq, std::vector<std::uint8_t>(50'000));
    if (seq % 6 == 0) builder.add(status_of("slam", 1, {{"frames_tracked", static_cast<double>(seq)}}));
    if (seq == kSettled) after_five_minutes = allocated();
  }
  EXPECT_LT(allocated(), after_five_minutes + 5'000'000);
  run_record::RunRecord record;
  builder.fill(record);
  ASSERT_EQ(record.frames.size(), kFrames) << "nothing is missing in the report";
  EXPECT_EQ(record.frames[kFrames - 1].tracking.inliers, 100 + kFrames - 1);
}

}  // namespace
}  // namespace rtd::launcher
