// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <malloc.h>

#include <array>
#include <cstring>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>

#include "services/viewer/core/page_messages.hpp"
#include "services/viewer/core/robot_mirror.hpp"
#include "services/viewer/robot_feed.hpp"
#include "tests/support/sanitizers.hpp"

namespace rtd::viewer {
namespace {

using nlohmann::json;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

json text(const Payload& payload) {
  return json::parse(reinterpret_cast<const char*>(payload->data()),
                     reinterpret_cast<const char*>(payload->data()) + payload->size());
}

template <class T>
T at(const Payload& payload, std::size_t position) {
  T value;
  std::memcpy(&value, payload->data() + position, sizeof(T));
  return value;
}

msg::Time stamp(std::int64_t ms) {
  return {static_cast<std::int32_t>(ms / 1000), static_cast<std::uint32_t>(ms % 1000) * 1'000'000U};
}

std::unique_ptr<msg::FeatureFrame> features(std::int64_t ms) {
  auto frame = std::make_unique<msg::FeatureFrame>();
  frame->stamp_ns = ms * 1'000'000;
  frame->count = 2;
  frame->width = 640;
  frame->height = 480;
  frame->features[1] = {.u_raw_px = 10.5F, .v_raw_px = 20, .static_probability = 1, .flags = msg::kFeatureRemoved};
  frame->stage_ms[msg::kStageExtract] = 6.126F;
  return frame;
}

msg::CompressedImage image(std::int64_t ms) {
  return {.header = {stamp(ms), ""}, .format = "jpeg", .data = {1, 2, 3}};
}

TEST(RobotMirror, a_view_is_an_image_with_the_overlays_of_its_frame) {
  RobotMirror mirror(0);
  EXPECT_FALSE(mirror.newest_image().has_value());
  mirror.add(image(1000));
  mirror.add(*features(1000));
  mirror.add(image(1033));
  const auto view = mirror.newest_image();
  ASSERT_TRUE(view.has_value());
  EXPECT_EQ(view->stamp_ns, 1'000'000'000) << "the newest that the filter has looked at";
  EXPECT_EQ(at<std::uint8_t>(view->features, 0), 9);
  EXPECT_EQ(at<std::uint32_t>(view->features, 4), 2U);
  EXPECT_EQ(at<std::uint16_t>(view->features, 26), 168) << "10.5 px in sixteenths";
  EXPECT_EQ(at<std::uint8_t>(view->features, 30), 1) << "removed";
  EXPECT_EQ(at<std::uint8_t>(view->features, 31), 255);
}

TEST(RobotMirror, on_a_busy_host_no_image_without_features_replaces_one_with_features) {
  RobotMirror mirror(0);
  mirror.add(image(1000));
  mirror.add(*features(1000));
  for (int ms = 1033; ms < 2500; ms += 33) {
    mirror.add(image(ms));
    EXPECT_EQ(mirror.newest_image()->stamp_ns, 1'000'000'000) << "at " << ms;
  }
  mirror.add(*features(1066));
  EXPECT_EQ(mirror.newest_image()->stamp_ns, 1'066'000'000);
}

TEST(RobotMirror, without_a_filter_the_image_is_shown_alone) {
  RobotMirror mirror(0);
  mirror.add(image(1000));
  EXPECT_EQ(mirror.newest_image()->stamp_ns, 1'000'000'000) << "no filter yet";
  mirror.add(*features(1005));
  mirror.add(image(2002));
  EXPECT_FALSE(mirror.newest_image().has_value()) << "its features may still come";
  mirror.add(image(3100));
  const auto view = mirror.newest_image();
  EXPECT_EQ(view->stamp_ns, 3'100'000'000) << "the filter has ended";
  EXPECT_EQ(view->features, nullptr);
}

TEST(RobotMirror, a_filter_that_looks_at_other_images_does_not_hide_these) {
  RobotMirror mirror(0);
  for (int ms = 1000; ms < 4000; ms += 33) {
    mirror.add(image(ms));
    mirror.add(*features(ms + 10));
  }
  ASSERT_TRUE(mirror.newest_image().has_value());
  EXPECT_NE(mirror.newest_image()->image, nullptr);
}

TEST(RobotMirror, depth_stays_for_a_moment_because_it_comes_less_often) {
  RobotMirror mirror(0);
  mirror.add(image(1000));
  mirror.add_depth(image(1000));
  EXPECT_EQ(at<std::uint8_t>(mirror.newest_image()->depth, 0), 17);
  mirror.add(image(1100));
  EXPECT_NE(mirror.newest_image()->depth, nullptr);
  mirror.add(image(1500));
  EXPECT_EQ(mirror.newest_image()->depth, nullptr);
}

/// What a page gets of an object that moves along x for a second as its velocity says.
json mover_message(double speed_mps, double sigma_mps) {
  RobotMirror mirror(0);
  for (const double stamp_s : {0.0, 1.0}) {
    msg::Movers movers;
    movers.stamp_ns = static_cast<std::int64_t>(stamp_s * 1e9);
    movers.movers.push_back({.center_m = {speed_mps * stamp_s, 0, 0}, .velocity_mps = {speed_mps, 0, 0}});
    for (std::size_t place = 0; place < 36; place += 7) movers.movers[0].covariance[place] = sigma_mps * sigma_mps;
    mirror.add(movers);
  }
  return text(mirror.item(Item::kMovers).payload)["movers"][0];
}

TEST(RobotMirror, an_object_rests_if_its_speed_may_be_noise) {
  EXPECT_TRUE(mover_message(0.3, 0.15)["rests"]);
  EXPECT_FALSE(mover_message(0.6, 0.15)["rests"]);
}

TEST(RobotMirror, boxes_of_a_slow_detector_stay_for_a_moment) {
  RobotMirror mirror(0);
  msg::Detection2DArray detections{.header = {stamp(1000), ""}};
  detections.detections.push_back(
      {.results = {{.hypothesis = {"person", 0.9}}}, .bbox = {.center = {{100, 50}, 0}, .size_x = 20, .size_y = 10}});
  mirror.add(detections);
  mirror.add(image(1300));
  const json boxes = text(mirror.newest_image()->boxes);
  EXPECT_EQ(boxes["boxes"][0]["label"], "person");
  EXPECT_EQ(boxes["boxes"][0]["x"], 90);
  mirror.add(image(1500));
  EXPECT_EQ(mirror.newest_image()->boxes, nullptr);
}

TEST(RobotMirror, a_mask_is_sent_as_runs) {
  RobotMirror mirror(2);
  msg::Image mask{.header = {stamp(1000), ""}, .height = 2, .width = 300, .encoding = "mono8", .step = 300};
  mask.data.assign(600, 0);
  mask.data[599] = 255;
  mirror.add(mask);
  mirror.add(image(1000));
  const Payload runs = mirror.newest_image()->mask;
  ASSERT_NE(runs, nullptr);
  EXPECT_EQ(at<std::uint8_t>(runs, 1), 2) << "the robot";
  EXPECT_EQ(at<std::uint32_t>(runs, 4), 8U) << "256 + 256 + 87 zeros and one";
  EXPECT_EQ(at<std::uint16_t>(runs, 16), 300);
  EXPECT_EQ(runs->size(), 28U);
  mask.data.resize(10);
  mask.header.stamp = stamp(1001);
  mirror.add(mask);
  mirror.add(image(1010));
  EXPECT_EQ(mirror.newest_image()->mask, nullptr) << "too few bytes";
}

TEST(RobotMirror, person_masks_are_runs_of_labels_beside_the_boxes) {
  RobotMirror mirror(2);
  msg::Image masks{.header = {stamp(1000), ""}, .height = 1, .width = 160, .encoding = "mono8", .step = 160};
  masks.data.assign(160, 0);
  masks.data[3] = 2;
  mirror.add_people(masks);
  mirror.add(image(1300));
  const Payload people = mirror.newest_image()->people;
  ASSERT_NE(people, nullptr) << "as long as the boxes of a slow detector";
  EXPECT_EQ(at<std::uint8_t>(people, 0), 13);
  EXPECT_EQ(at<std::uint32_t>(people, 4), 6U) << "three runs";
  EXPECT_EQ(at<std::uint8_t>(people, 22), 2) << "the label of the second run";
  EXPECT_EQ(mirror.newest_image()->mask, nullptr);
  mirror.add(image(1500));
  EXPECT_EQ(mirror.newest_image()->people, nullptr);
}

TEST(RobotMirror, a_pose_says_when_it_was_ready_and_what_it_cost) {
  RobotMirror mirror(1);
  mirror.add(*features(1000));
  msg::TrackingResult result{};
  result.seq = 7;
  result.state = msg::TrackingState::kOk;
  result.T_world_camera.rotation_xyzw = {0, 0, 0, 1};
  result.published_ns = 1'000'000;
  result.finished_ns = 23'456'789;
  mirror.add(result, 1e12);
  const json message = text(mirror.item(Item::kTracking).payload);
  EXPECT_EQ(message["latency_ms"], 22.46);
  EXPECT_EQ(message["state"], "ok");
  EXPECT_EQ(message["pose"].size(), 7U);
  EXPECT_EQ(message["filter_stage_ms"]["extract"], 6.13);
  EXPECT_EQ(mirror.map().trajectory().size(), 1U);
  result.state = msg::TrackingState::kLost;
  mirror.add(result, 1e12);
  EXPECT_TRUE(text(mirror.item(Item::kTracking).payload)["pose"].is_null());
  EXPECT_EQ(mirror.map().trajectory().size(), 1U);
}

TEST(RobotMirror, a_service_that_falls_silent_is_gone) {
  RobotMirror mirror(0);
  msg::ServiceStatus status{.service = "slam", .state = msg::ServiceState::kRunning};
  mirror.add(status, 0);
  mirror.refresh(100'000'000);
  EXPECT_EQ(text(mirror.item(Item::kStatus).payload)["services"][0]["state"], "running");
  mirror.refresh(3'000'000'000);
  EXPECT_EQ(text(mirror.item(Item::kStatus).payload)["services"][0]["state"], "gone");
  status.state = msg::ServiceState::kFinished;
  mirror.add(status, 0);
  mirror.refresh(3'000'000'000);
  EXPECT_EQ(text(mirror.item(Item::kStatus).payload)["services"][0]["state"], "finished");
}

TEST(RobotMirror, dense_points_keep_place_and_colour) {
  RobotMirror mirror(0);
  msg::PointCloud2 cloud{.width = 2, .point_step = 16};
  const char* names[] = {"x", "y", "z", "rgb"};
  for (std::uint32_t i = 0; i < 4; ++i) cloud.fields.push_back({names[i], 4 * i, 7, 1});
  cloud.data.resize(32);
  const std::array<float, 3> first = {1, 2, 3}, second = {-1, 2, 3};
  std::memcpy(cloud.data.data(), first.data(), 12);
  std::memcpy(cloud.data.data() + 16, second.data(), 12);
  cloud.data[12] = 10;
  cloud.data[13] = 20;
  cloud.data[14] = 30;  // blue, green, red
  mirror.add(CloudKind::kStatic, cloud);
  const auto& dense = mirror.dense(CloudKind::kStatic);
  ASSERT_EQ(dense.points.size(), 18U);
  std::int16_t x = 0;
  std::memcpy(&x, dense.points.data(), 2);
  EXPECT_NEAR(dense.origin_m.x() + static_cast<float>(x) * dense.scale_m, 1, 1e-3);
  EXPECT_EQ(std::to_integer<int>(dense.points[6]), 30);
  cloud.point_step = 8;
  mirror.add(CloudKind::kStatic, cloud);
  EXPECT_EQ(mirror.dense(CloudKind::kStatic).revision, 1U) << "fields beyond a point are refused";
  cloud.point_step = 16;
  for (const std::uint32_t offset : {0xFFFFFFFCU, 0xFFFFFFFFU, 13U}) {
    cloud.fields[2].offset = offset;
    mirror.add(CloudKind::kStatic, cloud);
    EXPECT_EQ(mirror.dense(CloudKind::kStatic).revision, 1U) << "an offset of " << offset;
  }
}

TEST(RobotMirror, stamps_of_any_size_are_only_very_old_or_new) {
  constexpr std::int64_t kMax = std::numeric_limits<std::int64_t>::max(),
                         kMin = std::numeric_limits<std::int64_t>::min();
  RobotMirror mirror(0);
  msg::CompressedImage image;
  image.data = {1, 2, 3};
  mirror.add(image);
  const auto frame = std::make_unique<msg::FeatureFrame>();
  for (const std::int64_t stamp_ns : {kMax, kMin, kMax - 1, kMin + 1}) {
    frame->stamp_ns = stamp_ns;
    mirror.add(*frame);
    ASSERT_TRUE(mirror.newest_image());
    EXPECT_EQ(mirror.newest_image()->features, nullptr);
  }
  msg::TrackingResult result{};
  result.finished_ns = kMax;
  result.published_ns = kMin;
  mirror.add(result, 0);
  EXPECT_NE(mirror.item(Item::kTracking).payload, nullptr);
}

TEST(RobotMirror, memory_is_level_after_five_minutes_of_an_hour_at_30_hz) {
  if (test_support::kSanitized) GTEST_SKIP() << "sanitizers count their own memory";
  const auto allocated = [] { return mallinfo2().uordblks + mallinfo2().hblkhd; };
  RobotMirror mirror(0);
  constexpr int kFrames = 3600 * 30, kSettled = 300 * 30;
  std::size_t after_five_minutes = 0;
  msg::TrackingResult result{.state = msg::TrackingState::kOk};
  for (int frame = 0; frame < kFrames; ++frame) {
    const std::int64_t ms = frame * 100 / 3;
    msg::CompressedImage picture = image(ms);
    picture.data.resize(20'000);
    mirror.add(picture);
    mirror.add(*features(ms));
    result.stamp_ns = ms * 1'000'000;
    result.T_world_camera.translation_m[0] = 0.001 * frame;
    mirror.add(result, static_cast<double>(ms));
    if (frame % 6 == 0) mirror.add(msg::ServiceStatus{.service = "slam"}, result.stamp_ns);
    if (frame % 30 == 0) mirror.refresh(result.stamp_ns);
    if (frame == kSettled) after_five_minutes = allocated();
  }
  EXPECT_LT(allocated(), after_five_minutes + 5'000'000);
  EXPECT_EQ(mirror.map().trajectory().size(), static_cast<std::size_t>(kFrames)) << "the whole path is shown";
}

TEST(ShownRobots, are_those_with_topics_of_their_own) {
  EXPECT_THAT(shown_robots({"rtd/anna/status", "rt/bert/slam/odometry", "rtd/status"}), ElementsAre("anna", "bert"));
  EXPECT_THAT(shown_robots({"rtd/status", "rtd/frame"}), ElementsAre(""));
  EXPECT_THAT(shown_robots({"rtd/anna/status", "rtd/atlas", "rt/atlas/points"}), ElementsAre("anna"));
  EXPECT_THAT(shown_robots({"rr/recorder/startReply", "rtd/anna/status"}), ElementsAre("", "anna"));
}

TEST(ShownRobots, the_viewer_itself_and_shared_topics_are_no_robot) {
  EXPECT_THAT(shown_robots({}), IsEmpty());
  EXPECT_THAT(shown_robots({"rtd/status", "rtd/schemas", "rt/tf", "rt/diagnostics", "rt/camera/color/image_raw"}),
              IsEmpty());
}

}  // namespace
}  // namespace rtd::viewer
