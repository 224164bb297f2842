// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "common/io/byte_source.hpp"
#include "common/service/exit_code.hpp"
#include "common/service/runtime.hpp"
#include "services/replay/config.hpp"
#include "services/replay/input.hpp"
#include "services/replay/outputs.hpp"
#include "services/replay/replay_report.hpp"

namespace CLI {
class App;
}

namespace rtd::replay {

/// rtd-replay: publishes a recording, byte for byte (services/replay/README.md).
class ReplayService final : public PlayerHost {
 public:
  static constexpr const char* kName = "replay";
  static constexpr const char* kDescription = "Replay a recording (MCAP)";
  using Config = ServiceConfig;
  static void add_options(CLI::App& app, Config& config);

  /// Opens the recording and its topics; throws ConfigError when they cannot be used.
  ReplayService(const Config& config, service::Runtime& runtime);

  service::ExitCode run();

  std::int64_t now_ns() override;
  std::optional<Event> wait_until(std::int64_t deadline_ns) override { return inbox_->take_until(deadline_ns); }
  void send(const PlayedMessage& message) override { outputs_->send(message); }
  void send_clock(std::int64_t recorded_ns) override { outputs_->send_clock(recorded_ns); }
  std::optional<std::uint64_t> paced_seq(const PlayedMessage& message) override;
  void show(const PlayState& state) override;

 private:
  void open();
  void choose_topics();
  void choose_paced_topic();
  void choose_span();
  bool wait_for_services();
  bool wait_for_readers();
  bool subscribe_to_answers();
  service::ExitCode play();
  service::ExitCode finish(const Player& player, PlayOutcome outcome);
  void log_problems() const;
  service::ExitCode fail(const std::string& message);

  Config config_;
  service::Runtime& runtime_;
  int window_;
  std::unique_ptr<io::FileSource> source_;
  std::unique_ptr<mcap::IndexedReader> reader_;
  std::vector<const mcap::Channel*> channels_;  ///< the ones played
  std::int64_t first_ns_ = 0, start_ns_ = 0, end_ns_ = 0;
  std::shared_ptr<Inbox> inbox_;
  std::shared_ptr<bus::RawBus> bus_;
  std::unique_ptr<Outputs> outputs_;
  const Output* paced_ = nullptr;
  std::vector<std::unique_ptr<service::Heartbeat>> stand_ins_;
  std::unique_ptr<bus::RawReader> answers_;
  std::unique_ptr<StatusLine> line_;
  std::int64_t next_metrics_ns_ = 0;
};

}  // namespace rtd::replay
