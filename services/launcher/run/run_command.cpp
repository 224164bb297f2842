// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/launcher/run/run_command.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <fstream>
#include <iostream>

#include "common/bus/bus_factory.hpp"
#include "common/service/run_service.hpp"
#include "services/camera/core/frame_source.hpp"
#include "services/evaluation/core/report/report.hpp"
#include "services/launcher/core/run/online_trajectory.hpp"
#include "services/launcher/run/run_session.hpp"
#include "services/launcher/run/run_setup.hpp"
#include "services/launcher/run/run_summary_text.hpp"

namespace rtd::launcher {
namespace {

constexpr std::chrono::milliseconds kEndOfBus{4000};

Terminal open_terminal(bool quiet) {
  Terminal::Options options;
  options.interactive = isatty(STDERR_FILENO) == 1;
  options.quiet = quiet;
  winsize size{};
  if (ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 20) options.columns = size.ws_col;
  return Terminal(std::cerr, options);
}

void tell_setup(const RunSetup& setup, Terminal& terminal) {
  if (!setup.weights_advice.empty()) terminal.warn("rtd: geometry only: " + setup.weights_advice);
  terminal.say(fmt::format("source {}{}, pace {}, filter {}, detector {}, {} domain {}", setup.source,
                           setup.total_frames > 0 ? fmt::format(" ({} frames)", setup.total_frames) : "", setup.pace,
                           setup.filter_mode,
                           setup.model_path.empty() && !setup.remote_detector ? "off" : setup.detector_note,
                           setup.bus.vendor, setup.bus.domain));
}

service::ExitCode exit_code(RunOutcome outcome, bool tracked_any) {
  switch (outcome) {
    case RunOutcome::kInterrupted:
      return service::kInterrupted;
    case RunOutcome::kConfigError:
      return service::kUsageOrConfig;
    case RunOutcome::kComplete:
      return tracked_any ? service::kOk : service::kRunFailed;
    case RunOutcome::kFailed:
    case RunOutcome::kRunning:
      break;
  }
  return service::kRunFailed;
}

/// Everything that the run leaves in its folder beside what slam wrote. A run that slam could not finish is judged by
/// the poses as they were published.
void write_results(const RunSetup& setup, RunResult& result) {
  const std::string online_path = setup.out_dir + "/trajectory_online.txt";
  std::ofstream(online_path) << online_trajectory_text(result.record.frames);
  if (result.record.trajectory_path.empty() && !result.record.frames.empty()) {
    result.record.trajectory_path = online_path;
    result.record.events.emplace_back("slam left no trajectory.txt: judged by the poses as they were published");
  }
  result.summary = write_report(result.record, setup.out_dir);
}

RunResult run_prepared(const RunSetup& setup, const std::vector<ServicePlan>& plans, bool quiet) {
  service::InterruptSignals signals;
  Terminal terminal = open_terminal(quiet);
  service::BoundedEnd end("rtd run", kEndOfBus);
  const std::shared_ptr<bus::Bus> bus = bus::connect(setup.bus);
  tell_setup(setup, terminal);
  RunSession session(setup, *bus, signals, terminal);

  RunResult result;
  const RunOutcome outcome = session.run(plans);
  result.code = exit_code(outcome, session.tracked_any());
  if (outcome == RunOutcome::kConfigError) return result;
  result.record = session.record();
  write_results(setup, result);
  if (!quiet) std::cout << run_summary_text(result.record, *result.summary, setup.out_dir) << std::flush;
  if (outcome == RunOutcome::kComplete && !session.tracked_any()) terminal.warn("rtd: no frame got a pose");
  if (outcome != RunOutcome::kInterrupted) return result;
  terminal.say("rtd: interrupted, partial results are in " + setup.out_dir);
  end.begin(result.code);
  return result;
}

RunResult refuse(service::ExitCode code, const std::exception& error) {
  std::cerr << "rtd run: " << error.what() << '\n';
  return {code, {}, std::nullopt};
}

}  // namespace

RunResult run(const RunOptions& options) {
  try {
    const RunSetup setup = prepare_run(options);
    return run_prepared(setup, plan_services(setup), options.quiet);
  } catch (const service::ConfigError& error) {
    return refuse(service::kUsageOrConfig, error);
  } catch (const camera::SourceError& error) {
    return refuse(service::kUsageOrConfig, error);
  } catch (const bus::BusError& error) {
    return refuse(service::kUsageOrConfig, error);
  } catch (const std::exception& error) {
    return refuse(service::kRunFailed, error);
  }
}

}  // namespace rtd::launcher
