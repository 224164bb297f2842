// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "services/launcher/core/run/record_builder.hpp"
#include "services/launcher/run/run_command.hpp"
#include "tests/unit/launcher/run_messages.hpp"

namespace rtd::launcher {
namespace {

using namespace ::testing;

run_record::RunRecord run_of(std::uint64_t frames_in, std::uint64_t left_out) {
  run_record::RunRecord record;
  record.frames_in = frames_in;
  record.frames_left_out = left_out;
  return record;
}

TEST(WhyNotUsed, names_the_commonest_reason_its_remedy_and_an_example) {
  run_record::RunRecord record = run_of(4, 5);
  record.left_out = {{"stamp_backwards", 4}, {"malformed_line", 1}};
  const std::string why = why_not_used(record, "rgb/3.jpg is older than the frame before");
  EXPECT_THAT(why, StartsWith("only 4 of 9 frames were used; 4 x stamp_backwards: stamps are older than those before"));
  EXPECT_THAT(why, HasSubstr("give each frame its time in seconds"));
  EXPECT_THAT(why, HasSubstr("(first left out: rgb/3.jpg is older than the frame before)"));
}

TEST(WhyNotUsed, has_nothing_to_say_when_nine_of_ten_frames_were_used) {
  EXPECT_THAT(why_not_used(run_of(9, 1), ""), IsEmpty());
  EXPECT_THAT(why_not_used(run_of(0, 0), ""), IsEmpty());
}

TEST(WhyNotUsed, names_causes_behind_the_source_too) {
  run_record::RunRecord record = run_of(10, 0);
  record.frames_out_of_range = 9;
  EXPECT_THAT(why_not_used(record, ""), HasSubstr("9 x out_of_range: no pixel has a depth between 0.1 and 20 m"));
  record = run_of(20, 0);
  record.frames_not_played = 80;
  EXPECT_THAT(why_not_used(record, ""), StartsWith("only 20 of 100 frames were used; 80 x not_played: the run ended"));
  record = run_of(10, 0);
  record.frames_dropped = 8;
  record.drops["camera.late"] = 7;
  EXPECT_THAT(why_not_used(record, ""), HasSubstr("7 x late: they came too late for pace realtime: --pace lockstep"));
  record.drops["camera.late"] = 1;
  EXPECT_THAT(why_not_used(record, ""), HasSubstr("7 x without_answer: slam gave no result"));
}

TEST(WhyNotUsed, frames_that_a_service_took_with_it_are_its_fault_however_few) {
  run_record::RunRecord record = run_of(200, 0);
  record.processes["camera"] = {.restarts = 5, .deaths = 5, .died = "died: killed by signal 9 (SIGKILL)"};
  EXPECT_FALSE(died_with_frames(record)) << "it continued where it was";
  EXPECT_THAT(why_not_used(record, ""), IsEmpty());
  record.frames_dropped = record.drops["camera.late"] = 12;
  EXPECT_TRUE(died_with_frames(record));
  EXPECT_EQ(why_not_used(record, ""),
            "only 188 of 200 frames were used: camera died: killed by signal 9 (SIGKILL) (5 times)");
  record.processes["detector"] = record.processes["camera"];
  record.processes.erase("camera");
  EXPECT_FALSE(died_with_frames(record)) << "a frame needs no detector";
}

TEST(WhyNotUsed, a_second_camera_on_the_topic_is_named_however_few_its_images) {
  run_record::RunRecord record = run_of(198, 2);
  EXPECT_FALSE(is_partial(record));
  record.left_out = {{"other_camera", 2}};
  EXPECT_TRUE(is_partial(record));
  EXPECT_THAT(why_not_used(record, ""), HasSubstr("2 x other_camera: two cameras send on one topic"));
}

TEST(WhyNotUsed, what_a_running_camera_did_not_give_while_it_was_dead_is_missing) {
  run_record::RunRecord record = run_of(200, 0);
  record.processes["camera"] = {.restarts = 1, .deaths = 1, .died = "died: exit code 1"};
  record.source = "ros2:/color,/depth";
  EXPECT_TRUE(died_with_frames(record));
}

std::vector<run_record::SampleFrame> run_samples(SampleKeeper& keeper, std::uint64_t frames) {
  for (std::uint64_t seq = 0; seq < frames; ++seq) {
    if (keeper.wants(seq)) keeper.add_image(seq, {1, 2, 3});
    keeper.add_features(seq, *features_of(seq));
  }
  return keeper.samples();
}

TEST(sample_keeper, spreads_the_wanted_number_over_a_known_length) {
  SampleKeeper keeper(12, 210);
  const auto samples = run_samples(keeper, 210);
  ASSERT_EQ(samples.size(), 12U);
  EXPECT_EQ(samples[0].seq, 0U);
  EXPECT_EQ(samples[11].seq, 198U);
  EXPECT_EQ(samples[3].features.size(), 3U);
}

TEST(sample_keeper, keeps_where_the_static_points_are) {
  SampleKeeper keeper(1, 1);
  auto features = *features_of(0);
  features.intrinsics = {500, 400, 320, 240};
  for (std::size_t i = 0; i < 3; ++i) features.features[i] = {.u_px = 420, .v_px = 140, .u_raw_px = 9, .depth_m = 2};
  features.features[1].flags = msg::kFeatureRemoved;
  features.features[2].depth_m = 0;
  keeper.add_image(0, {1});
  keeper.add_features(0, features);
  const std::vector<run_record::SeenPoint> points = keeper.samples().at(0).points;
  ASSERT_EQ(points.size(), 1U);
  EXPECT_EQ(points[0].u_raw_px, 9);
  EXPECT_THAT(points[0].p_camera_m, ElementsAre(0.4F, -0.5F, 2));
}

TEST(sample_keeper, stays_even_and_bounded_over_an_unknown_length) {
  SampleKeeper keeper(12);
  const auto samples = run_samples(keeper, 5000);
  ASSERT_GE(samples.size(), 10U);
  ASSERT_LE(samples.size(), 12U);
  EXPECT_GT(samples.back().seq, 4000U);
  for (std::size_t i = 1; i < samples.size(); ++i) EXPECT_LT(samples[i].seq - samples[i - 1].seq, 1100U);
}

TEST(sample_keeper, finds_the_frame_of_masks_by_its_stamp) {
  SampleKeeper keeper(12, 24);
  keeper.expect_masks(4, 400);
  keeper.add_masks(500, {1, 1, {2}});  // of a frame that is not kept
  keeper.add_masks(400, {1, 1, {1}});
  keeper.add_image(4, {1});
  keeper.add_features(4, *features_of(4));
  ASSERT_EQ(keeper.samples().size(), 1U);
  EXPECT_THAT(keeper.samples()[0].masks.labels, ElementsAre(1));
}

TEST(sample_keeper, needs_picture_and_features) {
  SampleKeeper keeper(12, 24);
  keeper.add_image(0, {1});
  keeper.add_features(2, *features_of(2));
  keeper.add_image(4, {1});
  keeper.add_features(4, *features_of(4));
  EXPECT_THAT(keeper.samples(), ElementsAre(Field(&run_record::SampleFrame::seq, 4)));
}

TEST(sample_keeper, believes_no_count_beyond_the_message) {
  SampleKeeper keeper;
  keeper.add_image(0, {1});
  keeper.add_features(0, *features_of(0, 4'000'000'000U));
  EXPECT_EQ(keeper.samples().at(0).features.size(), msg::kMaxFeatures);
}

}  // namespace
}  // namespace rtd::launcher
