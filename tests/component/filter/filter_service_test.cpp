// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cstring>
#include <thread>

#include "common/bus/commands.hpp"
#include "common/service/load_step.hpp"
#include "common/service/metric_names.hpp"
#include "common/service/monotonic_clock.hpp"
#include "tests/component/filter/filter_service_fixture.hpp"
#include "tests/support/sanitizers.hpp"

namespace rtd::filter {
namespace {

using test_support::Inbox;

TEST_F(FilterServiceTest, pairs_each_frame_with_its_own_boxes) {
  start(service::Pace::kAsap, true);
  send_boxes(0, true);
  send_boxes(1, false);
  for (std::uint64_t seq = 0; seq < 2; ++seq) send_frame(seq);
  ASSERT_TRUE(answers_.wait_count(2));
  EXPECT_EQ(answers_.at(0)->detection_use, msg::DetectionUse::kExact);
  EXPECT_EQ(answers_.at(0)->objects, 1U);
  EXPECT_GT(answers_.at(0)->removed, 20U);
  EXPECT_EQ(answers_.at(1)->detection_use, msg::DetectionUse::kExact);
  EXPECT_EQ(answers_.at(1)->objects, 0U);
  EXPECT_EQ(answers_.at(1)->stamp_ns, stamp(1));
}

TEST_F(FilterServiceTest, changes_its_mode_by_command) {
  start(service::Pace::kAsap, true);
  bus::CommandClient client(bus_options_);
  send_boxes(0, true);
  send_frame(0);
  ASSERT_TRUE(answers_.wait_count(1));
  EXPECT_GT(answers_.at(0)->removed, 20U);
  EXPECT_EQ(client.call("filter/set_mode", "off", 20'000).message, "mode off from the next frame on, rtd before");
  send_boxes(1, true);
  send_frame(1);
  ASSERT_TRUE(answers_.wait_count(2));
  EXPECT_EQ(answers_.at(1)->removed, 0U);
  EXPECT_TRUE(wait_metric("mode.off", 1)) << "by its name";
  EXPECT_EQ(metric(*states_.all().back(), "mode.rtd"), std::nullopt) << "one mode at a time";
  const bus::CommandAnswer unknown = client.call("filter/set_mode", "magic", 20'000);
  EXPECT_FALSE(unknown.success);
  EXPECT_EQ(unknown.message,
            "'magic' is no mode of the filter: choose off, semantic, geometry, epipolar, rtd-paper, rtd");
}

TEST_F(FilterServiceTest, publishes_what_moves_while_there_is_a_subscriber) {
  Inbox<msg::Image> masks;
  receive(bus::topics::kDynamicMask, masks);
  start(service::Pace::kAsap, true);
  send_boxes(0, true);
  send_frame(0);
  ASSERT_TRUE(masks.wait_count(1));
  EXPECT_EQ(msg::to_ns(masks.at(0)->header.stamp), stamp(0));
  EXPECT_EQ(masks.at(0)->width, 160U);
  const cv::Rect block = test::MovingScene::block(0, 0);
  EXPECT_EQ(masks.at(0)->data.at(static_cast<std::size_t>(160 * (block.y / 4 + 2) + block.x / 4 + 2)), 255);
}

TEST_F(FilterServiceTest, publishes_objects_in_the_world_once_slam_has_said_where_the_camera_was) {
  Inbox<msg::Movers> movers;
  Inbox<msg::Detection3DArray> mover_boxes;
  Inbox<msg::MarkerArray> markers;
  receive(bus::topics::kMovers, movers);
  receive(bus::topics::kMoverBoxes, mover_boxes);
  receive(bus::topics::kMoverMarkers, markers);
  start(service::Pace::kLockstep, true);
  for (std::uint64_t seq = 0; seq < 3; ++seq) {
    send_boxes(seq, true);
    send_frame(seq);
    ASSERT_TRUE(answers_.wait_count(seq + 1));
    ASSERT_TRUE(movers.wait_count(seq)) << "the frame before";
    EXPECT_EQ(movers.all().size(), seq) << "too early";
    send_result(seq, 0);
  }
  const msg::Movers last = *movers.all().back();
  EXPECT_EQ(last.stamp_ns, stamp(last.seq));
  ASSERT_EQ(last.movers.size(), 1U);
  EXPECT_EQ(last.movers[0].class_name, "person");
  EXPECT_EQ(last.movers[0].id, movers.at(0)->movers.at(0).id);
  EXPECT_NEAR(last.movers[0].center_m[0], 0, 0.05) << "m";
  EXPECT_NEAR(last.movers[0].center_m[2], test::MovingScene::kBlockM, 0.15) << "m";
  EXPECT_NEAR(last.movers[0].velocity_mps[0], 0, 0.1) << "m/s";
  EXPECT_LT(last.movers[0].static_probability, 0.5F);
  EXPECT_GT(last.movers[0].covariance[0], 0);
  ASSERT_TRUE(mover_boxes.wait_count(movers.all().size()));
  const msg::Detection3DArray box = *mover_boxes.all().back();
  EXPECT_EQ(msg::to_ns(box.header.stamp), last.stamp_ns);
  EXPECT_EQ(box.header.frame_id, "map");
  ASSERT_EQ(box.detections.size(), 1U);
  EXPECT_EQ(box.detections[0].id, std::to_string(last.movers[0].id));
  EXPECT_EQ(box.detections[0].bbox.center.position.z, last.movers[0].center_m[2]);
  ASSERT_TRUE(markers.wait_count(movers.all().size()));
  EXPECT_EQ(markers.all().back()->markers.size(), 2U) << "box and name: what rests has no arrow";
}

TEST_F(FilterServiceTest, waits_for_boxes_that_arrive_late) {
  start(service::Pace::kAsap, true);
  send_frame(0);
  EXPECT_FALSE(answers_.wait_count(1, std::chrono::milliseconds(300))) << "answered without the boxes";
  send_boxes(0, true);
  ASSERT_TRUE(answers_.wait_count(1));
  EXPECT_EQ(answers_.at(0)->detection_use, msg::DetectionUse::kExact);
  EXPECT_GT(answers_.at(0)->stage_ms[msg::kStageWaitDetections], 100.0F) << "ms";
}

TEST_F(FilterServiceTest, waits_for_masks_when_the_detectors_heartbeat_says_that_they_come) {
  auto masks = bus_->writer(bus::topics::kPersonMasks);
  start(service::Pace::kAsap, true, {{service::metric::kMasks, 0}});
  send_boxes(0, true);
  send_frame(0);
  EXPECT_FALSE(answers_.wait_count(1, std::chrono::milliseconds(300))) << "answered without the masks";
  masks.write(masks_of(0));
  ASSERT_TRUE(answers_.wait_count(1));
  EXPECT_EQ(answers_.at(0)->detection_use, msg::DetectionUse::kExact);
  EXPECT_EQ(answers_.at(0)->objects, 1U);
}

TEST_F(FilterServiceTest, waits_for_the_masks_of_a_replay_which_says_nothing_of_them) {
  start(service::Pace::kLockstep, true);
  auto masks = bus_->writer(bus::topics::kPersonMasks);
  for (int i = 0; i < 500 && masks.matched() == 0; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  send_boxes(0, true);
  send_frame(0);
  EXPECT_FALSE(answers_.wait_count(1, std::chrono::milliseconds(300)));
  masks.write(masks_of(0));
  ASSERT_TRUE(answers_.wait_count(1));
  send_result(0, 0);
  send_boxes(1, true);
  send_frame(1);
  masks.write(masks_of(2));  // those of frame 1 are lost
  EXPECT_TRUE(answers_.wait_count(2)) << "later ones have come";
}

TEST_F(FilterServiceTest, waits_in_vain_for_masks_only_once) {
  config_.detections_timeout_ms = 500;
  start(service::Pace::kAsap, true, {{service::metric::kMasks, 0}});
  for (std::uint64_t seq = 0; seq < 3; ++seq) {
    send_boxes(seq, true);
    send_frame(seq);
    ASSERT_TRUE(answers_.wait_count(seq + 1));
    EXPECT_EQ(answers_.at(seq)->detection_use, msg::DetectionUse::kExact);
  }
  EXPECT_GT(answers_.at(0)->stage_ms[msg::kStageWaitDetections], 400.0F) << "ms";
  EXPECT_LT(answers_.at(2)->stage_ms[msg::kStageWaitDetections], 400.0F) << "ms";
}

TEST_F(FilterServiceTest, does_not_wait_for_masks_that_are_switched_off) {
  config_.person_masks = "off";
  start(service::Pace::kAsap, true, {{service::metric::kMasks, 0}});
  send_boxes(0, true);
  send_frame(0);
  EXPECT_TRUE(answers_.wait_count(1, std::chrono::milliseconds(2000)));
}

TEST_F(FilterServiceTest, never_waits_for_masks_in_realtime) {
  start(service::Pace::kRealtime, true, {{service::metric::kMasks, 0}});
  send_boxes(0, true);
  send_frame(0);
  EXPECT_TRUE(answers_.wait_count(1, std::chrono::milliseconds(2000)));
}

TEST_F(FilterServiceTest, broken_masks_leave_the_boxes) {
  start(service::Pace::kLockstep, true, {{service::metric::kMasks, 0}});
  auto masks = bus_->writer(bus::topics::kPersonMasks);
  auto expect_boxes_alone = [&, seq = std::uint64_t{0}](auto spoil) mutable {
    msg::Image message = masks_of(seq);
    spoil(message);
    send_boxes(seq, true);
    masks.write(message);
    send_frame(seq);
    ASSERT_TRUE(answers_.wait_count(seq + 1));
    EXPECT_EQ(answers_.at(seq)->detection_use, msg::DetectionUse::kExact);
    EXPECT_EQ(answers_.at(seq)->objects, 1U);
    send_result(seq, 0);
    ++seq;
  };
  expect_boxes_alone([](msg::Image& message) { message.encoding = "16UC1"; });
  expect_boxes_alone([](msg::Image& message) { message.data.assign(message.data.size(), 9); });
  expect_boxes_alone([](msg::Image& message) {
    message.width = message.step = 80;
    message.data.resize(std::size_t{80} * 120);
  });
}

TEST_F(FilterServiceTest, carries_the_newest_boxes_in_realtime_and_does_not_wait) {
  start(service::Pace::kRealtime, true);
  send_frame(0);
  ASSERT_TRUE(answers_.wait_count(1));
  EXPECT_EQ(answers_.at(0)->detection_use, msg::DetectionUse::kNone);
  send_boxes(0, true);
  send_frame(3);
  ASSERT_TRUE(answers_.wait_count(2));
  EXPECT_EQ(answers_.at(1)->detection_use, msg::DetectionUse::kCarried);
  EXPECT_EQ(answers_.at(1)->objects, 1U);
  send_frame(60);  // the boxes are two seconds old
  ASSERT_TRUE(answers_.wait_count(3));
  EXPECT_EQ(answers_.at(2)->detection_use, msg::DetectionUse::kNone);
}

TEST_F(FilterServiceTest, sheds_load_while_poses_come_late_in_realtime_and_takes_it_back) {
  start(service::Pace::kRealtime, true);
  std::uint64_t seq = 0;
  const auto send = [&](int frames, std::int64_t latency_ns) {
    std::size_t features = 0;
    for (int i = 0; i < frames; ++i, ++seq) {
      send_frame(seq);
      if (!answers_.wait_count(seq + 1)) return features;
      features = answers_.at(seq)->count;
      send_result(seq, 0, latency_ns);
    }
    return features;
  };
  const std::size_t all = send(10, 20'000'000);
  ASSERT_GT(all, 200U);
  const std::size_t fewer = send(150, 150'000'000);
  EXPECT_LT(fewer, all * 6 / 10) << "35 %";
  EXPECT_TRUE(wait_metric(service::metric::kLoadStep, 4));
  EXPECT_TRUE(wait_state(msg::ServiceState::kRunning, "computer too slow or busy: 35 % of the features"));
  if (test_support::kSanitized) GTEST_SKIP() << test_support::kTooSlow;
  const std::int64_t since_ns = service::monotonic_ns();
  while (service::monotonic_ns() - since_ns < 8'000'000'000) send(1, 20'000'000);
  EXPECT_TRUE(states_.wait([](const auto& states) {
    return metric(*states.back(), service::metric::kLoadStep).value_or(9) <= 2;
  })) << "a step after each 3 s";
}

TEST_F(FilterServiceTest, never_sheds_load_when_switched_off) {
  config_.shed_load = false;
  start(service::Pace::kRealtime, true);
  for (std::uint64_t seq = 0; seq < 30; ++seq) {
    send_frame(seq);
    ASSERT_TRUE(answers_.wait_count(seq + 1));
    send_result(seq, 0, 150'000'000);
  }
  EXPECT_EQ(metric(*states_.all().back(), service::metric::kLoadStep), std::nullopt);
}

TEST_F(FilterServiceTest, waits_in_lockstep_for_slam_and_its_keyframes) {
  start(service::Pace::kLockstep, false);
  send_frame(0);
  ASSERT_TRUE(answers_.wait_count(1));
  send_frame(1);
  send_result(0, 1);
  EXPECT_FALSE(answers_.wait_count(2, std::chrono::milliseconds(300))) << "a keyframe event is still missing";
  msg::KeyframeEvent event{};
  event.T_world_camera.rotation_xyzw = {0, 0, 0, 1};
  events_.write(event);
  EXPECT_TRUE(answers_.wait_count(2));
}

TEST_F(FilterServiceTest, gives_a_repeated_frame_the_same_features) {
  start(service::Pace::kLockstep, false);
  for (int i = 0; i < 3; ++i) send_frame(0);
  ASSERT_TRUE(answers_.wait_count(3));
  EXPECT_EQ(std::memcmp(answers_.at(0).get(), answers_.at(2).get(), sizeof(msg::FeatureFrame)), 0);
}

TEST_F(FilterServiceTest, frames_in_flight_that_come_again_are_not_taken_for_time_that_goes_back) {
  start(service::Pace::kAsap, false);
  for (const std::uint64_t seq : {0U, 1U, 3U, 4U}) send_frame(seq);
  ASSERT_TRUE(answers_.wait_count(4));
  for (const std::uint64_t seq : {2U, 3U, 4U, 5U}) send_frame(seq);
  ASSERT_TRUE(answers_.wait_count(7));
  EXPECT_EQ(std::memcmp(answers_.at(2).get(), answers_.at(4).get(), sizeof(msg::FeatureFrame)), 0);
  EXPECT_EQ(std::memcmp(answers_.at(3).get(), answers_.at(5).get(), sizeof(msg::FeatureFrame)), 0);
  EXPECT_EQ(answers_.at(6)->seq, 5U) << "the late frame 2 is left out";
}

TEST_F(FilterServiceTest, a_frame_of_impossible_size_is_refused_and_counted) {
  start(service::Pace::kLockstep, false);
  *frame_ = {};
  frame_->width = 100'000;
  frame_->height = 3;
  frames_.write(*frame_);
  EXPECT_TRUE(wait_metric("topic.rtd/frame.implausible", 1));
  send_frame(1);
  ASSERT_TRUE(answers_.wait_count(1));
  EXPECT_GT(answers_.at(0)->count, 500U);
}

TEST_F(FilterServiceTest, keeps_to_the_first_of_two_cameras) {
  start(service::Pace::kAsap, false);
  auto other = other_camera();
  send_frame(0);
  ASSERT_TRUE(answers_.wait_count(1));
  send_frame(0, other);  // with the first one's source_id
  send_frame(1, other);
  send_frame(1);
  ASSERT_TRUE(answers_.wait_count(2));
  EXPECT_EQ(answers_.at(1)->seq, 1U);
  EXPECT_TRUE(wait_metric("frames_from_others", 2));
}

TEST_F(FilterServiceTest, a_camera_that_stutters_keeps_its_place) {
  start(service::Pace::kAsap, false);
  auto other = other_camera();
  for (const std::uint64_t seq : {0U, 1U, 2U}) send_frame(seq);
  ASSERT_TRUE(answers_.wait_count(3));
  for (int i = 0; i < 8; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(150));
    send_frame(100, other);
  }
  send_frame(3);
  ASSERT_TRUE(answers_.wait_count(4));
  EXPECT_EQ(answers_.at(3)->seq, 3U);
}

TEST_F(FilterServiceTest, results_of_a_second_slam_are_not_taken) {
  config_.feedback_timeout_ms = 300;
  start(service::Pace::kLockstep, false);
  const auto elsewhere = bus::connect(bus_options_);
  auto forged = elsewhere->writer(bus::topics::kTracking);
  send_frame(0);
  ASSERT_TRUE(answers_.wait_count(1));
  send_result(0, 0);
  send_frame(1);
  ASSERT_TRUE(answers_.wait_count(2));
  msg::TrackingResult result{};
  result.published_ns = result.finished_ns = 1;
  result.seq = 1;
  result.state = msg::TrackingState::kOk;
  result.T_world_camera.rotation_xyzw = {0, 0, 0, 1};
  forged.write(result);
  const std::int64_t asked_ns = service::monotonic_ns();
  send_frame(2);
  ASSERT_TRUE(answers_.wait_count(3));
  EXPECT_GE(service::monotonic_ns() - asked_ns, 290'000'000) << "waited for the result of the slam that it knows";
}

TEST_F(FilterServiceTest, follows_the_successor_of_a_camera_that_ended_at_once) {
  start(service::Pace::kAsap, false);
  for (const std::uint64_t seq : {0U, 1U, 2U}) send_frame(seq);
  ASSERT_TRUE(answers_.wait_count(3));
  auto other = other_camera();
  frames_ = {};
  send_frame(0, other);
  ASSERT_TRUE(answers_.wait_count(4));
  EXPECT_EQ(answers_.at(3)->seq, 0U);
}

TEST_F(FilterServiceTest, accepts_time_that_goes_backwards) {
  start(service::Pace::kAsap, false);
  for (const std::uint64_t seq : {10U, 11U, 2U, 3U}) send_frame(seq);
  ASSERT_TRUE(answers_.wait_count(4));
  EXPECT_EQ(answers_.at(3)->seq, 3U);
}

TEST_F(FilterServiceTest, ends_within_a_second_while_it_waits) {
  start(service::Pace::kLockstep, true);
  send_frame(0);
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  const std::int64_t asked_ns = service::monotonic_ns();
  EXPECT_EQ(stop(), service::kOk);
  EXPECT_LT(service::monotonic_ns() - asked_ns, 1'000'000'000);
}

TEST_F(FilterServiceTest, refuses_a_motion_level_that_does_not_exist) {
  config_.core.motion_levels = {{"dog", "fast"}};
  service::Heartbeat heartbeat(*bus_, "filter", stop_);
  service::Runtime runtime{*bus_, heartbeat, stop_, service::Pace::kAsap};
  EXPECT_THAT([&] { const FilterService service(config_, runtime); },
              testing::ThrowsMessage<service::ConfigError>(testing::HasSubstr("dog")));
}

TEST_F(FilterServiceTest, a_silent_imu_is_named_and_delays_no_frame) {
  config_.imu = "/camera/imu";
  start(service::Pace::kAsap, false);
  for (std::uint64_t seq = 0; seq < 3; ++seq) send_frame(seq);
  ASSERT_TRUE(answers_.wait_count(3));
  EXPECT_TRUE(wait_state(msg::ServiceState::kRunning, "no message on /camera/imu"));
}

}  // namespace
}  // namespace rtd::filter
