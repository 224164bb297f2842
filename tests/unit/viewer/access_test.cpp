// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "services/viewer/core/access.hpp"
#include "services/viewer/settings.hpp"

namespace rtd::viewer {
namespace {

const AccessRules kLoopback{.hosts = {"localhost"}, .origins = {"https://app.foxglove.dev"}, .token = ""};

TEST(Access, programs_and_the_own_page_may_connect) {
  EXPECT_EQ(check_access(kLoopback, {.host = "127.0.0.1:8765"}), Access::kGranted);
  EXPECT_EQ(check_access(kLoopback, {.host = "LocalHost:8765", .origin = "http://localhost:8765"}), Access::kGranted);
  EXPECT_EQ(check_access(kLoopback, {.host = "[::1]:8765", .origin = "http://[::1]:8765"}), Access::kGranted);
  EXPECT_EQ(check_access(kLoopback, {.host = "127.0.0.1:8765", .origin = "https://app.foxglove.dev"}),
            Access::kGranted);
}

TEST(Access, pages_of_other_sites_may_not) {
  for (const char* origin : {"https://evil.example", "http://localhost:9999", "http://127.0.0.1", "evil"})
    EXPECT_EQ(check_access(kLoopback, {.host = "localhost:8765", .origin = origin}), Access::kWrongOrigin) << origin;
}

TEST(Access, a_page_from_a_file_needs_a_token) {
  AccessRules rules{.hosts = {"localhost"}, .origins = {"file://", "null"}, .token = ""};
  for (const char* origin : {"file://", "null", "FILE://", "file://localhost:8765"})
    EXPECT_EQ(check_access(rules, {.host = "localhost:8765", .origin = origin}), Access::kAnonymousOrigin) << origin;
  rules.token = "s3cret";
  const auto with = [&](const char* origin, const char* target) {
    return check_access(rules, {.host = "localhost:8765", .origin = origin, .target = target});
  };
  EXPECT_EQ(with("file://", "/?token=s3cret"), Access::kGranted);
  EXPECT_EQ(with("file://", "/?token=wrong"), Access::kNoToken);
  rules.look_freely = true;
  EXPECT_EQ(with("file://", "/?token=wrong"), Access::kNoToken) << "not even to look";
  rules.origins.clear();
  EXPECT_EQ(with("null", "/?token=s3cret"), Access::kWrongOrigin);
}

TEST(Access, a_name_of_another_site_that_points_here_is_refused) {
  for (const char* host : {"evil.example:8765", "127.evil.example", "", "localhost.evil.example:8765"})
    EXPECT_EQ(check_access(kLoopback, {.host = host}), Access::kWrongHost) << host;
  EXPECT_EQ(check_host({.hosts = {"robot.lan"}}, "ROBOT.lan:8765"), Access::kGranted);
  EXPECT_EQ(check_host({}, "anything:1"), Access::kGranted) << "no names given: the token is asked for";
}

TEST(Access, a_token_is_asked_for_when_there_is_one) {
  const AccessRules rules{.token = "s3cret+"};
  EXPECT_EQ(check_access(rules, {.host = "robot", .target = "/live?token=s3cret%2B"}), Access::kGranted);
  EXPECT_EQ(check_access(rules, {.host = "robot", .target = "/live?x=1&token=s3cret+"}), Access::kGranted);
  EXPECT_EQ(check_access(rules, {.host = "robot", .target = "/", .authorization = "Bearer s3cret+"}), Access::kGranted);
  for (const char* target : {"/", "/?token=", "/?token=s3cret", "/?token=s3cret%2B%2B", "/?tokens=s3cret+", "/?token"})
    EXPECT_EQ(check_access(rules, {.host = "robot", .target = target}), Access::kNoToken) << target;
}

TEST(Access, without_the_token_a_client_of_loopback_only_looks) {
  const AccessRules rules{.hosts = {"localhost"}, .token = "s3cret", .look_freely = true};
  const AccessRequest page{.host = "localhost:8765", .origin = "http://localhost:8765", .target = "/live"};
  EXPECT_EQ(check_access(rules, page), Access::kToLook);
  EXPECT_TRUE(may_look(Access::kToLook));
  EXPECT_EQ(check_access(rules, {.host = "localhost", .target = "/?token=s3cret"}), Access::kGranted);
  EXPECT_EQ(check_access(rules, {.host = "localhost", .target = "/?token=guess"}), Access::kToLook);
  EXPECT_EQ(check_access(rules, {.host = "localhost", .target = "/", .authorization = "Bearer x"}), Access::kToLook);
  EXPECT_EQ(check_access(rules, {.host = "localhost", .origin = "https://evil.example", .target = "/?token=s3cret"}),
            Access::kWrongOrigin);
}

TEST(Access, who_knows_the_token_to_look_only_looks) {
  const AccessRules rules{.token = "s3cret", .look_token = "picture"};
  EXPECT_EQ(check_access(rules, {.host = "robot", .target = "/live?token=picture"}), Access::kToLook);
  EXPECT_EQ(check_access(rules, {.host = "robot", .target = "/", .authorization = "Bearer picture"}), Access::kToLook);
  EXPECT_EQ(check_access(rules, {.host = "robot", .target = "/live?token=s3cret"}), Access::kGranted);
  const AccessRules none{.token = "s3cret"};
  for (const char* target : {"/live", "/live?token="}) {
    EXPECT_EQ(check_access(rules, {.host = "robot", .target = target}), Access::kNoToken);
    EXPECT_EQ(check_access(none, {.host = "robot", .target = target}), Access::kNoToken);
  }
}

TEST(Access, a_query_is_taken_apart) {
  EXPECT_EQ(query_value("/?a=1&b=%41%zz%4", "b"), "A%zz%4");
  EXPECT_EQ(query_value("/?a=1&&b=2&", "b"), "2");
  EXPECT_EQ(query_value("/plain", "a"), "");
  EXPECT_EQ(path_of("/live?token=x"), "/live");
}

page::ServiceLine status(const std::string& service, std::vector<msg::Metric> metrics) {
  page::ServiceLine line;
  line.status.service = service;
  line.status.metrics = std::move(metrics);
  return line;
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
  page::ServiceLine replay =
      status("replay", {{"replay.position_s", 3}, {"replay.length_s", 25}, {"replay.paused", 1}});
  page::ServiceLine camera = status("camera", {});
  replay.status.state = camera.status.state = msg::ServiceState::kRunning;
  EXPECT_TRUE(playback_of({replay})->paused);
  EXPECT_EQ(playback_of({replay})->length_s, 25);
  EXPECT_FALSE(playback_of({camera}));
  EXPECT_FALSE(playback_of({status("replay", {})}));
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
