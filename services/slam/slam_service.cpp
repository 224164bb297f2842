// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/slam_service.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <numbers>

#include "common/concurrency/thread_priority.hpp"
#include "common/service/config.hpp"
#include "common/service/metric_names.hpp"
#include "common/service/model_locator.hpp"
#include "common/service/monotonic_clock.hpp"
#include "common/service/patience.hpp"
#include "services/slam/config.hpp"
#include "services/slam/map_keeper.hpp"

namespace rtd::slam {
namespace {

constexpr std::size_t kRealtimeQueue = 4, kEveryFrameQueue = 8;
constexpr std::uint64_t kFramesUntilSilent = 30;  // a driver may be found after the first frames
constexpr std::int64_t kDiagnosticsPeriodNs = 1'000'000'000;

MappingMode mapping_mode(service::Pace pace) {
  return pace == service::Pace::kLockstep ? MappingMode::kSynchronous : MappingMode::kThreaded;
}

/// The pose of the next frame is more urgent than the map.
void yield_to_tracking() {
  constexpr int kNicer = 5;
  concurrency::lower_thread_priority(kNicer);
}

}  // namespace

SlamService::SlamService(const Config& config, service::Runtime& runtime)
    : config_(with_mount(config, runtime)),
      runtime_(runtime),
      slam_(core_config(config_), mapping_mode(runtime.pace), service::monotonic_ns, yield_to_tracking),
      camera_tree_(config_, runtime),
      publisher_(config_, runtime.bus, [this](MapId map) { return slam_.map_points(map); }),
      map_publisher_(
          runtime.bus, [this] { return slam_.map_view(); }, std::chrono::milliseconds(config_.map_changes_period_ms)),
      keyframe_sender_(runtime.bus, config_, slam_, map_publisher_),
      arrivals_(runtime.pace == service::Pace::kRealtime
                    ? std::make_shared<Arrivals>(kRealtimeQueue, concurrency::Overflow::kDropOldest)
                    : std::make_shared<Arrivals>(kEveryFrameQueue, concurrency::Overflow::kBlock)),
      filter_(service::follow_source("filter", runtime)),
      map_keeper_(config_.map, slam_) {
  if (config_.motion.given()) {
    motion_.emplace(runtime.bus_options, inertial::MotionFeedTopics{config_.motion.imu, config_.motion.wheels, "slam"});
  }
  if (config_.atlas.ask && runtime.pace != service::Pace::kLockstep) {
    atlas_.emplace(
        runtime.bus, config_.core.sensor, slam_, keyframe_sender_,
        [this](MapContents contents) { return take_map(std::move(contents)); }, [this] { forget_map(); });
  }
  load_map();
  runtime.stop.on_stop([arrivals = arrivals_] { arrivals->close(); });
  runtime.heartbeat.on_status([this](const msg::ServiceStatus& status) {
    if (status.service == "camera") source_ended_ = status.state == msg::ServiceState::kFinished;
  });
  features_ = runtime.bus.reader<msg::FeatureFrame>(
      bus::topics::kFeatures,
      [this](std::shared_ptr<const msg::FeatureFrame> frame) { arrivals_->push(std::move(frame)); },
      filter_->callbacks());
}

/// A reader waits for its running callback, which may be blocked on the full queue.
SlamService::~SlamService() {
  arrivals_->close();
  runtime_.heartbeat.on_status({});
}

service::ExitCode SlamService::run() {
  commands_.emplace(
      runtime_.bus, config_.map, maps_folder(config_, service::state_folder(service::process_environment())), slam_,
      map_keeper_, [this](MapContents contents) { return take_map(std::move(contents)); }, [this] { forget_map(); });
  while (!runtime_.stop.stop_requested()) {
    runtime_.heartbeat.tick();
    report_state();
    commands_->serve();
    runtime_.heartbeat.set_metric(service::metric::kLocalizeOnly, slam_.localize_only() ? 1 : 0);
    const auto frame = arrivals_->pop_for(service::state_period(counters_.frames > 0));
    if (frame && counters_.frames == 0 && !check_camera(**frame)) return service::kUsageOrConfig;
    if (frame) answer(**frame);
    if (frame) last_frame_ = *frame;
    if (frame && atlas_) atlas_->update(**frame, last_result_);
    watch_input(frame.has_value());
  }
  commands_->close();
  SPDLOG_INFO(
      "event=summary frames={} tracked={} dropped={} duplicates={} invalid_features={} keyframes={} landmarks={}",
      counters_.frames, counters_.tracked, arrivals_->dropped(), counters_.duplicates, counters_.invalid_features,
      last_result_.keyframes, last_result_.landmarks);
  return finish();
}

/// A frame sent again because its result was lost gets the same result again. One that newer ones have overtaken gets
/// none: the camera takes theirs for it, too.
bool SlamService::answer_again(const msg::FeatureFrame& frame) {
  const msg::TrackingResult* const result = results_.find(frame.seq, frame.stamp_ns);
  if (result == nullptr && !results_.left_behind(frame.seq, frame.stamp_ns)) return false;
  ++counters_.duplicates;
  if (result != nullptr) publisher_.repeat(*result);
  return true;
}

/// Every frame gets one result.
void SlamService::answer(const msg::FeatureFrame& frame) {
  if (answer_again(frame)) return;
  if (motion_) take_motion(frame);
  const msg::TrackingState previous = last_result_.state;
  if (counters_.frames > 0 && frame.seq > last_result_.seq)
    frame_period_s_ = 1e-9 * static_cast<double>(frame.stamp_ns - last_result_.stamp_ns) /
                      static_cast<double>(frame.seq - last_result_.seq);
  const std::int64_t started_ns = service::monotonic_ns();
  const SlamOutput output = slam_.process(frame);
  last_result_ = make_result(output.result);
  last_result_.published_ns = frame.published_ns;
  last_result_.finished_ns = service::monotonic_ns();
  results_.add() = last_result_;
  publisher_.name_camera(camera_tree_.camera());
  publisher_.publish(output, last_result_);
  trace(started_ns);
  trust_ = trust_monitor_.add(last_result_, output.result.agreement);
  last_problem_ = output.settling ? std::string{} : output.problem;  // every start waits: no trouble
  count(output);
  log(output, previous);
}

/// In realtime slam goes by what has come; else the same samples always belong to a frame, as far as they come in time.
void SlamService::take_motion(const msg::FeatureFrame& frame) {
  if (runtime_.pace != service::Pace::kRealtime) motion_->await(frame.stamp_ns);
  for (const inertial::ImuSample& sample : motion_->take_imu()) slam_.add(sample);
  for (const msg::Odometry& odometry : motion_->take_wheels()) slam_.add(to_sample(odometry));
}

void SlamService::count_motion() {
  service::Heartbeat& heartbeat = runtime_.heartbeat;
  const auto set = [&heartbeat](const char* name, std::uint64_t value) {
    heartbeat.set_metric(name, static_cast<double>(value));
  };
  const MotionPrior& prior = *slam_.prior();
  if (!config_.motion.imu.empty()) {
    const auto [received, undecodable, overflowed] = motion_->imu_counters();
    set(service::metric::kImuSamples, received);
    set(service::metric::kImuDropped, prior.imu_counters().dropped() + undecodable + overflowed);
    set(service::metric::kImuGaps, prior.imu_counters().gaps);
    set(service::metric::kImuClockJumps, prior.imu_counters().clock_jumps);
    set(service::metric::kImuReady, prior.filter() && prior.filter()->ready() ? 1 : 0);
  }
  if (!config_.motion.wheels.empty()) {
    const auto [received, undecodable, overflowed] = motion_->wheel_counters();
    set(service::metric::kWheelSamples, received);
    set(service::metric::kWheelDropped, prior.wheel_counters().dropped() + undecodable + overflowed);
    set(service::metric::kWheelJumps, prior.wheel_counters().jumps);
  }
  set(service::metric::kFramesPredicted, counters_.predicted);
}

void SlamService::trace(std::int64_t started_ns) {
  service::Trace& trace = runtime_.trace;
  if (!trace.on()) return;
  const msg::TrackingResult& result = last_result_;
  trace.span("slam", started_ns, result.finished_ns, result.seq);
  trace.span("publish", result.finished_ns, service::monotonic_ns(), result.seq);
  trace.async_span("camera to pose", result.published_ns, result.finished_ns, result.seq);
  const auto& ms = result.stage_ms;
  const std::array<service::TraceStage, 6> stages{{{"match", ms[msg::kStageMatch]},
                                                   {"local map", ms[msg::kStageLocalMap]},
                                                   {"pose", ms[msg::kStagePose]},
                                                   {"relocalize", ms[msg::kStageRelocalize]},
                                                   {"keyframe", ms[msg::kStageKeyframe]},
                                                   {"mapping", ms[msg::kStageMapping]}}};
  trace.stages(started_ns, stages, result.seq);
}

void SlamService::count(const SlamOutput& output) {
  ++counters_.frames;
  if (msg::is_measured(output.result.state)) ++counters_.tracked;
  if (output.result.state == msg::TrackingState::kDoubtful) ++counters_.doubtful;
  if (output.result.state == msg::TrackingState::kPredicted) ++counters_.predicted;
  if (output.result.features_static == 0 && !output.problem.empty()) ++counters_.unusable_frames;
  counters_.invalid_features += output.invalid_features;
  counters_.loops += output.loops.size();
  counters_.dropped = arrivals_->dropped();
  if (slam_.source_restarts() > counters_.source_restarts) {
    counters_.source_restarts = slam_.source_restarts();
    SPDLOG_WARN("event=source_restarted frame={} total={}", output.result.seq, counters_.source_restarts);
  }
  service::Heartbeat& heartbeat = runtime_.heartbeat;
  heartbeat.set_metric(service::metric::kFrames, static_cast<double>(counters_.frames));
  heartbeat.set_metric(service::metric::kFramesTracked, static_cast<double>(counters_.tracked));
  heartbeat.set_metric(service::metric::kFramesDoubtful, static_cast<double>(counters_.doubtful));
  heartbeat.set_metric(service::metric::kAgreement, trust_.agreement);
  heartbeat.set_metric(service::metric::kViewRemoved, trust_.view_removed);
  heartbeat.set_metric(service::metric::kSinceOkS, trust_.since_ok_s);
  heartbeat.set_metric(service::metric::kPositionSigmaM, trust_.position_sigma_m);
  heartbeat.set_metric(service::metric::kRotationSigmaDeg, trust_.rotation_sigma_deg);
  heartbeat.set_metric(service::metric::kFramesDropped, static_cast<double>(counters_.dropped));
  heartbeat.set_metric(service::metric::kFeaturesInvalid, static_cast<double>(counters_.invalid_features));
  heartbeat.set_metric(service::metric::kKeyframes, output.result.keyframes);
  if (config_.base.z_up()) heartbeat.set_metric(service::metric::kMapZUp, 1);
  heartbeat.set_metric(service::metric::kLoopsClosed, static_cast<double>(counters_.loops));
  heartbeat.set_metric(service::metric::kLandmarks, output.result.landmarks);
  heartbeat.set_metric(service::metric::kReadoutMs, 1e3 * slam_.readout_s());
  if (motion_) count_motion();
  heartbeat.set_metric(service::metric::kSlamMs, static_cast<double>(output.result.stage_ms[msg::kStageSlamTotal]));
}

void SlamService::log(const SlamOutput& output, msg::TrackingState previous) {
  if (output.up) log_gravity(*output.up);
  const FrameResult& result = output.result;
  const bool tracked = msg::is_measured(result.state), was_tracked = msg::is_measured(previous);
  const bool left_odometry = previous == msg::TrackingState::kOdometry && result.state != msg::TrackingState::kOdometry;
  if (tracked && counters_.tracked == 1 && !map_cameras_.empty()) {
    SPDLOG_INFO("event=relocalized frame={} inliers={} after_frames={}", result.seq, result.inliers, counters_.frames);
  } else if (tracked && counters_.tracked == 1) {
    SPDLOG_INFO("event=map_started frame={} landmarks={}", result.seq, result.landmarks);
  } else if (result.state == msg::TrackingState::kOdometry && previous != result.state) {
    SPDLOG_WARN("event=tracking_odometry frame={} inliers={} cause=\"{}\"", result.seq, result.inliers, output.problem);
  } else if (tracked && (!was_tracked || left_odometry)) {
    SPDLOG_INFO("event=tracking_recovered frame={} inliers={}", result.seq, result.inliers);
  } else if (result.state == msg::TrackingState::kDoubtful && previous == msg::TrackingState::kOk) {
    SPDLOG_WARN("event=pose_doubtful frame={} inliers={} cause=\"{}\"", result.seq, result.inliers, output.problem);
  } else if (result.state == msg::TrackingState::kOk && previous == msg::TrackingState::kDoubtful) {
    SPDLOG_INFO("event=pose_trusted frame={} inliers={}", result.seq, result.inliers);
  } else if (result.state == msg::TrackingState::kPredicted && was_tracked) {
    SPDLOG_WARN("event=tracking_predicted frame={} inliers={} cause=\"{}\"", result.seq, result.inliers,
                output.problem);
  } else if (!tracked && msg::has_pose(previous) && result.state != previous && counters_.frames > 1) {
    SPDLOG_WARN("event=tracking_lost frame={} inliers={} cause=\"{}\"", result.seq, result.inliers, output.problem);
  } else if (!tracked && !output.problem.empty() && problem_log_.pass()) {
    SPDLOG_WARN("event=not_tracked frame={} state=\"{}\" cause=\"{}\"", result.seq, to_string(result.state),
                output.problem);
  }
  if (!readout_logged_ && slam_.readout_s() != 0) {
    const double readout_ms = 1e3 * slam_.readout_s();
    if (slam_.readout_given()) {
      SPDLOG_INFO("event=readout_given frame={} readout_ms={:.1f}", result.seq, readout_ms);
    } else {
      SPDLOG_INFO(
          "event=readout_estimated frame={} readout_ms={:.1f} setting=slam.sensor.readout_s calibration_key=readout_s",
          result.seq, readout_ms);
    }
    readout_logged_ = true;
  }
  for (const LoopClosure& loop : output.loops) {
    SPDLOG_INFO("event=loop_closed keyframe={} place={} inliers={} moved_m={:.3f} joined={} maps_merged={}",
                loop.edge.newer, loop.edge.older, loop.edge.inliers, loop.correction_m, loop.joined, loop.merged);
  }
  if (output.invalid_features > 0 && invalid_log_.pass()) {
    SPDLOG_WARN("event=features_invalid frame={} count={} total={}", result.seq, output.invalid_features,
                counters_.invalid_features);
  }
  if (counters_.dropped > dropped_logged_ && dropped_log_.pass()) {
    SPDLOG_WARN("event=frames_dropped count={} total={}", counters_.dropped - dropped_logged_, counters_.dropped);
    dropped_logged_ = counters_.dropped;
  }
}

void SlamService::log_gravity(const UpFound& up) const {
  constexpr double kDegPerRad = 180 / std::numbers::pi;
  if (up.found) {
    SPDLOG_INFO("event=gravity_found source={} turned_deg={:.2f} sigma_deg={:.2f} height_m={:.2f} waited_frames={}",
                config_.base.gravity, kDegPerRad * up.turned_rad, kDegPerRad * up.sigma_rad, up.height_m, up.frames);
  } else {
    SPDLOG_WARN(
        "event=gravity_unknown source={} waited_frames={} effect=\"up is as given: {}\" fix=\"begin where the camera "
        "sees the floor, at most 40 degrees from the configured up\"",
        config_.base.gravity, up.frames, config_.base.given() ? "the base is level" : "the camera looks horizontally");
  }
}

/// Only in realtime do frames come at a rate that one can rely on; else the slowest stage of a busy host sets it.
double SlamService::input_gone_after_s() const {
  constexpr double kPeriods = 3, kLeast_s = 0.5, kMost_s = 5;
  const bool steady = runtime_.pace == service::Pace::kRealtime;
  return steady ? std::clamp(kPeriods * frame_period_s_, kLeast_s, kMost_s) : kMost_s;
}

/// Says so when features stop coming although the source has not ended.
void SlamService::watch_input(bool arrived) {
  const std::int64_t now_ns = service::monotonic_ns();
  if (arrived) last_arrival_ns_ = now_ns;
  const bool gone = counters_.frames > 0 && !source_ended_ &&
                    static_cast<double>(now_ns - last_arrival_ns_) * 1e-9 > input_gone_after_s();
  if (gone != input_gone_) {
    if (gone)
      SPDLOG_WARN("event=input_gone last_frame={} cause=\"no features for {:g} s\" keyframes={}", last_result_.seq,
                  input_gone_after_s(), last_result_.keyframes);
    else if (arrived)
      SPDLOG_INFO("event=input_back frame={}", last_result_.seq);
  }
  input_gone_ = gone;
  if (now_ns - last_diagnostics_ns_ < kDiagnosticsPeriodNs) return;
  last_diagnostics_ns_ = now_ns;
  publisher_.publish_diagnostics(make_diagnostics(last_result_, trust_, counters_, trouble(), last_result_.stamp_ns));
}

/// Why the service does less than it should; empty when it does not.
std::string SlamService::trouble() const {
  if (input_gone_) {
    return fmt::format("no features for {:g} s: camera or filter gone, the map is kept", input_gone_after_s());
  }
  if (std::string unsaved = map_keeper_.trouble(); !unsaved.empty()) return unsaved;
  if (!refused_map_.empty()) return refused_map_;
  if (motion_ && counters_.frames > 0) {
    if (std::string silent = motion_->trouble(); !silent.empty()) return silent;
  }
  return counters_.frames > 0 && last_result_.state != msg::TrackingState::kOk ? last_problem_ : std::string{};
}

void SlamService::report_state() {
  if (counters_.frames == 0) {
    const bool ready = features_.matched() > 0 && publisher_.matched();
    runtime_.heartbeat.set_state(ready ? msg::ServiceState::kReady : msg::ServiceState::kStarting,
                                 ready ? "" : "waits for a filter and a listener to rtd/tracking");
    return;
  }
  if (motion_ && counters_.frames > kFramesUntilSilent && motion_log_.pass()) {
    if (const std::string silent = motion_->trouble(); !silent.empty())
      SPDLOG_WARN("event=motion_silent cause=\"{}\"", silent);
  }
  const std::string message = trouble();
  runtime_.heartbeat.set_state(message.empty() ? msg::ServiceState::kRunning : msg::ServiceState::kDegraded, message);
}

/// The map too when the other files cannot be written, and the other way round.
service::ExitCode SlamService::finish() {
  // A stop from outside must not wait for seconds; a source that has ended gives its final map.
  slam_.finish(source_ended_ ? PendingAdjustment::kAwait : PendingAdjustment::kCancel);
  const bool written = write_files();
  const bool saved = map_keeper_.save_at_end();
  return written && saved ? service::kOk : service::kRunFailed;
}

bool SlamService::write_files() {
  if (config_.out_dir.empty()) return true;
  try {
    write_run_files(slam_, config_.out_dir);
  } catch (const std::exception& error) {
    SPDLOG_ERROR("event=files_not_written cause=\"{}\"", error.what());
    return false;
  }
  SPDLOG_INFO("event=files_written folder={} poses={}", config_.out_dir, slam_.frames_tracked());
  return true;
}

}  // namespace rtd::slam
