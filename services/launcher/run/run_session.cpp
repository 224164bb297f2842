// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/launcher/run/run_session.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "common/camera/live_uri.hpp"
#include "common/io/input_file.hpp"
#include "common/service/metric_names.hpp"
#include "common/service/monotonic_clock.hpp"

namespace rtd::launcher {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kTick{50}, kTickOfStart{5};
constexpr milliseconds kMemoryPeriod{250};
constexpr std::size_t kShownTailLines = 6;

milliseconds now() {
  return milliseconds(service::monotonic_ns() / 1'000'000);
}

/// From the first frame handed to the bus to the last pose.
double span_s(const std::vector<run_record::FrameRecord>& frames) {
  if (frames.empty()) return 0;
  return static_cast<double>(frames.back().tracking.finished_ns - frames.front().tracking.published_ns) * 1e-9;
}

std::string restart_effect(const std::string& service) {
  if (service == "camera") return ": it continues behind the last frame";
  if (service == "slam") return ": it continues with the map from its last checkpoint, else with a new one";
  if (service == "record") return ": it continues in another file";
  return service == "dense" ? ": static_map.ply starts again" : "";
}

}  // namespace

RunSession::RunSession(const RunSetup& setup, bus::Bus& bus, service::InterruptSignals& signals, Terminal& terminal)
    : setup_(setup),
      signals_(signals),
      terminal_(terminal),
      logs_(setup.out_dir + "/logs", terminal),
      frames_(setup.out_dir),
      collector_(bus, frames_,
                 {.samples = static_cast<std::uint64_t>(setup.launcher.samples),
                  .total = setup.total_frames,
                  .held = setup.held_frames,
                  .keep_features = run_record::has_true_masks(setup.source),
                  .masks = setup.reports_masks(),
                  .secured = setup.bus_options.security.enabled()}),
      host_(
          [this](const std::string& service, const std::string& line) {
            logs_.add(service, line);
            if (service == "viewer" && line.starts_with("viewer: ")) terminal_.print("rtd: " + (viewer_line_ = line));
          },
          milliseconds(setup.launcher.hung_after_ms)),
      supervisor_(host_, setup.launcher, [this](const SupervisorEvent& event) { on_event(event); }),
      own_cpu_before_s_(own_usage().cpu_s) {}

RunOutcome RunSession::run(const std::vector<ServicePlan>& plans) {
  require_free_domain();
  clear_out_dir(setup_);
  events_ = setup_.source_remarks;  // the terminal shows them as warnings of the camera
  if (!setup_.depth_doubt.empty()) {
    note(setup_.depth_doubt);
    logs_.hide("depth_unit_doubtful");
  }
  started_ = now();
  for (std::size_t i = 0; i + 1 < plans.size(); ++i) {
    if (plans[i].awaited) awaited_.push_back(plans[i].name);
    supervisor_.start(counted(plans[i]), now());
  }
  ServicePlan source = plans.back();
  source.has_served = [this] { return collector_.ask(&RecordBuilder::frames_in) > 0; };
  if (!setup_.replay) source.when_restarted = [this] { return continue_camera(); };
  supervise(source);
  terminal_.end_status();
  return supervisor_.outcome();
}

/// Counts whether a restarted slam has a checkpoint to continue with.
ServicePlan RunSession::counted(ServicePlan plan) {
  if (plan.name != "slam" || !plan.when_restarted) return plan;
  plan.when_restarted = [this, checkpoint = plan.when_restarted] {
    std::vector<std::string> arguments = checkpoint();
    ++slam_restarts_;
    if (arguments.empty()) ++slam_worlds_lost_;
    return arguments;
  };
  return plan;
}

/// Where it stopped. A stored frame that may not have been answered is sent again; what a running camera gives next is
/// another frame.
std::vector<std::string> RunSession::continue_camera() const {
  std::vector<std::string> awaited = awaited_;
  std::erase_if(awaited, [this](const std::string& service) { return !supervisor_.runs(service); });
  awaited.emplace_back("launcher");
  std::vector<std::string> arguments = {"--wait-for", fmt::format("none,{}", fmt::join(awaited, ","))};
  const bool again = setup_.pace != "realtime" && !setup_.running_camera;
  if (const auto last = collector_.ask(again ? &RecordBuilder::last_answered : &RecordBuilder::last_seen)) {
    arguments.insert(arguments.end(),
                     {"--resume-after", fmt::format("{},{},{}", last->seq, last->stamp_ns, last->published_ns)});
  }
  return arguments;
}

/// Two runs in one domain would mix their frames until the services notice. A replay of another camera's topics is what
/// a live source may be for.
void RunSession::require_free_domain() {
  const bool live = camera::is_live(setup_.source);
  const Tolerated known{.detector = setup_.remote_detector, .harmless_replay = live};
  Tolerated at_first = known;
  at_first.silent_replay = live;
  const milliseconds until = now() + milliseconds(setup_.launcher.domain_check_ms);
  while (now() < until) {
    host_.wait(kTick);
    require_none_active(at_first);
  }
  require_none_active(known);
}

void RunSession::require_none_active(const Tolerated& tolerated) const {
  const std::string others = collector_.ask(&RecordBuilder::active_services, tolerated);
  if (others.empty()) return;
  Tolerated with_detector = tolerated;
  with_detector.detector = true;
  std::string fix = ": stop them";
  if (collector_.ask(&RecordBuilder::active_services, with_detector).empty()) {
    fix = ": use its boxes with --detector remote, stop it";
  } else if (tolerated.harmless_replay && others.starts_with("replay")) {
    fix =
        ", which plays topics of a run: leave them out (rtd replay --exclude 'rtd/*' '/slam/*' '/detector/*' "
        "'/filter/*' '/dense/*'), stop it";
  }
  const std::string& robot = setup_.bus_options.robot;
  const std::string place = "DDS domain " + std::to_string(setup_.bus_options.domain);
  if (robot.empty()) {
    throw service::ConfigError(place + " is taken by " + others + fix +
                               ", choose another domain with --domain, or give each robot a name with --robot");
  }
  throw service::ConfigError("robot '" + robot + "' in " + place + " has " + others + " already" + fix +
                             ", or choose another name with --robot");
}

/// A camera starts with the others and waits until the launcher, too, reads its frames; a replay, and what waits for a
/// page, starts only then.
void RunSession::supervise(const ServicePlan& source) {
  const bool at_once = !setup_.replay && !waits_for_page(source);
  if (at_once) supervisor_.start(source, now());
  bool plays = false;
  while (!supervisor_.all_ended() || !supervisor_.stopping()) {
    host_.wait(plays ? kTick : kTickOfStart, signals_.fd());
    const milliseconds time = now();
    if (signals_.take() > 0) {
      const bool again = supervisor_.outcome() == RunOutcome::kInterrupted;
      supervisor_.stop(time, again ? milliseconds(0) : interrupt_grace(), RunOutcome::kInterrupted);
    }
    supervisor_.update(time);
    stop_when_decided(time);
    if (!plays && !supervisor_.stopping() && misses_no_result(time) && !waits_for_page(source)) {
      collector_.read_frames();
      if (!at_once) supervisor_.start(source, time);
      plays = true;
    }
    sample_memory(time);
    while (const auto notice = collector_.take_notice()) events_.push_back(*notice);  // the terminal shows the warning
    if (plays && !supervisor_.stopping()) terminal_.status(format_live_status(collector_.live()), time);
  }
}

/// A user who names a map file wants the complete map in it, however large it is.
milliseconds RunSession::interrupt_grace() const {
  return milliseconds(setup_.save_map_asked ? setup_.launcher.finish_grace_ms : setup_.launcher.interrupt_grace_ms);
}

/// The services that answer the first frame are connected. If a service never appears, the camera names it.
bool RunSession::misses_no_result(milliseconds time) const {
  return collector_.connected(!setup_.replay.features) ||
         time - started_ >= milliseconds(setup_.launcher.connect_timeout_ms);
}

/// A recording is not played before someone can see it, unless the viewer is gone.
bool RunSession::waits_for_page(const ServicePlan& source) {
  if (!setup_.viewer_use.waits || source.role != ServiceRole::kSource || page_was_open_) return false;
  page_was_open_ = collector_.metric_of("viewer", service::metric::kClientsReady).value_or(0) > 0;
  if (page_was_open_ || !supervisor_.runs("viewer")) return false;
  if (!viewer_line_.empty() && !std::exchange(wait_shown_, true))
    terminal_.warn("rtd: waits until the page is open; --viewer=now starts at once");
  return true;
}

void RunSession::keep_viewer() {
  if (!supervisor_.rest_runs()) return;
  terminal_.warn("rtd: the page stays until Ctrl-C: " + viewer_line_);
  wait_for_viewer(milliseconds(setup_.launcher.interrupt_grace_ms));
}

void RunSession::end_viewer() {
  supervisor_.end_rest(now(), milliseconds(setup_.launcher.interrupt_grace_ms));
  wait_for_viewer(milliseconds(0));
}

/// `grace`: after the next signal; one more has none.
void RunSession::wait_for_viewer(milliseconds grace) {
  while (supervisor_.rest_runs()) {
    host_.wait(kTick, signals_.fd());
    if (signals_.take() > 0) supervisor_.end_rest(now(), std::exchange(grace, milliseconds(0)));
    supervisor_.update(now());
  }
}

void RunSession::stop_when_decided(milliseconds time) {
  if (supervisor_.stopping() || supervisor_.outcome() == RunOutcome::kRunning) return;
  collector_.close();
  if (supervisor_.outcome() == RunOutcome::kConfigError)
    logs_.mute();  // the others only log that they were asked to end
  supervisor_.stop(time, milliseconds(setup_.launcher.finish_grace_ms), supervisor_.outcome());
}

void RunSession::on_event(const SupervisorEvent& event) {
  using Kind = SupervisorEvent::Kind;
  if (event.kind != Kind::kStarted && event.kind != Kind::kRestarted) usage_.add_exit(event.service, event.exit);
  switch (event.kind) {
    case Kind::kStarted:
      return;
    case Kind::kRestarted:
      usage_.add_restart(event.service);
      return note(event.text + restart_effect(event.service));
    case Kind::kEnded:
      if (!event.exit.clean()) note(event.text);
      return;
    case Kind::kKilled:
      return note(event.text);
    case Kind::kRefused:
      note(event.text);
      return explain(event.service, logs_.reason(event.service));
    case Kind::kDied:
    case Kind::kGivenUp:
      if (!event.how.empty()) usage_.add_death(event.service, event.how);
      note(event.text);
      return explain(event.service, event.exit.signal == 0 ? logs_.reason(event.service) : logs_.tail(event.service));
  }
}

void RunSession::explain(const std::string& service, const std::vector<std::string>& lines) {
  const std::size_t first = lines.size() > kShownTailLines ? lines.size() - kShownTailLines : 0;
  for (std::size_t i = first; i < lines.size(); ++i) terminal_.warn("  | " + lines[i]);
  terminal_.warn("  log: " + logs_.path(service));
}

void RunSession::note(const std::string& text) {
  events_.push_back(text);
  terminal_.warn("rtd: " + text);
}

void RunSession::sample_memory(milliseconds time) {
  if (time < next_sample_) return;
  next_sample_ = time + kMemoryPeriod;
  for (const auto& [service, process] : supervisor_.running()) {
    const auto text_of = [folder = "/proc/" + std::to_string(process)](const char* file) {
      return io::try_read_file(folder + file, io::kKernelText).value_or("");
    };
    usage_.add_sample(service, peak_rss_mb(text_of("/status")), cpu_s(text_of("/stat")));
  }
}

run_record::RunRecord RunSession::record() const {
  run_record::RunRecord record;
  record.version = RTD_VERSION;
  record.source = setup_.source;
  record.pace = setup_.pace;
  record.filter_mode = setup_.services.filter_mode;
  record.dds = setup_.bus_options.vendor;
  record.detector = setup_.detector_note;
  record.z_up = setup_.services.base.z_up();
  record.interrupted = supervisor_.outcome() == RunOutcome::kInterrupted;
  collector_.fill(record);
  record.events = events_;
  for (std::string& notice : collector_.ask(&RecordBuilder::repeated_notices))
    record.events.push_back(std::move(notice));
  record.duration_s = span_s(record.frames);
  record.processes = usage_.usage();
  record.processes["launcher"] = own_usage();
  record.processes["launcher"].cpu_s -= own_cpu_before_s_;  // of an earlier run of the same launcher (demo)
  return record;
}

}  // namespace rtd::launcher
