// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/recorder/recorder_service.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>

#include "common/bus/raw_bus.hpp"
#include "common/io/recording_forms.hpp"
#include "common/mcap/records.hpp"
#include "common/service/command_line.hpp"
#include "common/service/log.hpp"
#include "common/service/metric_names.hpp"
#include "common/service/model_locator.hpp"

namespace rtd::recorder {
namespace {

constexpr std::chrono::milliseconds kIdle{20};
constexpr io::FileKind kRecordings{"recording", io::kMcapExtension, mcap::kMagic, "--recordings-dir"};

/// Of the recordings that a command may name.
std::string folder_of(const ServiceConfig& config) {
  if (!config.folder.empty()) return config.folder;
  if (!config.output.empty()) return OutputFiles(config.output, true).folder().string();
  const std::string state = service::state_folder(service::process_environment());
  return state.empty() ? "." : state;
}

}  // namespace

void RecorderService::add_options(CLI::App& app, std::vector<service::GivenOption>&) {
  app.footer(
      "rtd record recover FILE          write what is intact in a damaged or unfinished recording to a new file\n"
      "rtd record join FOLDER -o FILE   join the parts of a split recording\n"
      "Exit code 3: recorded, but messages were lost; the report, the log and the file list them.");
}

RecorderService::RecorderService(const Config& config, service::Runtime& runtime)
    : config_(config), recordings_(folder_of(config), kRecordings), runtime_(runtime) {
  if (!config_.wait) session_.emplace(config_, runtime_);
}

service::ExitCode RecorderService::run() {
  bus::BusOptions options = runtime_.bus_options;
  options.participant_name = "rtd-record-topics";
  bus_ = bus::connect_raw(options);
  if (session_) session_->listen(*bus_);
  offer_commands();
  show_recording();
  while (!runtime_.stop.stop_requested() && !ended_early_) {
    runtime_.heartbeat.tick();
    commands_->serve();
    if (!session_) {
      runtime_.stop.wait_for(kIdle);
    } else if (!session_->turn()) {
      ended_early_ = true;
    }
  }
  commands_->close();
  end_session();
  return result_;
}

void RecorderService::offer_commands() {
  using bus::CommandKind;
  using bus::CommandRequest;
  commands_.emplace(runtime_.bus);
  commands_->offer("recorder/start", CommandKind::kText,
                   [this](const CommandRequest& asked) { return start(asked.argument); });
  commands_->offer("recorder/stop", CommandKind::kTrigger, [this](const CommandRequest&) { return stop(); });
}

/// What the operator has configured, once; a name of its own, or the one that a command gives, in the folder of
/// recordings.
std::string RecorderService::output_of(const std::string& name) const {
  if (!name.empty()) return recordings_.to_write(name).string();
  return config_.output.empty() ? (recordings_.folder() / dated_name()).string() : config_.output;
}

bus::CommandAnswer RecorderService::start(const std::string& name) {
  if (session_) return {false, "already recording to " + session_->path() + ": end it first with /recorder/stop"};
  Config config = config_;
  try {
    config.output = output_of(name);
    session_.emplace(config, runtime_);
  } catch (const service::ConfigError& error) {
    return {false, error.what()};
  } catch (const io::NameError& error) {
    return {false, error.what()};
  }
  config_.output.clear();  // the next one gets its own name
  session_->listen(*bus_);
  show_recording();
  SPDLOG_INFO("event=started_by_command path={}", session_->path());
  return {true, "recording to " + session_->path()};
}

bus::CommandAnswer RecorderService::stop() {
  if (!session_) return {false, "nothing is being recorded: start it with /recorder/start"};
  const std::string path = session_->path();
  const service::ExitCode code = session_->finish();
  const TopicCounts totals = session_->totals();
  const std::string failure = session_->failure(), size = service::bytes_text(session_->bytes());
  session_.reset();
  config_.output.clear();
  result_ = std::max(result_, code);
  SPDLOG_INFO("event=stopped_by_command path={}", path);
  show_recording();
  const std::string lost = totals.lost() > 0 ? fmt::format(", {} lost", totals.lost()) : ", none lost";
  const std::string text = fmt::format("recorded {} messages{}, {}, to {}", totals.written, lost, size, path);
  return {failure.empty(), failure.empty() ? text : text + "; ended early: " + failure};
}

void RecorderService::end_session() {
  if (!session_) return;
  result_ = std::max(result_, session_->finish());
  session_.reset();
}

void RecorderService::show_recording() {
  runtime_.heartbeat.set_metric(service::metric::kRecording, session_ ? 1 : 0);
  if (session_) return;  // it shows its own state
  runtime_.heartbeat.set_state(msg::ServiceState::kReady, "not recording: /recorder/start begins");
}

}  // namespace rtd::recorder
