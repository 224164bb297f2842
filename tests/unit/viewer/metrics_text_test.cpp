// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/viewer/core/metrics_text.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

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

}  // namespace
}  // namespace rtd::viewer
