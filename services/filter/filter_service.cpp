// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/filter_service.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <ctime>
#include <opencv2/core/utility.hpp>
#include <utility>

#include "common/msg/filter_modes.hpp"
#include "common/msg/stamps.hpp"
#include "common/msg/word_list.hpp"
#include "common/service/camera_frame.hpp"
#include "common/service/metric_names.hpp"
#include "common/service/monotonic_clock.hpp"
#include "common/service/patience.hpp"
#include "common/vision/rgbd_image.hpp"
#include "services/filter/core/modes/mode_table.hpp"
#include "services/filter/filter_messages.hpp"
#include "services/filter/processor_quota.hpp"

namespace rtd::filter {
namespace {

constexpr std::size_t kRealtimeQueue = 2, kEveryFrameQueue = 8;
constexpr int kLastLoadStep = static_cast<int>(service::kLoadSteps.size()) - 1;
constexpr double kFullWorkCores = 0.9;                 // camera, filter and slam at 30 Hz, without a detector
constexpr std::chrono::milliseconds kLookAtSlam{100};  // whether it is still there

/// The last step is for a computer that is known to be slow: on a busy one its error is larger than what it saves.
LoadWatch watch_from(int first_step) {
  return {LoadLimits{}, first_step > 0 ? kLastLoadStep : kLastLoadStep - 1, first_step};
}

}  // namespace

FilterService::FilterService(const Config& config, service::Runtime& runtime)
    : config_(config),
      runtime_(runtime),
      filter_(config.core_config(), service::monotonic_ns),
      movers_(runtime.bus, runtime.bus.frame(config.map_frame)),
      frames_(runtime.pace == service::Pace::kRealtime
                  ? std::make_shared<Frames>(kRealtimeQueue, concurrency::Overflow::kDropOldest)
                  : std::make_shared<Frames>(kEveryFrameQueue, concurrency::Overflow::kBlock)),
      load_(watch_from(first_load_step())),
      camera_(service::follow_source("camera", runtime)),
      detector_(service::follow_source("detector", runtime, service::kDetectorSilenceNs)),
      slam_(service::follow_source("slam", runtime)) {
  cv::setNumThreads(1);
  if (load_.step() > 0) follow_load_step();
  runtime.stop.on_stop([frames = frames_, prepared = prepared_, detections = detections_, feedback = feedback_] {
    frames->close();
    prepared->close();
    detections->close();
    feedback->close();
  });
  runtime.heartbeat.on_status([this](const msg::ServiceStatus& status) {
    if (status.service != "detector") return;
    detector_alive_ns_ = status.state == msg::ServiceState::kFinished ? 0 : service::monotonic_ns();
    detector_masks_ = std::ranges::count(status.metrics, service::metric::kMasks, &msg::Metric::name) > 0;
    if (msg::is_ready(status.state)) detector_ready_ = true;
  });
  if (!config_.imu.empty()) imu_.emplace(runtime.bus_options, inertial::MotionFeedTopics{config_.imu, "", "filter"});
  writer_ = runtime.bus.writer(bus::topics::kFeatures);
  mask_writer_ = runtime.bus.writer(bus::topics::kDynamicMask);
  tracking_reader_ = runtime.bus.reader<msg::TrackingResult>(
      bus::topics::kTracking,
      [this](const std::shared_ptr<const msg::TrackingResult>& result) { feedback_->put(*result); },
      slam_->callbacks());
  keyframe_reader_ = runtime.bus.reader<msg::KeyframeEvent>(
      bus::topics::kKeyframes,
      [this](const std::shared_ptr<const msg::KeyframeEvent>& event) { feedback_->put(*event); }, slam_->callbacks());
  if (config_.person_masks == "on") read_masks();
  detection_reader_ = runtime.bus.reader<msg::Detection2DArray>(
      bus::topics::kDetections,
      [this](const std::shared_ptr<const msg::Detection2DArray>& message) {
        detections_->put(to_detection_batch(*message), message->detections.size());
      },
      detector_->callbacks());
  frame_reader_ = bus::FrameReader(
      runtime.bus,
      [this](std::shared_ptr<const msg::FrameView> frame) {
        frames_->push({std::move(frame), camera_->changes()});
      },
      camera_->callbacks());
}

/// A reader waits for its running callback, which may be blocked on the full queue.
FilterService::~FilterService() {
  frames_->close();
  prepared_->close();
  if (preparing_.joinable()) preparing_.join();
  runtime_.heartbeat.on_status({});
}

service::ExitCode FilterService::run() {
  if (runtime_.pace == service::Pace::kRealtime) preparing_ = std::thread([this] { prepare_frames(); });
  runtime_.heartbeat.set_word(service::metric::kModePrefix, msg::name_of(filter_.mode()));
  commands_.emplace(runtime_.bus);
  commands_->offer("filter/set_mode", bus::CommandKind::kText,
                   [this](const bus::CommandRequest& asked) { return set_mode(asked.argument); });
  while (!runtime_.stop.stop_requested()) {
    runtime_.heartbeat.tick();
    report_state();
    commands_->serve();
    std::optional<Work> work = next_frame();
    notice_standstill();
    watch_detector();
    if (work && accept(work->arrival)) process(std::move(*work));
  }
  commands_->close();
  SPDLOG_INFO("event=summary frames={} dropped={} defective={} refused={} without_detections={}", published_,
              frames_->dropped(), defective_, camera_->refused(), unpaired_);
  return service::kOk;
}

/// Realtime: finds the features of the next frame while the one before is judged. Two threads get more of a busy
/// computer than one, and two cores halve the time between frames.
void FilterService::prepare_frames() {
  while (const auto arrival = frames_->pop()) {
    Work work{*arrival, std::nullopt, nullptr};
    const msg::FrameView& frame = *arrival->frame;
    try {
      const service::TraceSpan span(runtime_.trace, "extract", frame.seq);
      if (vision::defect(frame).empty()) work.extraction = filter_.extract(vision::view_image(frame));
    } catch (...) {
      work.failure = std::current_exception();
    }
    if (!prepared_->push(std::move(work))) return;
  }
}

std::optional<FilterService::Work> FilterService::next_frame() {
  const auto longest_wait = service::state_period(published_ > 0);
  if (runtime_.pace == service::Pace::kRealtime) return prepared_->pop_for(longest_wait);
  auto arrival = frames_->pop_for(longest_wait);
  return arrival ? std::optional(Work{std::move(*arrival), std::nullopt, nullptr}) : std::nullopt;
}

Extraction FilterService::extract(std::uint64_t seq, const vision::RgbdImage& image) {
  const service::TraceSpan span(runtime_.trace, "extract", seq);
  return filter_.extract(image);
}

/// One frame: features while the detector still works on it, then its boxes, then the judgement.
void FilterService::process(Work work) {
  if (work.failure) std::rethrow_exception(work.failure);
  const msg::FrameView& frame = *work.arrival.frame;
  const vision::RgbdImage image = vision::view_image(frame);
  Extraction extraction = work.extraction ? std::move(*work.extraction) : extract(frame.seq, image);
  const std::int64_t waiting_since_ns = service::monotonic_ns();
  const DetectorUpdate detector = collect_detections(frame);
  apply_slam_feedback();
  if (imu_) take_imu(frame.stamp_ns);
  const std::int64_t judging_since_ns = service::monotonic_ns(), waited_ns = judging_since_ns - waiting_since_ns;

  FilterResult result = filter_.judge(image, std::move(extraction), detector);
  result.stage_ms[msg::kStageWaitDetections] = static_cast<float>(static_cast<double>(waited_ns) * 1e-6);
  fill_next(frame, result, use_of(detector, result, frame.stamp_ns));
  trace(waiting_since_ns, judging_since_ns);
  writer_.write(*message_);
  // After the features: slam's pose waits for them, not for the mask. Costs nothing without a subscriber.
  if (mask_writer_.matched() > 0)
    mask_writer_.write(make_mask(frame, result, service::camera_frame(runtime_.heartbeat, runtime_.bus)));
  if (movers_.wanted()) movers_.add(frame.seq, frame.stamp_ns, filter_.sight_objects(image, result));
  ++published_;
  count(result);
}

void FilterService::fill_next(const msg::FrameView& frame, const FilterResult& result, msg::DetectionUse use) {
  msg::FeatureFrame& next = messages_.add();
  fill_message(frame, result, use, next);
  message_ = &next;
}

/// Of the message before it is written.
void FilterService::trace(std::int64_t waiting_since_ns, std::int64_t judging_since_ns) {
  service::Trace& trace = runtime_.trace;
  if (!trace.on()) return;
  const auto& ms = message_->stage_ms;
  const std::array<service::TraceStage, 4> stages{{{"masks", ms[msg::kStageMasks]},
                                                   {"ego motion", ms[msg::kStageEgoMotion]},
                                                   {"depth check", ms[msg::kStageDepthCheck]},
                                                   {"fuse", ms[msg::kStageFuse]}}};
  trace.span("wait for boxes", waiting_since_ns, judging_since_ns, message_->seq);
  trace.span("judge", judging_since_ns, service::monotonic_ns(), message_->seq);
  trace.stages(judging_since_ns, stages, message_->seq);
}

/// False for a frame that is not to be processed: defective, or sent again (its features are published again).
bool FilterService::accept(const Arrival& arrival) {
  const msg::FrameView& frame = *arrival.frame;
  follow_camera(arrival);
  if (const std::string cause = vision::defect(frame); !cause.empty()) {
    publish_no_features(frame, cause);
    return false;
  }
  if (published_ == 0) return true;
  if (const msg::FeatureFrame* const sent = messages_.find(frame.seq, frame.stamp_ns)) {
    writer_.write(*sent);
    return false;
  }
  if (messages_.left_behind(frame.seq, frame.stamp_ns)) return false;  // slam has answered a newer one, and so this one
  follow_time(frame);
  return true;
}

void FilterService::follow_time(const msg::FrameView& frame) {
  if (frame.stamp_ns <= message_->stamp_ns) {
    forget_views(frame, "time went back");
  } else if (frame.intrinsics != message_->intrinsics) {
    forget_views(frame, "another calibration");
  }
}

/// What was seen before cannot be compared with this frame.
void FilterService::forget_views(const msg::FrameView& frame, const char* cause) {
  SPDLOG_WARN("event=views_forgotten frame={} stamp_ns={} last_stamp_ns={} cause=\"{}\"", frame.seq, frame.stamp_ns,
              message_->stamp_ns, cause);
  filter_.reset();
  movers_.clear();
  detections_->clear();
}

/// The other services wait for every frame: a frame that cannot be used has no features.
void FilterService::publish_no_features(const msg::FrameView& frame, const std::string& cause) {
  runtime_.heartbeat.set_metric(service::metric::kFramesDefective, static_cast<double>(++defective_));
  if (defect_log_.pass()) SPDLOG_WARN("event=frame_defective frame={} cause=\"{}\"", frame.seq, cause);
  fill_next(frame, {}, msg::DetectionUse::kNone);
  writer_.write(*message_);
}

/// What was seen by the camera before cannot be compared with what this one sees, unless it is the same one, restarted.
void FilterService::follow_camera(const Arrival& arrival) {
  const std::uint64_t before = std::exchange(camera_id_, arrival.frame->source_id);
  if (std::exchange(camera_changes_, arrival.camera_changes) == arrival.camera_changes || before == camera_id_) return;
  filter_.reset();
  movers_.clear();
}

void FilterService::apply_slam_feedback() {
  SlamUpdate update;
  if (runtime_.pace == service::Pace::kLockstep && published_ > 0) {
    const std::int64_t waited_ns = wait_for_slam(message_->seq);
    update = feedback_->take_after(message_->seq, std::chrono::milliseconds(0));
    if (!update.complete && !runtime_.stop.stop_requested() && wait_log_.pass()) {
      SPDLOG_WARN("event=slam_silent frame={} waited_ms={}", message_->seq, waited_ns / 1'000'000);
    }
  } else {
    update = feedback_->take();
  }
  for (const msg::KeyframeEvent& event : update.events) filter_.on_keyframe(to_slam_keyframe(event));
  for (const msg::TrackingResult& result : update.results) {
    if (const auto pose = to_slam_pose(result)) filter_.on_pose(*pose);
    movers_.on_result(result);
    watch_load(result);
  }
}

/// Until slam has answered this frame, is gone, or has not answered for too long. Returns how long that took.
std::int64_t FilterService::wait_for_slam(std::uint64_t seq) {
  const std::int64_t since_ns = service::monotonic_ns();
  std::int64_t waited_ns = 0;
  const std::int64_t most_ns = std::int64_t{config_.feedback_timeout_ms} * 1'000'000;
  while (waited_ns < most_ns && !runtime_.stop.stop_requested()) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(std::chrono::nanoseconds(most_ns - waited_ns));
    const bool answered = feedback_->wait_for(seq, std::min(left, kLookAtSlam));
    waited_ns = service::monotonic_ns() - since_ns;
    runtime_.heartbeat.tick();
    const bool gone = runtime_.heartbeat.gone("slam");
    const bool enough = slam_seen_ && gone && waited_ns > kPatienceNs;
    slam_seen_ = slam_seen_ || !gone;
    if (answered || enough) break;
  }
  return waited_ns;
}

/// In realtime the filter goes by what has come; else the same samples belong to a frame, as far as they come in time.
void FilterService::take_imu(std::int64_t stamp_ns) {
  if (runtime_.pace != service::Pace::kRealtime) imu_->await(stamp_ns);
  for (const inertial::ImuSample& sample : imu_->take_imu()) filter_.add(sample);
}

/// Most frames of the first second would be lost until step after step is shed.
int FilterService::first_load_step() const {
  const double cores = usable_cores();
  if (!sheds_load() || cores >= kFullWorkCores) return 0;
  SPDLOG_WARN("event=load_shed step={} effect=\"{}\" cause=\"{:.2g} cores at most for this service\"", kLastLoadStep,
              service::kLoadSteps.back().name, cores);
  return kLastLoadStep;
}

/// Only at pace realtime is a late pose a sign of too much work, and never a matter of results that must be repeatable.
bool FilterService::sheds_load() const {
  return runtime_.pace == service::Pace::kRealtime && config_.shed_load;
}

const service::LoadStep& FilterService::follow_load_step() {
  const service::LoadStep& step = service::kLoadSteps[static_cast<std::size_t>(load_.step())];
  filter_.set_effort({step.feature_share, step.coarse_depth_check, step.first_octave});
  runtime_.heartbeat.set_metric(service::metric::kLoadStep, load_.step());
  return step;
}

/// Since the last frame, or look for one.
void FilterService::notice_standstill() {
  constexpr std::int64_t kStandstillNs = 250'000'000;  // even next to many busy processes a thread runs in that time
  timespec used{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &used);
  const std::int64_t now_ns = service::monotonic_ns(), ran_ns = used.tv_sec * 1'000'000'000 + used.tv_nsec;
  const std::int64_t away_ns = now_ns - std::exchange(looked_ns_, now_ns) - (ran_ns - std::exchange(ran_ns_, ran_ns));
  if (away_ns > kStandstillNs) load_.stood_still(now_ns);
}

void FilterService::watch_load(const msg::TrackingResult& result) {
  if (!sheds_load()) return;
  const int before = load_.step();
  const double latency_ms = static_cast<double>(msg::minus_ns(result.finished_ns, result.published_ns)) * 1e-6;
  if (!load_.add(result.seq, latency_ms, service::monotonic_ns())) return;
  const service::LoadStep& step = follow_load_step();
  if (load_.step() > before) {
    SPDLOG_WARN("event=load_shed step={} effect=\"{}\" cause=\"{} of {} frames late or missing\"", load_.step(),
                step.name, load_.burdened(), load_.window());
  } else {
    SPDLOG_INFO("event=load_taken_back step={} effect=\"{}\"", load_.step(),
                load_.step() > 0 ? step.name : "everything as configured");
  }
}

void FilterService::count(const FilterResult& result) {
  service::Heartbeat& heartbeat = runtime_.heartbeat;
  heartbeat.set_metric(service::metric::kFrames, static_cast<double>(published_));
  heartbeat.set_metric(service::metric::kFramesDropped, static_cast<double>(frames_->dropped()));
  heartbeat.set_metric(service::metric::kFramesFromOthers, static_cast<double>(camera_->refused()));
  heartbeat.set_metric(service::metric::kFramesWithoutDetections, static_cast<double>(unpaired_));
  heartbeat.set_metric(service::metric::kFeatures, static_cast<double>(result.features.size()));
  heartbeat.set_metric(service::metric::kFeaturesRemoved, result.removed);
  heartbeat.set_metric(service::metric::kObjects, static_cast<double>(result.objects.size()));
  heartbeat.set_metric(service::metric::kDynamicClusters, result.dynamic_clusters);
  constexpr auto kNames = service::metric::kFilterStageMs;
  for (std::size_t stage = 0; stage < kNames.size(); ++stage) {  // means so far
    total_stage_ms_[stage] += static_cast<double>(result.stage_ms[stage]);
    heartbeat.set_metric(kNames[stage], total_stage_ms_[stage] / static_cast<double>(published_));
  }
}

void FilterService::report_state() {
  if (published_ == 0) {
    const bool ready = frame_reader_.matched() > 0 && writer_.matched() > 0 && tracking_reader_.matched() > 0 &&
                       keyframe_reader_.matched() > 0;
    const char* const missing = !ready             ? "waiting for a camera and slam"
                                : detector_there() ? ""
                                                   : "waits for a detector";
    runtime_.heartbeat.set_state(*missing == '\0' ? msg::ServiceState::kReady : msg::ServiceState::kStarting, missing);
    return;
  }
  std::vector<std::string> remarks;
  if (imu_) {
    if (std::string silent = imu_->trouble(); !silent.empty()) remarks.push_back(std::move(silent));
  }
  if (detector_gone_) remarks.emplace_back("detector gone: geometry only");
  if (load_.step() > 0)
    remarks.push_back(
        fmt::format("computer too slow or busy: {}", service::kLoadSteps[static_cast<std::size_t>(load_.step())].name));
  runtime_.heartbeat.set_state(detector_gone_ ? msg::ServiceState::kDegraded : msg::ServiceState::kRunning,
                               fmt::format("{}", fmt::join(remarks, "; ")));
}

/// What the old mode knew is forgotten, so the first frames of the new one are judged without views to compare with.
bus::CommandAnswer FilterService::set_mode(const std::string& name) {
  const msg::NamedFilterMode* const found = msg::find_filter_mode(name);
  if (found == nullptr) {
    return {false,
            fmt::format("'{}' is no mode of the filter: choose {}", name, fmt::join(msg::filter_mode_names(), ", "))};
  }
  const std::string before = msg::name_of(filter_.mode());
  if (before == name) return {true, "the mode is " + name + " already"};
  filter_.set_mode(found->mode);
  runtime_.heartbeat.set_word(service::metric::kModePrefix, name);  // at once, frames or not
  movers_.clear();
  SPDLOG_INFO("event=mode_set_by_command mode={} before={}", name, before);
  return {true, fmt::format("mode {} from the next frame on, {} before", name, before)};
}

}  // namespace rtd::filter
