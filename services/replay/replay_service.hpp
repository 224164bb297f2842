// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/recordings/open.hpp"
#include "common/service/config.hpp"
#include "common/service/exit_code.hpp"
#include "common/service/patience.hpp"
#include "common/service/runtime.hpp"
#include "services/replay/input.hpp"
#include "services/replay/outputs.hpp"
#include "services/replay/replay_commands.hpp"
#include "services/replay/replay_report.hpp"

namespace CLI {
class App;
}

namespace rtd::replay {

/// Section `replay` of the configuration.
struct ServiceConfig {
  std::string file;
  double rate = 1;
  bool loop = false;
  double start_offset_s = 0, duration_s = 0;
  std::vector<std::string> topics, exclude;
  std::vector<std::string> remap;
  double clock_hz = 0;
  bool pause = false, hold = false, wait_page = false;
  int read_ahead_mb = 64;
  std::string lockstep;  ///< with --pace lockstep or asap an empty topic becomes rtd/tracking
  std::string paced_topic;
  int asap_window = 3;
  int resend_after_ms = 2000;
  double result_timeout_s = 1e-3 * service::kEveryFramePatience.result_ms;
  std::vector<std::string> wait_for;
  double start_timeout_s = 30;
  double wait_readers_s = 1;
  std::vector<std::string> stand_in;
  bool restamp = false;
  bool json = false;

  void bind(auto& binder) {
    constexpr double kLongestS = 1e9;
    binder.field("file", file, "recording, or the folder with it").option("file");
    binder.field("rate", rate, {0, 1000}, "speed, 1 = as recorded, 0 = as fast as possible").option("-r,--rate");
    binder.field("loop", loop, "start again at the end").option("-l,--loop");
    binder.field("start_offset_s", start_offset_s, {0, kLongestS}, "start so many seconds after the first message")
        .option("--start-offset");
    binder.field("duration_s", duration_s, {0, kLongestS}, "play so many seconds, 0 = to the end").option("--duration");
    binder
        .field("topics", topics,
               "play only these topics or patterns, e.g. rtd/frame '/slam/*'; empty = all but rtd/status")
        .option("--topics");
    binder.field("exclude", exclude, "leave these topics or patterns out").option("--exclude");
    binder.field("remap", remap, "rename topics: old:=new").option("-m,--remap");
    binder.field("clock_hz", clock_hz, {0, 10000}, "rate of /clock, 0 = none, 40 without a number").option("--clock");
    binder.field("pause", pause, "start paused (space continues)").option("-p,--pause,--start-paused");
    binder.field("hold", hold, "pause at the end instead of ending (space begins again, q ends)").option("--hold");
    binder.field("wait_page", wait_page, "start when a page of rtd viewer is open").option("--wait-page");
    binder.field("read_ahead_mb", read_ahead_mb, {1, 16384}, "megabytes read before they are due")
        .option("--read-ahead");
    binder.field("lockstep", lockstep, "topic whose messages let the next message of paced_topic go, e.g. rtd/tracking")
        .option("--lockstep");
    binder.field("paced_topic", paced_topic, "topic that waits for answers; empty = rtd/frame, else rtd/features")
        .option("--paced-topic");
    binder.field("asap_window", asap_window, {1, 3}, "messages without an answer at a time, pace asap");
    binder.field("resend_after_ms", resend_after_ms, {10, 60000}, "silence after which messages are sent again");
    binder.field("result_timeout_s", result_timeout_s, {0.1, 3600}, "silence after which the replay has failed");
    binder.field("wait_for", wait_for, "services that must be ready before the first message").option("--wait-for");
    binder.field("start_timeout_s", start_timeout_s, {0, 3600}, "longest wait for these services and for the answers");
    binder.field("wait_readers_s", wait_readers_s, {0, 3600}, "longest wait for readers of reliable topics, s")
        .option("--wait-readers");
    binder.field("stand_in", stand_in, "services to send heartbeats for, e.g. detector: others rely on its messages")
        .option("--stand-in");
    binder.field("restamp", restamp, "set published_ns of our frames and features to the time of the replay")
        .option("--restamp");
    binder.field("json", json, "print a report in JSON at the end").option("--json");
  }
};

/// rtd-replay: publishes a recording, byte for byte (services/replay/README.md).
class ReplayService final : public PlayerHost {
 public:
  static constexpr const char* kName = "replay";
  static constexpr const char* kDescription = "Replay a recording (MCAP)";
  using Config = ServiceConfig;
  static void add_options(CLI::App& app, std::vector<service::GivenOption>& given);

  /// Opens the recording and its topics; throws ConfigError when they cannot be used.
  ReplayService(const Config& config, service::Runtime& runtime);

  service::ExitCode run();

  std::int64_t now_ns() override;
  std::optional<Event> wait_until(std::int64_t deadline_ns) override {
    return inbox_->pop_for(std::chrono::nanoseconds(deadline_ns - now_ns()));
  }
  void send(const PlayedMessage& message) override { outputs_->send(message); }
  void send_clock(std::int64_t recorded_ns) override { outputs_->send_clock(recorded_ns); }
  std::optional<std::uint64_t> paced_seq(const PlayedMessage& message) override;
  bool ends_step(const PlayedMessage& message) override { return step_ends_.contains(message.channel); }
  void show(const PlayState& state) override;

 private:
  void open();
  void choose_topics();
  std::string recorded_robot(const std::vector<std::string>& topics) const;
  void choose_paced_topic();
  void choose_span();
  void choose_step_ends();
  bool wait_for_services();
  bool wait_for_page();
  bool wait_for_readers();
  bool subscribe_to_answers();
  std::string answers_topic() const;
  service::ExitCode play();
  service::ExitCode finish(const Player& player, PlayOutcome outcome);
  service::ExitCode fail(const std::string& message);

  Config config_;
  service::Runtime& runtime_;
  int window_;
  recordings::Opened recording_;
  std::unique_ptr<mcap::IndexedReader> reader_;
  std::vector<const mcap::Channel*> channels_;  ///< the ones played
  std::vector<const mcap::Channel*> left_out_;  ///< wanted, but not in CDR
  std::int64_t first_ns_ = 0, start_ns_ = 0, end_ns_ = 0;
  std::shared_ptr<Inbox> inbox_;
  std::shared_ptr<bus::RawBus> bus_;
  std::unique_ptr<Outputs> outputs_;
  const Output* paced_ = nullptr;
  std::vector<std::unique_ptr<service::Heartbeat>> stand_ins_;
  std::unique_ptr<bus::RawReader> answers_;
  std::unique_ptr<StatusLine> line_;
  std::set<mcap::ChannelId> step_ends_;
  std::int64_t next_metrics_ns_ = 0;
  std::pair<bool, double> shown_;             ///< paused, rate
  std::unique_ptr<ReplayCommands> commands_;  // last: it uses the inbox
};

}  // namespace rtd::replay
