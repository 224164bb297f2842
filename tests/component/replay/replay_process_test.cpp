// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// rtd-replay as a user runs it, over Fast DDS: recording, replay, recording.
#include <gmock/gmock.h>
#include <pty.h>
#include <sys/wait.h>
#include <termios.h>

#include <nlohmann/json.hpp>
#include <thread>

#include "common/bus/bus_factory.hpp"
#include "common/bus/commands.hpp"
#include "common/msg/rgbd_frame.hpp"
#include "tests/component/launcher/rtd_command.hpp"
#include "tests/component/replay/raw_recording.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/test_domain.hpp"

namespace rtd::replay {
namespace {

constexpr std::int64_t kMillisecondNs = 1'000'000, kProcessEpoch = 1'700'000'000'000'000'000;

class ReplayProcessTest : public testing::Test {
 protected:
  ReplayProcessTest() {
    options_.domain = test_domain();
    options_.participant_name = "replay-test";
    raw_ = bus::connect_raw(options_);
  }
  std::vector<std::string> arguments(const std::vector<std::string>& more) const {
    std::vector<std::string> all = {file_, "--domain", std::to_string(options_.domain), "--json"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  /// The JSON among what the process printed.
  nlohmann::json report() const {
    const std::string& output = replay_.output();
    const std::size_t begin = output.find("{\n"), end = output.rfind("\n}");
    return nlohmann::json::parse(output.substr(begin, end + 2 - begin));
  }
  /// Raw frames at 30 Hz, boxes of changing size behind each, poses at 100 Hz. Sizes are multiples of 4, as all that
  /// was recorded from a wire: there RTPS fills up to that.
  static std::vector<Piece> camera_like(std::uint64_t frames) {
    std::vector<Piece> pieces;
    for (std::uint64_t i = 0; i < frames; ++i) {
      const std::int64_t time_ns = kProcessEpoch + static_cast<std::int64_t>(i) * 33'333'333;
      pieces.push_back({"rtd/frame", time_ns, time_ns - 2 * kMillisecondNs, cdr_of(i, sizeof(msg::RgbdFrame))});
      pieces.push_back({"rt/boxes", time_ns + kMillisecondNs, time_ns, cdr_of(i, 20 + 12 * i)});
      for (std::int64_t k = 0; k < 3; ++k)
        pieces.push_back({"rt/pose", time_ns + (2 + 10 * k) * kMillisecondNs, time_ns + k, cdr_of(3 * i + k, 100)});
    }
    return pieces;
  }

  const rtd::test::TemporaryFolder folder_;
  const std::string file_ = folder_.file("a.mcap");
  bus::BusOptions options_;
  std::shared_ptr<bus::RawBus> raw_;
  launcher::RtdCommand replay_{RTD_REPLAY};
};

TEST_F(ReplayProcessTest, record_replay_record_keeps_bytes_order_and_publish_times) {
  const std::vector<Piece> recorded = camera_like(30);
  write_recording(file_, recorded);
  Recorder recorder(*raw_);
  ASSERT_EQ(replay_.run(arguments({})), 0) << replay_.output();
  const std::vector<Piece> again = recorder.wait(recorded.size());
  for (const char* topic : {"rtd/frame", "rt/boxes", "rt/pose"}) expect_same(recorded, again, topic);
  const nlohmann::json json = report();
  EXPECT_EQ(json["sent"], recorded.size());
  EXPECT_EQ(json["refused"], 0);
  EXPECT_EQ(json["timing_error_ms"]["messages"], recorded.size() - 1);
  // No bound: a busy host makes any. Bounds hold in player_test, where time is given.
  RecordProperty("timing_error_p99_ms", json["timing_error_ms"]["p99"].dump());
}

TEST_F(ReplayProcessTest, as_fast_as_possible_keeps_everything_too) {
  const std::vector<Piece> recorded = camera_like(40);
  write_recording(file_, recorded);
  Recorder recorder(*raw_);
  ASSERT_EQ(replay_.run(arguments({"--rate", "0"})), 0) << replay_.output();
  const std::vector<Piece> again = recorder.wait(recorded.size());
  for (const char* topic : {"rtd/frame", "rt/boxes", "rt/pose"}) expect_same(recorded, again, topic);
}

/// Whatever its vendor and ours are.
TEST_F(ReplayProcessTest, obeys_commands_of_other_programs) {
  write_recording(file_, camera_like(20));
  for (const std::string& vendor : bus::dds_vendors()) {
    launcher::RtdCommand replay{RTD_REPLAY};
    replay.start(arguments({"--start-paused", "--dds", vendor}));
    bus::CommandClient client(options_);
    EXPECT_EQ(client.call("replay/step", "", 20'000).message, "one frame further, paused at 0.0 s of 0.7 s, speed 1");
    EXPECT_EQ(client.call("replay/seek", "0.5", 20'000).message, "continues at 0.5 s of 0.7 s, speed 1");
    EXPECT_EQ(client.call("replay/seek", "0", 20'000).message, "continues at 0.0 s of 0.7 s, speed 1") << "back";
    EXPECT_TRUE(client.call("replay/pause", "false", 20'000).success);
    EXPECT_EQ(replay.wait(), 0) << replay.output();
  }
}

TEST_F(ReplayProcessTest, ctrl_c_ends_an_endless_replay) {
  write_recording(file_, camera_like(3));
  replay_.start(arguments({"--loop", "--clock"}));
  Recorder recorder(*raw_);
  EXPECT_GT(recorder.wait(30).size(), 15U);
  replay_.interrupt();
  EXPECT_EQ(replay_.wait(), 0) << replay_.output();
  EXPECT_EQ(report()["outcome"], "stopped");
  EXPECT_FALSE(of_topic(recorder.wait(0), "rt/clock").empty());
}

/// On a terminal of its own: two steps and the end.
TEST_F(ReplayProcessTest, keys_step_and_end_a_paused_replay_and_the_terminal_is_restored) {
  write_recording(file_, camera_like(3));
  Recorder recorder(*raw_);
  int terminal = -1;
  const std::string domain = std::to_string(options_.domain);
  const pid_t replay = forkpty(&terminal, nullptr, nullptr, nullptr);
  if (replay == 0) {
    execl(RTD_REPLAY, RTD_REPLAY, file_.c_str(), "--domain", domain.c_str(), "--pause", nullptr);
    _exit(127);
  }
  termios before{}, during{}, after{};
  tcgetattr(terminal, &before);
  const auto raw_mode = [&] { return tcgetattr(terminal, &during) == 0 && (during.c_lflag & ICANON) == 0; };
  for (int i = 0; i < 500 && !raw_mode(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_TRUE(raw_mode());
  ASSERT_EQ(write(terminal, "s", 1), 1);
  ASSERT_EQ(write(terminal, "\x1b[C", 3), 3);
  EXPECT_EQ(recorder.wait(2).size(), 2U);
  ASSERT_EQ(write(terminal, "q", 1), 1);
  int status = -1;
  for (int i = 0; i < 500 && waitpid(replay, &status, WNOHANG) == 0; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
  EXPECT_EQ(tcgetattr(terminal, &after), 0);
  EXPECT_EQ(after.c_lflag, before.c_lflag);
  close(terminal);
}

TEST_F(ReplayProcessTest, wrong_use_is_exit_code_2_with_the_reason) {
  EXPECT_EQ(replay_.run({"/nonexistent/x.mcap", "--domain", "99"}), 2);
  EXPECT_THAT(replay_.output(), testing::HasSubstr("/nonexistent/x.mcap"));
}

}  // namespace
}  // namespace rtd::replay
