// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <random>

#include "services/viewer/core/metrics_text.hpp"
#include "services/viewer/core/page_messages.hpp"
#include "tests/unit/bus/random_message.hpp"

namespace rtd::viewer {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using State = msg::ServiceState;

WatchedService service(const std::string& name, State state, std::vector<msg::Metric> metrics = {},
                       double age_ms = 100) {
  WatchedService watched;
  watched.line.status.service = name;
  watched.line.status.state = state;
  watched.line.status.started_ns = 1'500'000'000;
  watched.line.status.metrics = std::move(metrics);
  watched.line.age_ms = age_ms;
  return watched;
}

TEST(MetricsText, has_each_metric_in_base_units_with_its_service_and_host) {
  const auto slam =
      service("slam", State::kRunning,
              {{"host_id", 7}, {"host_name.robot", 1}, {"keyframes", 12}, {"slam_ms", 12.5}, {"sent_mb", 2}});
  const std::string text = metrics_text({slam});
  const std::string labels = R"({robot="",service="slam",host="robot"} )";
  EXPECT_THAT(text, AllOf(HasSubstr("# TYPE rtd_slam_keyframes gauge\nrtd_slam_keyframes" + labels + "12\n"),
                          HasSubstr("\nrtd_slam_seconds" + labels + "0.0125\n"),
                          HasSubstr("\nrtd_slam_sent_bytes" + labels + "2e+06\n"),
                          HasSubstr("\nrtd_service_up" + labels + "1\n"),
                          HasSubstr("\nrtd_service_start_time_seconds" + labels + "1.5\n")));
  EXPECT_THAT(text, Not(HasSubstr("host_id")));
}

TEST(MetricsText, what_a_metric_is_about_becomes_a_label) {
  const auto filter = service(
      "filter", State::kRunning,
      {{"clock.slam.offset_ms", 2}, {"topic.rt/x.type_mismatch", 1}, {"out:rtd/frame", 3}, {"replay.position_s", 4}});
  const std::string text = metrics_text({filter});
  EXPECT_THAT(text,
              AllOf(HasSubstr(R"(rtd_filter_clock_offset_seconds{robot="",service="filter",host="",of="slam"} 0.002)"),
                    HasSubstr(R"(rtd_filter_topic_type_mismatch{robot="",service="filter",host="",of="rt/x"} 1)"),
                    HasSubstr(R"(rtd_filter_out{robot="",service="filter",host="",of="rtd/frame"} 3)"),
                    HasSubstr(R"(rtd_filter_replay_position_seconds{robot="",service="filter",host=""} 4)")));
}

TEST(MetricsText, samples_of_a_metric_stand_together_and_labels_are_escaped) {
  auto anna = service("camera", State::kRunning, {{"frames", 1}}),
       odd = service("camera", State::kRunning, {{"frames", 2}});
  anna.robot = "anna";
  odd.robot = "a\"b\\c\nd";
  EXPECT_THAT(metrics_text({anna, odd}),
              HasSubstr("# TYPE rtd_camera_frames gauge\n"
                        "rtd_camera_frames{robot=\"anna\",service=\"camera\",host=\"\"} 1\n"
                        "rtd_camera_frames{robot=\"a\\\"b\\\\cd\",service=\"camera\",host=\"\"} 2\n"));
}

TEST(MetricsText, a_silent_or_failed_service_is_down_and_one_that_ended_is_gone) {
  const std::string text = metrics_text({service("slam", State::kRunning, {}, 5000), service("filter", State::kFailed),
                                         service("dense", State::kDegraded), service("camera", State::kFinished)});
  EXPECT_THAT(text, AllOf(HasSubstr("rtd_service_up{robot=\"\",service=\"slam\",host=\"\"} 0"),
                          HasSubstr("rtd_service_up{robot=\"\",service=\"filter\",host=\"\"} 0"),
                          HasSubstr("rtd_service_degraded{robot=\"\",service=\"dense\",host=\"\"} 1"),
                          Not(HasSubstr("camera"))));
}

TEST(Health, is_well_until_a_service_fails_or_falls_silent) {
  EXPECT_TRUE(health_of({}).well);
  const auto well = service("slam", State::kRunning, {{"host_name.robot", 1}}),
             degraded = service("dense", State::kDegraded);
  const auto health = nlohmann::json::parse(health_of({well, degraded}).json);
  EXPECT_EQ(health["status"], "degraded");
  EXPECT_EQ(health["services"][0]["host"], "robot");
  EXPECT_TRUE(health_of({well, degraded, service("camera", State::kFinished, {}, 60'000)}).well) << "it ended in order";
  EXPECT_FALSE(health_of({well, service("filter", State::kFailed)}).well);
  EXPECT_FALSE(health_of({service("slam", State::kRunning, {}, 5000)}).well);
}

std::string hex(const Bytes& bytes) {
  std::string text;
  for (const std::byte byte : bytes) fmt::format_to(std::back_inserter(text), "{:02x}", std::to_integer<int>(byte));
  return text;
}

template <class T>
T sample(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  T message{};
  bus::reflect::randomize(message, random);
  return message;
}

/// Of four pixels, two of them moving.
msg::Image mask() {
  auto image = sample<msg::Image>(1);
  image.width = image.height = image.step = 2;
  image.encoding = "mono8";
  image.data = {0, 255, 255, 0};
  return image;
}

msg::FeatureFrame features() {
  auto frame = std::make_unique<msg::FeatureFrame>(sample<msg::FeatureFrame>(2));
  frame->count = 2;
  return *frame;
}

std::string map_messages() {
  const MirroredKeyframe first{.points_m = {{1, 2, 3}, {4, 5, 6}}, .covisible = {0}};
  const page::KeyframeRef keyframes[] = {{7, &first}};
  const std::uint32_t ids[] = {3, 9};
  const TrajectoryPoint path[] = {{7, {1, 0, 0}}, {TrajectoryPoint::kNone, {2, 0, 0}}};
  const Eigen::Vector3f truth[] = {{1, 2, 3}};
  const TrajectoryPoint valued[] = {
      {.stamp_ns = 3'000'000'000, .sigma_m = 0.5F, .state = msg::TrackingState::kDoubtful}};
  const float errors_m[] = {0.25F};
  return fmt::format("trajectory_values {}\n", hex(page::trajectory_values(1, 0, 1'000'000'000, valued, errors_m))) +
         fmt::format("poses {}\nremoved {}\npoints {}\ncovisibility {}\nloop_edges {}\ntrajectory {}\ntruth {}\n",
                     hex(page::poses(1, 2, keyframes)), hex(page::removed(1, ids)),
                     hex(page::points(1, 2, keyframes, 1)), hex(page::covisibility(1, keyframes)),
                     hex(page::loop_edges(1, ids)), hex(page::trajectory(1, 0, path)), hex(page::truth(1, 0, truth)));
}

msg::OccupancyGrid floor_plan() {
  msg::OccupancyGrid plan;
  plan.info.resolution = 0.5F;
  plan.info.width = 3;
  plan.info.height = 1;
  plan.info.origin = {{1, 2, 3}, {0, 0, 0, 1}};
  plan.data = {0, 100, -1};
  return plan;
}

std::string image_messages() {
  const std::array<std::byte, 9> points{};
  return fmt::format("image {}\nfeatures {}\nmask {}\ndense {}\n", hex(page::image(1, sample<msg::CompressedImage>(3))),
                     hex(page::features(1, features())), hex(page::runs(page::Kind::kMask, 1, mask())),
                     hex(page::dense(page::Kind::kDense, 1, 0, 1, {1, 2, 3}, 0.5F, points))) +
         fmt::format("moving {}\nplan {}\n", hex(page::dense(page::Kind::kMoving, 1, 0, 1, {1, 2, 3}, 0.5F, points)),
                     hex(page::plan(1, floor_plan()))) +
         fmt::format("depth {}\n", hex(page::image(1, sample<msg::CompressedImage>(3), page::Kind::kDepth)));
}

/// One robot that has met and one that has not.
msg::AtlasState atlas() {
  msg::AtlasState state;
  state.robots = {{.name = "anna", .met = true}, {.name = "bert"}};
  state.robots[0].T_map_robot = {{1, 2, 3}, {0, 0, 0, 1}};
  state.robots[0].T_map_camera = {{4, 5, 6}, {0, 0, 1, 0}};
  return state;
}

std::string texts() {
  const page::ServiceLine line{sample<msg::ServiceStatus>(4), 12.5};
  const CommandInfo command{"/slam/reset", CommandKind::kTrigger};
  const std::string robots[] = {"", "anna"};
  std::string all;
  for (const std::string& text :
       {page::tracking(1, sample<msg::TrackingResult>(5), 3.5, std::array<float, msg::kFilterStages>{1, 2}),
        page::boxes(1, sample<msg::Detection2DArray>(6)), page::movers(1, sample<msg::Movers>(7), std::vector<bool>(9)),
        page::playback(1, {.position_s = 1, .length_s = 2}), page::services(1, std::span(&line, 1)),
        page::commands(1, std::span(&command, 1)), page::truth_error(1, 0.25, 10), page::map_reset(1),
        page::robots(robots), page::answer(5, {true, "done"}), page::atlas(atlas())})
    all += text + '\n';
  return all;
}

/// Programs and pages of earlier versions read them. RTD_RECORD_GOLDEN=1 writes them down after a change on purpose.
TEST(PageMessages, are_the_recorded_ones) {
  const std::string now = map_messages() + image_messages() + texts();
  if (std::getenv("RTD_RECORD_GOLDEN") != nullptr) std::ofstream(GOLDEN_PATH) << now;
  std::ifstream file(GOLDEN_PATH);
  EXPECT_EQ(now, std::string(std::istreambuf_iterator<char>(file), {}));
}

}  // namespace
}  // namespace rtd::viewer
