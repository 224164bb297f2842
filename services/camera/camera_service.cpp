// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/camera_service.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <limits>
#include <opencv2/core/utility.hpp>
#include <utility>

#include "common/camera/live_uri.hpp"
#include "common/msg/transform_eigen.hpp"
#include "common/service/camera_frame.hpp"
#include "common/service/load_step.hpp"
#include "common/service/metric_names.hpp"
#include "common/service/monotonic_clock.hpp"
#include "services/camera/live_camera.hpp"

namespace rtd::camera {
namespace {

constexpr std::size_t kReadAhead = 2;
constexpr std::size_t kResultQueue = 64;
constexpr std::chrono::milliseconds kReadinessCheck{50};      // a peer that falls silent causes no event
constexpr std::chrono::milliseconds kLongestWait{100};        // between two looks at the stop token
constexpr std::int64_t kLastResultTimeoutNs = 2'000'000'000;  // pace realtime
constexpr std::chrono::milliseconds kFarewell{300};           // the last heartbeats reach their readers
constexpr double kBufferedFrames = 3, kBuffered_s = 0.1;      // as a camera's driver buffers; readers keep four

std::int64_t seconds_to_ns(double seconds) {
  return static_cast<std::int64_t>(seconds * 1e9);
}

std::shared_ptr<FrameSource> open_source(const ServiceConfig& config, const bus::BusOptions& bus,
                                         std::function<void(const std::string&)> on_wait) {
  try {
    if (!is_live(config.source)) return make_source(config.source);
    return make_live_source(config.source, bus, seconds_to_ns(config.start_timeout_s), std::move(on_wait));
  } catch (const SourceError& error) {
    throw service::ConfigError(error.what());
  }
}

service::PacerConfig to_pacer_config(const ServiceConfig& config, service::Pace pace, const SourceInfo& source) {
  const bool asap = pace == service::Pace::kAsap, realtime = pace == service::Pace::kRealtime;
  service::PacerConfig pacer;
  pacer.window = realtime ? 0 : asap ? config.asap_window : 1;
  pacer.at_once = source.live;
  pacer.late_after_ns = seconds_to_ns(std::max(std::min(kBufferedFrames / source.fps, kBuffered_s), 1.0 / source.fps));
  pacer.max_gap_ns = seconds_to_ns(config.max_gap_s);
  pacer.resend_after_ns = std::int64_t{config.resend_after_ms} * 1'000'000;
  pacer.result_timeout_ns = seconds_to_ns(config.result_timeout_s);
  return pacer;
}

/// It has no heartbeat, but subscribes to the frames once it misses no result.
constexpr char kLauncher[] = "launcher";

/// Readers of frames and JPEGs that a service has. A recorder of a run takes both, and misses none.
int readers_of(const std::string& service) {
  if (service == "record") return 2;
  return service == "filter" || service == "detector" || service == "dense" || service == kLauncher ? 1 : 0;
}

}  // namespace

void CameraService::add_options(CLI::App& app, std::vector<service::GivenOption>&) {
  app.add_flag("--preview")->description("Print what the source delivers, write a picture and end (--preview --help)");
}

CameraService::CameraService(const Config& config, service::Runtime& runtime)
    : config_(config),
      runtime_(runtime),
      source_(open_source(config, runtime.bus_options, [this](const std::string& what) { report_wait(what); })),
      realtime_(runtime.pace == service::Pace::kRealtime),
      pacer_(to_pacer_config(config, runtime.pace, source_->info()), service::monotonic_ns),
      results_(std::make_shared<Results>(kResultQueue, concurrency::Overflow::kDropOldest)),
      changes_(std::make_shared<concurrency::BoundedQueue<bool>>(1, concurrency::Overflow::kDropOldest)),
      publisher_(
          runtime.bus, config.jpeg_quality,
          realtime_ ? concurrency::Overflow::kDropOldest : concurrency::Overflow::kBlock,
          [changes = changes_] { changes->push(true); }, static_cast<std::uint64_t>(config.source_id)),
      truth_(runtime.bus.writer(bus::topics::kGroundTruth)),
      resume_(resume_point_of(config)),
      slam_(service::follow_source("slam", runtime)),
      tracking_(runtime.bus.reader<msg::TrackingResult>(
          bus::topics::kTracking, [results = results_](const auto& result) { results->push(result->seq); },
          slam_->callbacks())) {
  cv::setNumThreads(1);
  const SourceInfo& info = source_->info();
  if (info.has_imu || info.has_wheels) {
    motion_.emplace(runtime.bus_options, info,
                    MotionFrames{runtime.bus.frame(msg::kCameraFrame), runtime.bus.frame("wheel_odom"),
                                 runtime.bus.frame("base_link")});
  }
  if (!config_.sensor_topics.empty()) open_auxiliary();
  if (!source_->info().live) open_publisher();
  const auto none = std::find(config_.wait_for.rbegin(), config_.wait_for.rend(), "none");  // empties the list
  config_.wait_for.erase(config_.wait_for.begin(), none.base());
  runtime.heartbeat.on_status([changes = changes_](const auto&) { changes->push(true); });
  runtime.stop.on_stop([source = source_, results = results_, changes = changes_] {
    source->stop();
    results->close();
    changes->close();
  });
}

void CameraService::open_auxiliary() {
  try {
    auxiliary_.emplace(runtime_.bus_options, runtime_.bus, config_.source, config_.sensor_topics);
  } catch (const SourceError& error) {
    throw service::ConfigError(std::string("camera.sensor_topics: ") + error.what());
  }
}

CameraService::~CameraService() {
  runtime_.heartbeat.on_status({});
}

service::ExitCode CameraService::run() {
  Outcome outcome = open();
  if (outcome == Outcome::kDone) outcome = wait_for_others();
  if (outcome == Outcome::kDone) {
    runtime_.heartbeat.set_state(msg::ServiceState::kRunning);
    playing_ = true;
    outcome = play();
    if (outcome == Outcome::kDone) outcome = drain();
  }
  return finish(outcome);
}

CameraService::Outcome CameraService::open() {
  try {
    if (!source_->open()) return Outcome::kStopped;
  } catch (const SourceError& error) {
    return fail(fmt::format("source {}: {}", config_.source, error.what()));
  }
  if (source_->info().live) open_publisher();
  log_opened();
  return Outcome::kDone;
}

void CameraService::open_publisher() {
  const auto& camera = source_->info().camera.parameters();
  publisher_.open({camera.width, camera.height});
  publisher_.name_frame(service::announce_camera_frame(runtime_.heartbeat, runtime_.bus, source_->info().frame_id));
}

/// Called by the source: in open(), later in the thread that reads ahead.
void CameraService::report_wait(const std::string& what) {
  if (what.empty()) {
    if (playing_) runtime_.heartbeat.set_state(msg::ServiceState::kRunning);
    SPDLOG_INFO("event=camera_streaming");
    return;
  }
  runtime_.heartbeat.set_state(playing_ ? msg::ServiceState::kDegraded : msg::ServiceState::kStarting, what);
  if (wait_log_.pass()) SPDLOG_WARN("event=waiting_for_camera cause=\"{}\"", what);
}

CameraService::Outcome CameraService::wait_for_others() {
  const std::int64_t deadline_ns = service::monotonic_ns() + seconds_to_ns(config_.start_timeout_s);
  std::vector<std::string> absent = missing();
  while (!absent.empty()) {
    if (runtime_.stop.stop_requested()) return Outcome::kStopped;
    if (service::monotonic_ns() > deadline_ns) {
      return fail(
          fmt::format("not ready within {:g} s: {}; start them in this DDS domain, {} (--domain, ROS_DOMAIN_ID), or "
                      "leave them out with --wait-for",
                      config_.start_timeout_s, fmt::join(absent, "; "), runtime_.bus_options.domain));
    }
    runtime_.heartbeat.set_state(msg::ServiceState::kReady, fmt::format("waits for {}", fmt::join(absent, "; ")));
    changes_->pop_for(kReadinessCheck);
    absent = missing();
  }
  SPDLOG_INFO("event=all_ready services={}", fmt::join(config_.wait_for, ","));
  return Outcome::kDone;
}

std::vector<std::string> CameraService::missing() const {
  std::vector<std::string> absent;
  int expected = 0;
  for (const std::string& name : config_.wait_for) {
    if (name != kLauncher && !runtime_.heartbeat.ready(name)) absent.push_back(name);
    expected += readers_of(name);
  }
  const int readers = publisher_.frame_readers() + publisher_.jpeg_readers();
  if (readers < expected) absent.push_back(fmt::format("{} of {} frame readers", expected - readers, expected));
  if (resume_ && tracking_.matched() == 0) absent.emplace_back("the results of slam");
  return absent;
}

CameraService::Outcome CameraService::play() {
  const auto most = static_cast<std::uint64_t>(config_.frames);
  left_out_.open(source_->info().frames, most, source_->counters());
  if (resume_) resume();
  if (most > 0 && frames_in_ >= most) return Outcome::kDone;
  ReadAhead frames(*source_, kReadAhead, most > 0 ? most - frames_in_ : 0, service::monotonic_ns);
  return play(frames);
}

/// What is stored gives the next frame; in realtime the one that is due now, and those before it are late. A running
/// camera gives what it sees. No reading of an IMU or wheels is given twice.
void CameraService::resume() {
  frames_in_ = resume_->seq + 1;
  if (!source_->info().live) {
    source_->pass_over(resume_->stamp_ns + 1);
    passed_ = source_->counters();
    left_out_.resume(frames_in_, passed_);
    if (auxiliary_) auxiliary_->pass_over(resume_->stamp_ns);
  }
  if (realtime_ && !source_->info().live) {
    const std::int64_t due_ns = resume_->stamp_ns + service::monotonic_ns() - resume_->published_ns;
    passed_over_ = source_->pass_over(due_ns);
    if (config_.frames > 0)
      passed_over_ = std::min(passed_over_, static_cast<std::uint64_t>(config_.frames) - frames_in_);
    frames_in_ += passed_over_;
  }
  SPDLOG_INFO("event=resumed frame={} late={}", frames_in_, passed_over_);
}

CameraService::Outcome CameraService::play(ReadAhead& frames) {
  while (!runtime_.stop.stop_requested()) {
    std::optional<ReadItem> item = frames.next();
    if (!item) break;
    counters_ = item->counters;
    left_out_.add(*item);
    log_skipped(*item);
    if (!item->error.empty()) return fail("the source failed: " + item->error);
    frames_in_ += item->passed_over;
    passed_over_ += item->passed_over;
    if (!item->frame) return runtime_.stop.stop_requested() ? Outcome::kStopped : Outcome::kDone;
    if (resume_ && !source_->info().live && item->frame->image.stamp_ns <= resume_->stamp_ns) continue;
    item->frame->image.seq = frames_in_;
    runtime_.trace.async_span("read", item->begin_ns, item->end_ns, item->frame->image.seq);
    if (const Outcome outcome = handle(std::move(*item->frame), frames); outcome != Outcome::kDone) return outcome;
    if (frames_in_ % kReportEvery == 0) report_counters();
  }
  return Outcome::kStopped;
}

CameraService::Outcome CameraService::handle(SourceFrame frame, ReadAhead& frames) {
  ++frames_in_;
  left_out_.add(frame.image);
  note_depth_offset(frame);
  note_depth(frame);
  while (!runtime_.stop.stop_requested()) {
    take_results();
    const service::PaceDecision decision =
        one_by_one_ && !realtime_ ? pacer_.drain() : pacer_.next(frame.image.stamp_ns, frames.waiting());
    log_timeline(decision, frame.image.seq);
    if (decision.action == service::PaceAction::kSkipLate && late_log_.pass())
      SPDLOG_WARN("event=frame_late frame={} total={}", frame.image.seq, late());
    if (decision.late_ns > 0) frames.pass_over(frame.image.stamp_ns + decision.late_ns);
    if (decision.action == service::PaceAction::kSkipLate) return Outcome::kDone;
    if (decision.action == service::PaceAction::kSend) {
      runtime_.heartbeat.tick();
      const std::int64_t begin_ns = service::monotonic_ns();
      if (motion_) motion_->publish(frame, resume_ ? resume_->stamp_ns : std::numeric_limits<std::int64_t>::min());
      if (auxiliary_) auxiliary_->publish(frame);
      send(frame.image);
      runtime_.trace.span("publish", begin_ns, service::monotonic_ns(), frame.image.seq);
      send_truth(frame);
      runtime_.heartbeat.idle();  // until the next frame, whenever it comes
      last_seq_ = frame.image.seq;
      if (realtime_) return Outcome::kDone;
      pacer_.sent(frame.image.seq);
      in_flight_.push_back(std::move(frame.image));
      return Outcome::kDone;
    }
    if (follow(decision) == Outcome::kFailed) return Outcome::kFailed;
  }
  return Outcome::kStopped;
}

CameraService::Outcome CameraService::follow(const service::PaceDecision& decision) {
  if (decision.action == service::PaceAction::kWait) wait(decision.wait_ns);
  if (decision.action == service::PaceAction::kResend) resend();
  if (decision.action == service::PaceAction::kGiveUp) {
    return fail(fmt::format("no tracking result for frame {} within {:g} s: are filter and slam alive?",
                            pacer_.in_flight().front(), config_.result_timeout_s));
  }
  return Outcome::kDone;
}

CameraService::Outcome CameraService::drain() {
  if (realtime_) {
    drain_by_time();
    return Outcome::kDone;
  }
  while (!runtime_.stop.stop_requested()) {
    take_results();
    const service::PaceDecision decision = pacer_.drain();
    if (decision.action == service::PaceAction::kSend) return Outcome::kDone;
    if (follow(decision) == Outcome::kFailed) return Outcome::kFailed;
  }
  return Outcome::kStopped;
}

/// Realtime: the last frame may have been dropped on its way, so its result is waited for, but not for long.
void CameraService::drain_by_time() {
  const std::int64_t deadline_ns = service::monotonic_ns() + kLastResultTimeoutNs;
  while (published_ > 0 && !(any_result_ && newest_result_ >= last_seq_) && service::monotonic_ns() < deadline_ns) {
    const std::optional<std::uint64_t> seq = results_->pop_for(kLongestWait);
    if (seq) note(*seq);
    if (runtime_.stop.stop_requested()) return;
  }
}

void CameraService::wait(std::int64_t wait_ns) {
  if (realtime_) {
    runtime_.stop.wait_for(std::chrono::nanoseconds(wait_ns));
    return;
  }
  const auto wait_ms = std::chrono::ceil<std::chrono::milliseconds>(std::chrono::nanoseconds(wait_ns));
  if (const std::optional<std::uint64_t> seq = results_->pop_for(std::min(wait_ms, kLongestWait))) note(*seq);
}

void CameraService::take_results() {
  while (const std::optional<std::uint64_t> seq = results_->pop_for(std::chrono::milliseconds(0))) note(*seq);
}

void CameraService::note(std::uint64_t seq) {
  newest_result_ = any_result_ ? std::max(newest_result_, seq) : seq;
  any_result_ = true;
  pacer_.answered(seq);
  const std::size_t before = in_flight_.size();
  while (!in_flight_.empty() && in_flight_.front().seq <= seq) in_flight_.pop_front();
  if (in_flight_.empty()) {
    one_by_one_ = false;
  } else if (one_by_one_ && in_flight_.size() < before) {
    publisher_.publish(in_flight_.front());
  }
}

void CameraService::send(const vision::RgbdImage& image) {
  ++published_;
  if (realtime_) publisher_.limit_jpeg_rate(service::asked_load_step(runtime_.heartbeat).max_jpeg_hz);
  if (publisher_.publish(image)) return;
  ++refused_;
  if (refused_log_.pass()) SPDLOG_WARN("event=frame_refused frame={} total={}", image.seq, refused_);
}

/// For those who compare. Costs nothing without them.
void CameraService::send_truth(const SourceFrame& frame) {
  if (!frame.T_world_camera || truth_.matched() == 0) return;
  const auto [t, q] = msg::to_message(*frame.T_world_camera);
  truth_.write({{msg::to_time(frame.image.stamp_ns), runtime_.bus.frame("world")},
                {{t[0], t[1], t[2]}, {q[0], q[1], q[2], q[3]}}});
}

/// A service that was restarted must get the oldest first: it would take a later one for the beginning, and leave out
/// those before.
void CameraService::resend() {
  SPDLOG_WARN("event=frames_sent_again first={} frames={} silent_ms={}", pacer_.in_flight().front(), in_flight_.size(),
              config_.resend_after_ms);
  one_by_one_ = true;
  publisher_.publish(in_flight_.front());
  pacer_.resent();
}

CameraService::Outcome CameraService::fail(const std::string& message) {
  SPDLOG_ERROR("event=failed cause=\"{}\"", message);
  runtime_.heartbeat.set_state(msg::ServiceState::kFailed, message);
  return Outcome::kFailed;
}

service::ExitCode CameraService::finish(Outcome outcome) {
  write_groundtruth();
  report_counters();
  if (outcome != Outcome::kFailed) runtime_.heartbeat.set_state(msg::ServiceState::kFinished, left_out_.first());
  SPDLOG_INFO(
      "event=summary frames_in={} published={} late={} skipped={} without_depth={} refused={} resends={} "
      "depth_offset_ms={:.1f} depth_median_m={:.2f} depth_holes={:.3f}",
      frames_in_, published_, late(), counters_.skipped_total(), counters_.frames_without_depth, refused_,
      pacer_.resends(), depth_offsets_.median_ms().value_or(0.0), depth_figures_.median_m().value_or(0.0),
      depth_figures_.hole_share());
  if (outcome != Outcome::kStopped) runtime_.stop.wait_for(kFarewell);
  return outcome == Outcome::kFailed ? service::kRunFailed : service::kOk;
}

}  // namespace rtd::camera
