// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/launcher/run/run_command.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <optional>
#include <ostream>
#include <set>
#include <vector>

#include "common/bus/bus_factory.hpp"
#include "common/bus/host/ring_folder.hpp"
#include "common/camera/frame_source.hpp"
#include "common/camera/live_uri.hpp"
#include "common/io/atomic_file.hpp"
#include "common/io/input_file.hpp"
#include "common/io/text.hpp"
#include "common/process/executable.hpp"
#include "common/process/out_folder.hpp"
#include "common/run_record/run_record.hpp"
#include "common/service/command_line.hpp"
#include "common/service/log.hpp"
#include "common/service/run_service.hpp"
#include "common/service/standard_streams.hpp"
#include "common/service/trace.hpp"
#include "services/launcher/core/run/record_builder.hpp"
#include "services/launcher/run/run_session.hpp"

namespace rtd::launcher {

namespace fs = std::filesystem;

namespace {

/// Lines that are whole: a killed process leaves half a line.
void join_parts(const std::set<fs::path>& parts, std::ostream& joined) {
  joined << R"({"displayTimeUnit":"ms","traceEvents":[)";
  const char* separator = "\n";
  for (const fs::path& part : parts) {
    io::InputStream lines(part);
    for (std::string line; io::get_line(lines, line);) {
      if (!line.ends_with("}}")) continue;
      joined << separator << line;
      separator = ",\n";
    }
  }
  joined << "\n]}\n";
}

}  // namespace

std::string join_trace(const std::string& folder, const std::string& path) {
  std::error_code error;
  std::set<fs::path> parts;  // by name: the same order each time
  for (const auto& entry : fs::directory_iterator(folder, error)) parts.insert(entry.path());
  if (error) return folder + ": " + error.message();
  try {
    io::write_file(path, [&](std::ostream& joined) { join_parts(parts, joined); },
                   {.named_by = io::NamedBy::kOperator});
  } catch (const io::IoError& failure) {
    return failure.what();
  }
  fs::remove_all(folder, error);
  return error ? folder + ": " + error.message() : "";
}

namespace {

struct Cause {
  double frames = 0;
  std::string name;  ///< as in the report
  std::string text;  ///< what is wrong and what helps
};

std::vector<Cause> causes_of(const run_record::RunRecord& record) {
  std::vector<Cause> causes;
  for (const auto& [name, count] : record.left_out)
    if (const auto reason = camera::skip_reason_of(name)) causes.push_back({count, name, camera::explain(*reason)});
  causes.push_back(
      {static_cast<double>(record.frames_not_played), "not_played", "the run ended before them: the events say why"});
  double late = 0;
  if (const auto found = record.drops.find("camera.late"); found != record.drops.end()) late = found->second;
  causes.push_back({late, "late",
                    "they came too late for pace realtime: --pace lockstep plays every frame, a smaller image or a "
                    "lower rate costs less"});
  causes.push_back({static_cast<double>(record.frames_dropped) - late, "without_answer",
                    "slam gave no result for them: logs/slam.log and logs/filter.log say more"});
  causes.push_back({static_cast<double>(record.frames_out_of_range), "out_of_range",
                    "no pixel has a depth between 0.1 and 20 m: is the unit of depth right (depth_factor in the "
                    "calibration), is the sensor covered?"});
  return causes;
}

const char* const kOtherCamera = camera::to_string(camera::SkipReason::kOtherCamera);

std::vector<std::string> deaths_on_the_way(const run_record::RunRecord& record) {
  return run_record::deaths(record, {"camera", "filter", "slam"});
}

}  // namespace

bool died_with_frames(const run_record::RunRecord& record) {
  if (camera::is_live(record.source) && !run_record::deaths(record, {"camera"}).empty()) return true;
  return record.frames_dropped + record.frames_not_played > 0 && !deaths_on_the_way(record).empty();
}

bool is_partial(const run_record::RunRecord& record) {
  return run_record::frame_use(record).too_few() || died_with_frames(record) || record.left_out.contains(kOtherCamera);
}

std::string why_not_used(const run_record::RunRecord& record, const std::string& first_left_out) {
  const run_record::FrameUse use = run_record::frame_use(record);
  if (died_with_frames(record))
    return fmt::format("only {} of {} frames were used: {}", use.used, use.given,
                       fmt::join(deaths_on_the_way(record), "; "));
  const std::vector<Cause> causes = causes_of(record);
  const auto other = std::ranges::find(causes, kOtherCamera, &Cause::name);
  if (other == causes.end() && 10 * use.used >= 9 * use.given) return {};
  const Cause most = other == causes.end() ? *std::ranges::max_element(causes, {}, &Cause::frames) : *other;
  std::string text = fmt::format("only {} of {} frames were used; {:.0f} x {}: {}", use.used, use.given, most.frames,
                                 most.name, most.text);
  if (record.left_out.contains(most.name) && !first_left_out.empty())
    text += fmt::format(" (first left out: {})", first_left_out);
  return text;
}

namespace {

/// A pipe without a reader is full after 64 kB, a terminal after Ctrl-S.
bool takes_line(int fd) {
  pollfd output{fd, POLLOUT, 0};
  return poll(&output, 1, 0) != 0;
}

Terminal open_terminal(bool quiet) {
  Terminal::Options options;
  options.interactive = isatty(STDERR_FILENO) == 1;
  options.quiet = quiet;
  const char *no_color = std::getenv("NO_COLOR"), *term = std::getenv("TERM");
  const bool plain = (no_color != nullptr && *no_color != '\0') || term == nullptr || std::string_view(term) == "dumb";
  options.color = options.interactive && !plain;
  options.has_room = [] { return takes_line(STDERR_FILENO); };
  winsize size{};
  if (ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 20) options.columns = size.ws_col;
  return Terminal(std::clog, options);
}

void print_setup(const RunSetup& setup, Terminal& terminal) {
  if (!setup.weights_advice.empty()) terminal.warn("rtd: geometry only: " + setup.weights_advice);
  for (const bus::EnvironmentSetting& setting : setup.bus_options.environment) {
    setting.followed ? terminal.print("rtd: " + setting.text) : terminal.warn("rtd: " + setting.text);
  }
  terminal.print(fmt::format("source {}{}, pace {}, filter {}, detector {}, {} domain {}", setup.source,
                             setup.total_frames > 0 ? fmt::format(" ({} frames)", setup.total_frames) : "", setup.pace,
                             setup.services.filter_mode,
                             setup.model_path.empty() && !setup.remote_detector ? "off" : setup.detector_note,
                             setup.bus_options.vendor, setup.bus_options.domain));
  for (const std::string& note : setup.source_notes) terminal.print("  " + note);
}

service::ExitCode exit_code(RunOutcome outcome, bool tracked_any, bool partial) {
  if (outcome == RunOutcome::kInterrupted) return service::kInterrupted;
  if (outcome == RunOutcome::kConfigError) return service::kUsageOrConfig;
  if (outcome != RunOutcome::kComplete || !tracked_any) return service::kRunFailed;
  return partial ? service::kPartialLoss : service::kOk;
}

/// What the launcher leaves in the folder of the run besides what the services wrote.
void write_record(const run_record::RunRecord& record, const std::string& out_dir) {
  io::write_file(out_dir + "/trajectory_online.txt", online_trajectory_text(record.frames));
  run_record::write_run_json(record, out_dir + "/run.json");
}

/// Of a slam that was restarted in its own world trajectory.txt begins with the poses that it published before.
void join_trajectory(run_record::RunRecord& record, const std::string& out_dir) {
  const std::string file = out_dir + "/trajectory.txt";
  const std::optional<std::string> last = io::try_read_file(file, io::kResults);
  const auto lines = last ? io::split_lines(*last) : std::vector<io::TextLine>();
  const std::optional<double> first_s = lines.empty() ? std::nullopt : io::parse_number(lines.front().fields.front());
  if (!first_s) return;
  constexpr double kNsPerS = 1e9;
  const std::int64_t first_ns = std::llround(*first_s * kNsPerS) - 1000;  // stamps are written in microseconds
  const std::string before = online_trajectory_text(record.frames, first_ns);
  if (before.empty()) return;
  io::write_file(file, before + *last);
  record.events.push_back(
      fmt::format("slam was restarted with its map: in trajectory.txt the {} poses before are those it had published",
                  std::ranges::count(before, '\n')));
}

struct Report {
  ReportState state = ReportState::kNone;
  bool interrupted = false;  ///< Ctrl-C came while it was made
};

/// rtd-eval makes the report from run.json and prints the table that ends a run.
Report make_report(const std::string& out_dir, bool quiet, service::InterruptSignals& signals, Terminal& terminal) {
  const std::string executable = process::find_executable("rtd-eval");
  if (executable.empty()) {
    terminal.warn("rtd: no report: " + process::missing_executable("rtd-eval") + ", then run 'rtd report " + out_dir +
                  "'");
    return {};
  }
  std::string output;
  std::vector<std::string> command = {executable, "report", out_dir};
  if (quiet) command.emplace_back("--quiet");
  const process::ProcessExit exit =
      process::run_to_end({.name = "rtd-eval", .command = command, .reads_signals = true}, signals,
                          [&](const std::string&, const std::string& line) { output += line + '\n'; });
  (exit.clean() ? std::cout : std::cerr) << output << std::flush;
  if (exit.clean()) return {ReportState::kWritten, exit.interrupted};
  terminal.warn("rtd: no report: rtd-eval: " + describe(exit) + "; " + out_dir +
                "/run.json has the data of the run: 'rtd report " + out_dir + "' makes it");
  return {ReportState::kFailed, exit.interrupted};
}

/// The services inherit where to write their parts.
void begin_trace(const RunSetup& setup) {
  if (!setup.trace.empty()) ::setenv(service::kTraceVariable, setup.trace_folder().c_str(), 1);
}

void end_trace(const RunSetup& setup, Terminal& terminal) {
  if (setup.trace.empty()) return;
  ::unsetenv(service::kTraceVariable);
  const std::string problem = join_trace(setup.trace_folder(), setup.trace);
  problem.empty() ? terminal.print("rtd: trace for ui.perfetto.dev: " + setup.trace)
                  : terminal.warn("rtd: no trace: " + problem);
}

RunResult run_prepared(const RunSetup& setup, const std::vector<ServicePlan>& plans) {
  service::InterruptSignals signals;
  Terminal terminal = open_terminal(setup.quiet);
  service::init_logging("launcher", "warn");
  service::BoundedEnd end("rtd run");
  const std::shared_ptr<bus::Bus> bus = bus::connect(setup.bus_options);
  std::optional<bus::RingsOfRun> rings;
  if (setup.vendors_of.empty()) rings.emplace();  // what another vendor sends is in no ring
  print_setup(setup, terminal);
  RunSession session(setup, *bus, signals, terminal);

  RunResult result{.detector = setup.detector_note};
  begin_trace(setup);
  const RunOutcome outcome = session.run(plans);
  end_trace(setup, terminal);
  run_record::RunRecord record = session.record();
  const std::string not_used = why_not_used(record, session.camera_message());
  result.code = exit_code(outcome, session.tracked_any(), is_partial(record) || session.slam_lost_its_world());
  if (outcome == RunOutcome::kConfigError) return result;
  if (!not_used.empty()) record.events.push_back(not_used);
  if (session.slam_kept_its_world()) join_trajectory(record, setup.out_dir);
  write_record(record, setup.out_dir);
  const Report report = make_report(setup.out_dir, setup.quiet, signals, terminal);
  result.report = report.state;
  if (result.report == ReportState::kFailed) result.code = service::kRunFailed;
  if (outcome == RunOutcome::kComplete && !session.tracked_any()) terminal.warn("rtd: no frame got a pose");
  if (outcome != RunOutcome::kInterrupted && !not_used.empty()) terminal.warn("rtd: " + not_used);
  if (outcome == RunOutcome::kInterrupted) terminal.print("rtd: interrupted, partial results are in " + setup.out_dir);
  report.interrupted ? session.end_viewer() : session.keep_viewer();
  end.begin(result.code, outcome == RunOutcome::kInterrupted || report.interrupted ? service::BoundedEnd::kWhenAsked
                                                                                   : service::BoundedEnd::kByItself);
  return result;
}

}  // namespace

RunResult run(const RunOptions& options) {
  RunResult result;
  service::outlive_readers();
  const int code = service::report_errors<service::ConfigError, camera::SourceError, bus::BusError>(
      "rtd run", std::cerr, [&]() -> int {
        const RunSetup setup = prepare_run(options);
        const process::FolderLock folder = process::take_out_folder(setup.out_dir);
        result = run_prepared(setup, plan_services(setup));
        return result.code;
      });
  result.code = static_cast<service::ExitCode>(code);
  return result;
}

}  // namespace rtd::launcher
