// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/replay/replay_service.hpp"

#include <gmock/gmock.h>

#include <future>

#include "common/bus/commands.hpp"
#include "common/ros2/schema_texts.hpp"
#include "common/ros2/type_description.hpp"
#include "common/service/config.hpp"
#include "tests/component/replay/raw_recording.hpp"
#include "tests/support/inprocess/inprocess_bus.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/time_bounds.hpp"

namespace rtd::replay {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr std::int64_t kMillisecond = 1'000'000, kEpoch = 1'700'000'000'000'000'000;

/// A replay in a thread, on an in-process bus of its own.
class ReplayServiceTest : public testing::Test {
 protected:
  ReplayServiceTest() {
    static std::uint32_t domain = 150;
    options_.vendor = bus::inprocess::vendor();
    options_.domain = domain++;
    raw_ = bus::connect_raw(options_);
    bus_ = bus::connect(options_);
    config_.file = file_;
  }
  ~ReplayServiceTest() override {
    stop_.request_stop();
    if (running_.valid()) running_.get();
  }

  void record(const std::vector<Piece>& pieces) { write_recording(file_, pieces); }
  void start(service::Pace pace = service::Pace::kRealtime) {
    running_ = std::async(std::launch::async, [this, pace] {
      service::Heartbeat heartbeat(*bus_, ReplayService::kName, stop_);
      service::Runtime runtime{*bus_, heartbeat, stop_, pace, options_};
      return ReplayService(config_, runtime).run();
    });
  }
  service::ExitCode ended() { return running_.get(); }
  /// Why the service does not start.
  std::string refusal(service::Pace pace = service::Pace::kRealtime) {
    start(pace);
    try {
      ended();
    } catch (const service::ConfigError& error) {
      return error.what();
    }
    return "it started";
  }

  /// 30 frames of 10 ms and 15 boxes between them.
  static std::vector<Piece> frames_and_boxes() {
    std::vector<Piece> pieces;
    for (std::uint64_t i = 0; i < 30; ++i) {
      const std::int64_t time_ns = kEpoch + static_cast<std::int64_t>(i) * 10 * kMillisecond;
      pieces.push_back({"rtd/features", time_ns, time_ns - 300'000, cdr_of(i, 5000)});
      if (i % 2 == 0) pieces.push_back({"rt/boxes", time_ns + kMillisecond, time_ns + 500'000, cdr_of(i, 17 + i)});
    }
    return pieces;
  }

  const rtd::test::TemporaryFolder folder_;
  const std::string file_ = folder_.file("a.mcap");
  bus::BusOptions options_;
  ServiceConfig config_;
  service::StopToken stop_;
  std::shared_ptr<bus::RawBus> raw_;
  std::shared_ptr<bus::Bus> bus_;
  std::future<service::ExitCode> running_;
};

TEST_F(ReplayServiceTest, a_recording_of_the_replay_has_the_same_bytes_order_and_publish_times) {
  const std::vector<Piece> recorded = frames_and_boxes();
  record(recorded);
  Recorder recorder(*raw_);
  start();
  const std::vector<Piece> again = recorder.wait(recorded.size());
  EXPECT_EQ(ended(), service::kOk);
  for (const char* topic : {"rtd/features", "rt/boxes"}) expect_same(recorded, again, topic);
  const double lasted_ms = static_cast<double>(again.back().log_ns - again.front().log_ns) / kMillisecond;
  EXPECT_GT(lasted_ms, 230);
  if (test_support::checks_time()) {
    EXPECT_LT(lasted_ms, 350) << "as long as recorded";
  }
}

TEST_F(ReplayServiceTest, commands_pause_step_seek_and_change_the_speed) {
  std::vector<Piece> recorded;  // two minutes, so that it does not end meanwhile
  for (std::uint64_t i = 0; i < 1200; ++i) {
    const std::int64_t time_ns = kEpoch + static_cast<std::int64_t>(i) * 100 * kMillisecond;
    recorded.push_back({"rtd/features", time_ns, time_ns, cdr_of(i, 100)});
    recorded.push_back({"rt/boxes", time_ns + kMillisecond, time_ns, cdr_of(i, 20)});
  }
  record(recorded);
  config_.pause = true;
  Recorder recorder(*raw_);
  start();
  bus::CommandClient client(options_);
  const auto call = [&](const char* command, const std::string& argument = {}) {
    const bus::CommandAnswer answer = client.call(command, argument, 10'000);
    return (answer.success ? "" : "failed: ") + answer.message;
  };
  EXPECT_EQ(call("replay/pause", "true"), "paused at 0.0 s of 119.9 s, speed 1");
  EXPECT_EQ(call("replay/step"), "one frame further, paused at 0.0 s of 119.9 s, speed 1");
  EXPECT_EQ(call("replay/seek", "60"), "continues at 60.0 s of 119.9 s, speed 1");
  EXPECT_EQ(call("replay/step"), "one frame further, paused at 60.0 s of 119.9 s, speed 1");
  EXPECT_EQ(call("replay/seek", "1"), "continues at 1.0 s of 119.9 s, speed 1");
  EXPECT_EQ(call("replay/step"), "one frame further, paused at 1.0 s of 119.9 s, speed 1");
  const std::vector<Piece> frames = of_topic(recorder.wait(3), "rtd/features");
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_TRUE(frames[0].cdr == cdr_of(0, 100));
  EXPECT_TRUE(frames[1].cdr == cdr_of(600, 100));
  EXPECT_TRUE(frames[2].cdr == cdr_of(10, 100)) << "seeking back";
  EXPECT_THAT(call("replay/seek", "200"),
              HasSubstr("failed: '200' is no position: give seconds from the beginning, 0"));
  EXPECT_THAT(call("replay/speed", "fast"), HasSubstr("failed: 'fast' is no speed: give a number from 0.01 to 1000"));
  EXPECT_THAT(call("replay/speed", "4"), HasSubstr("speed 4"));
  EXPECT_THAT(call("replay/pause", "false"), AllOf(HasSubstr("playing at 1."), HasSubstr("speed 4")));
  EXPECT_THAT(call("replay/speed", "1000"), HasSubstr("speed 1000"));
  EXPECT_EQ(ended(), service::kOk);
}

TEST_F(ReplayServiceTest, as_fast_as_possible_loses_nothing) {
  const std::vector<Piece> recorded = frames_and_boxes();
  record(recorded);
  config_.rate = 0;
  Recorder recorder(*raw_);
  start();
  const std::vector<Piece> again = recorder.wait(recorded.size());
  EXPECT_EQ(ended(), service::kOk);
  for (const char* topic : {"rtd/features", "rt/boxes"}) expect_same(recorded, again, topic);
}

TEST_F(ReplayServiceTest, plays_the_chosen_topics_under_new_names_from_the_chosen_time) {
  record(frames_and_boxes());
  config_.topics = {"/box*"};
  config_.remap = {"/boxes:=/old/boxes"};
  config_.start_offset_s = 0.1;
  config_.duration_s = 0.05;
  Recorder recorder(*raw_);
  start();
  EXPECT_EQ(ended(), service::kOk);
  const std::vector<Piece> again = recorder.wait(3, std::chrono::seconds(1));
  ASSERT_EQ(again.size(), 3U) << "101, 121 and 141 ms";
  EXPECT_EQ(again[0].topic, "rt/old/boxes");
  EXPECT_EQ(again[0].cdr, cdr_of(10, 27));
}

TEST_F(ReplayServiceTest, publishes_the_clock) {
  record(frames_and_boxes());
  config_.clock_hz = 100;
  Recorder recorder(*raw_);
  start();
  EXPECT_EQ(ended(), service::kOk);
  const std::vector<Piece> ticks = of_topic(recorder.wait(45, std::chrono::seconds(1)), "rt/clock");
  ASSERT_GT(ticks.size(), 5U);
  std::int32_t sec = 0;
  std::memcpy(&sec, ticks.back().cdr.data() + 4, sizeof(sec));
  EXPECT_EQ(sec, kEpoch / 1'000'000'000);
}

/// A consumer that answers each frame some time later, with our type.
TEST_F(ReplayServiceTest, in_lockstep_each_frame_waits_for_the_answer_to_the_one_before) {
  std::vector<Piece> recorded = frames_and_boxes();
  recorded.push_back({"rtd/tracking", kEpoch + 400 * kMillisecond, kEpoch, cdr_of(0, 100)});
  record(recorded);
  const auto answers = raw_->writer({"rtd/tracking", "rtd_msgs::msg::dds_::TrackingResult_"}, {});
  Recorder recorder(*raw_);  // receives the answers too
  start(service::Pace::kLockstep);
  std::size_t all = 0;
  for (std::uint64_t seq = 0; seq < 30; ++seq) {
    all += seq % 2 == 0 ? 2 : 1;  // boxes come with every second frame
    const std::vector<Piece> came = of_topic(recorder.wait(all + seq), "rtd/features");
    ASSERT_EQ(came.size(), seq + 1) << "not before the answer";
    const std::string answer = cdr_of(seq, 100);
    answers->write(std::as_bytes(std::span(answer)));
  }
  EXPECT_EQ(ended(), service::kOk);
  EXPECT_EQ(of_topic(recorder.wait(75), "rt/boxes").size(), 15U);
}

TEST_F(ReplayServiceTest, says_who_does_not_answer) {
  record(frames_and_boxes());
  config_.start_timeout_s = 0.2;
  start(service::Pace::kLockstep);
  EXPECT_EQ(ended(), service::kRunFailed) << "rtd/tracking has no publisher";
}

TEST_F(ReplayServiceTest, a_damaged_recording_is_played_as_far_as_it_can_be_read) {
  record(frames_and_boxes());
  std::filesystem::resize_file(file_, std::filesystem::file_size(file_) / 2);
  Recorder recorder(*raw_);
  config_.rate = 0;
  start();
  EXPECT_EQ(ended(), service::kPartialLoss);
}

TEST_F(ReplayServiceTest, names_what_is_wrong_with_the_recording) {
  config_.file = "/nonexistent/x.mcap";
  EXPECT_THAT(refusal(), HasSubstr("/nonexistent/x.mcap"));
  config_.file = file_;
  std::ofstream(file_) << "this is no recording at all";
  EXPECT_THAT(refusal(), HasSubstr("not an MCAP file"));
  record({});
  EXPECT_THAT(refusal(), HasSubstr("no topics"));
  config_.file.clear();
  EXPECT_THAT(refusal(), HasSubstr("rtd replay FILE"));
}

TEST_F(ReplayServiceTest, refuses_types_whose_fields_were_others_when_they_were_recorded) {
  std::string former = ros2::own_idl();
  const std::string field = "  double readout_s;\n";
  for (std::size_t at = former.find(field); at != std::string::npos; at = former.find(field)) {
    former.erase(at, field.size());
  }
  write_recording(file_, frames_and_boxes(), true, former);
  EXPECT_THAT(refusal(), AllOf(HasSubstr("rtd/features was recorded by another version of RTD-SLAM"),
                               HasSubstr("FeatureFrame has other fields"), HasSubstr("--exclude rtd/features")));
  config_.exclude = {"rtd/features"};
  start();
  EXPECT_EQ(ended(), service::kOk);
  config_.exclude.clear();
  write_recording(file_, frames_and_boxes(), true, ros2::own_idl());
  start();
  EXPECT_EQ(ended(), service::kOk);
}

TEST_F(ReplayServiceTest, publishes_the_texts_of_types_that_are_not_built_in) {
  write_recording(file_, {{"rt/boxes", kEpoch, kEpoch, cdr_of(1, 20)}}, true, "struct Blob_ { octet b; };");
  start();
  std::promise<std::vector<ros2::SchemaText>> came;
  bus::RawHandlers handlers;
  handlers.on_sample = [&](const bus::RawSample& sample) { came.set_value(ros2::decode_schemas(sample.cdr())); };
  const auto reader = raw_->reader({ros2::kSchemasTopic, ros2::kSchemasType}, {.transient_local = true}, handlers);
  auto texts = came.get_future();
  ASSERT_EQ(texts.wait_for(std::chrono::seconds(10)), std::future_status::ready);
  const std::vector<ros2::SchemaText> schemas = texts.get();
  EXPECT_EQ(ended(), service::kOk);
  ASSERT_EQ(schemas.size(), 1U);
  EXPECT_EQ(schemas[0].dds_type, "test_msgs::msg::dds_::Blob_");
  EXPECT_EQ(schemas[0].definition.name, "test_msgs/msg/Blob");
  EXPECT_EQ(schemas[0].definition.encoding, "omgidl");
  EXPECT_EQ(schemas[0].definition.text, "struct Blob_ { octet b; };");
}

TEST_F(ReplayServiceTest, leaves_out_channels_that_are_not_in_cdr) {
  const std::vector<Piece> in_cdr = frames_and_boxes();
  std::vector<Piece> pieces = in_cdr;
  pieces.push_back({"rt/settings", kEpoch, kEpoch, "{\"gain\": 1}", "json"});
  record(pieces);
  Recorder recorder(*raw_);
  config_.rate = 0;
  testing::internal::CaptureStdout();
  start();
  const std::vector<Piece> again = recorder.wait(in_cdr.size());
  EXPECT_EQ(ended(), service::kOk);
  EXPECT_EQ(recorder.wait(in_cdr.size() + 1, std::chrono::seconds(1)).size(), in_cdr.size());
  for (const char* topic : {"rtd/features", "rt/boxes"}) expect_same(in_cdr, again, topic);
  EXPECT_THAT(testing::internal::GetCapturedStdout(), AllOf(HasSubstr("/settings"), HasSubstr("json")));
}

TEST_F(ReplayServiceTest, refuses_a_recording_of_which_nothing_is_in_cdr) {
  record({{"rt/settings", kEpoch, kEpoch, "{}", "json"}, {"rt/old", kEpoch, kEpoch, "abcd", "ros1"}});
  EXPECT_THAT(refusal(), AllOf(HasSubstr("nothing to play"), HasSubstr("CDR"), HasSubstr("/settings (json)"),
                               HasSubstr("/old (ros1)")));
}

TEST_F(ReplayServiceTest, names_the_option_that_is_wrong_and_what_there_is) {
  record(frames_and_boxes());
  const ServiceConfig good = config_;
  const auto with = [&](const std::function<void(ServiceConfig&)>& change) {
    config_ = good;
    change(config_);
    return refusal();
  };
  EXPECT_THAT(with([](auto& c) { c.topics = {"/slam/pose"}; }),
              AllOf(HasSubstr("/slam/pose"), HasSubstr("/boxes"), HasSubstr("rtd/features")));
  EXPECT_THAT(with([](auto& c) { c.start_offset_s = 99; }), HasSubstr("long"));
  EXPECT_THAT(with([](auto& c) { c.remap = {"/a=/b"}; }), HasSubstr("old:=new"));
  EXPECT_THAT(with([](auto& c) { c.remap = {"/boxes:=rtd/features"}; }), HasSubstr("two types"));
  config_ = good;
  config_.topics = {"/boxes"};
  EXPECT_THAT(refusal(service::Pace::kLockstep), HasSubstr("or rtd/features is not among"));
}

TEST(ReplayOptions, speeds_and_times_have_limits) {
  ServiceConfig config;
  service::ConfigBinder binder;
  binder.section("replay", config);
  const auto refusal = [&binder](const service::GivenOption& option) -> std::string {
    try {
      binder.set(option);
    } catch (const service::ConfigError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(refusal({"replay.rate", "--rate", {"0"}}), "accepted");
  EXPECT_THAT(refusal({"replay.rate", "--rate", {"-1"}}), HasSubstr("--rate -1 is not allowed: use a number from 0"));
  EXPECT_THAT(refusal({"replay.rate", "--rate", {".nan"}}), HasSubstr("--rate .nan"));
  EXPECT_THAT(refusal({"replay.start_offset_s", "--start-offset", {".nan"}}), HasSubstr("--start-offset"));
}

}  // namespace
}  // namespace rtd::replay
