// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/viewer/settings.hpp"

#include <gtest/gtest.h>

namespace rtd::viewer {
namespace {

msg::ServiceStatus status(const std::string& service, std::vector<msg::Metric> metrics) {
  msg::ServiceStatus result;
  result.service = service;
  result.metrics = std::move(metrics);
  return result;
}

TEST(Settings, come_from_the_heartbeats) {
  const auto settings = settings_of("", {status("slam", {{"localize_only", 1}}), status("filter", {{"mode.rtd", 1}})});
  ASSERT_EQ(settings.size(), 2U);
  EXPECT_EQ(settings[0].name, "slam.localize_only");
  EXPECT_EQ(settings[0].value, foxglove::ParameterValue(true));
  EXPECT_EQ(settings[1].value, foxglove::ParameterValue(std::string("rtd")));
  EXPECT_EQ(settings_of("anna", {status("filter", {{"mode.of-later", 1}})})[0].name, "anna.filter.mode");
  EXPECT_TRUE(settings_of("", {status("filter", {{"frames", 1}})}).empty());
}

TEST(Settings, setting_one_calls_a_command) {
  const auto call = call_for({"anna.filter.mode", std::string("geometry")});
  ASSERT_TRUE(call.has_value());
  EXPECT_EQ(call->command, "/anna/filter/set_mode");
  EXPECT_EQ(call->argument, "geometry");
  EXPECT_EQ(call_for({"slam.localize_only", false})->argument, "false");
  EXPECT_EQ(call_for({"replay.speed", 2.5})->argument, "2.5");
  EXPECT_FALSE(call_for({"slam.localize_only", 1.0})) << "not a switch";
  EXPECT_FALSE(call_for({"xslam.localize_only", true}));
  EXPECT_FALSE(call_for({"nothing", true}));
}

TEST(Settings, a_replay_says_where_it_is) {
  page::ServiceLine replay{status("replay", {{"replay.position_s", 3}, {"replay.length_s", 25}, {"replay.paused", 1}})};
  page::ServiceLine camera{status("camera", {})};
  replay.status.state = camera.status.state = msg::ServiceState::kRunning;
  EXPECT_TRUE(playback_of({replay})->paused);
  EXPECT_EQ(playback_of({replay})->length_s, 25);
  EXPECT_FALSE(playback_of({camera}));
  EXPECT_FALSE(playback_of({{status("replay", {})}}));
  EXPECT_FALSE(playback_of({replay, camera})->replaced);
  replay.status.state = msg::ServiceState::kFinished;
  EXPECT_TRUE(playback_of({replay})->ended);
  EXPECT_FALSE(playback_of({replay})->replaced);
  EXPECT_TRUE(playback_of({replay, camera})->replaced);
  replay = {replay.status, 60'000};
  replay.status.state = msg::ServiceState::kRunning;
  EXPECT_TRUE(playback_of({replay})->ended) << "killed: no heartbeat for a minute";
}

}  // namespace
}  // namespace rtd::viewer
