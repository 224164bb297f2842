// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/detector_service.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <exception>
#include <limits>
#include <stdexcept>
#include <thread>

#include "common/msg/engine_names.hpp"
#include "common/service/camera_frame.hpp"
#include "common/service/load_step.hpp"
#include "common/service/metric_names.hpp"
#include "common/service/model_locator.hpp"
#include "common/service/monotonic_clock.hpp"
#include "common/service/patience.hpp"
#include "common/vision/image_codecs.hpp"
#include "common/vision/rgbd_image.hpp"

namespace rtd::detector {

msg::Detection2DArray to_message(const std::vector<vision::Detection>& detections, std::int64_t stamp_ns,
                                 const std::string& camera_frame) {
  msg::Detection2DArray message;
  message.header = {msg::to_time(stamp_ns), camera_frame};
  for (const vision::Detection& detection : detections) {
    msg::ObjectHypothesisWithPose result;
    result.hypothesis = {detection.class_name, detection.score};
    msg::Detection2D box;
    box.header = message.header;
    box.results = {result};
    box.bbox.center.position = {detection.x_px + 0.5 * detection.width_px, detection.y_px + 0.5 * detection.height_px};
    box.bbox.size_x = detection.width_px;
    box.bbox.size_y = detection.height_px;
    message.detections.push_back(box);
  }
  return message;
}

namespace {

constexpr std::size_t kEveryFrameQueue = 8;  // deeper than the camera's window of frames in flight
constexpr double kNsPerMs = 1e6, kNsPerS = 1e9;

/// Of its own for each worker: a network holds the memory of its layers. Only pace asap has several images to work on.
std::vector<std::unique_ptr<EngineGuard>> load_detectors(const ServiceConfig& config, service::Pace pace) {
  std::vector<std::unique_ptr<EngineGuard>> detectors;
  const int count = pace == service::Pace::kAsap ? config.workers : 1;
  const auto load = [&] { return std::make_unique<EngineGuard>(core_config(config)); };
  for (int i = 0; i < count; ++i) detectors.push_back(load_network(load));
  return detectors;
}

}  // namespace

DetectorConfig core_config(const ServiceConfig& config) {
  const service::EnvironmentReader environment = service::process_environment();
  const service::ModelSearch model = service::find_model(config.model, environment);
  if (!model) throw service::ConfigError(model.message);
  DetectorConfig core = config.core;
  core.model_path = model.path;
  core.onnxruntime = service::find_onnxruntime();
  return core;
}

MaskConfig mask_config(const ServiceConfig& config) {
  const service::EnvironmentReader environment = service::process_environment();
  const service::ModelSearch model = service::find_mask_model(config.masks.use, config.masks.model, environment);
  if (!model && !model.message.empty())
    SPDLOG_INFO("event=no_masks effect=\"boxes alone\" cause=\"{}\"", model.message);
  MaskConfig masks = config.mask_core;
  masks.model_path = model.path;
  masks.engine = config.core.engine;
  masks.onnxruntime = service::find_onnxruntime();
  masks.threads = config.core.threads;
  return masks;
}

void DetectorService::add_options(CLI::App& app, std::vector<service::GivenOption>&) {
  app.footer("rtd-detector --image FILE...  prints what it finds in image files and ends.");
}

DetectorService::DetectorService(const Config& config, service::Runtime& runtime)
    : config_(config),
      runtime_(runtime),
      detectors_(load_detectors(config, runtime.pace)),
      engine_log_(config.core.engine),
      arrivals_(runtime.pace == service::Pace::kRealtime
                    ? std::make_shared<Arrivals>(1, concurrency::Overflow::kDropOldest)
                    : std::make_shared<Arrivals>(kEveryFrameQueue, concurrency::Overflow::kBlock)) {
  runtime.stop.on_stop([arrivals = arrivals_] { arrivals->close(); });
  load_masks();
  input_ = std::make_unique<ImageInput>(runtime, config_.input, [this](Arrival arrival) {
    if (masks_) masks_->saw_image(arrival.stamp_ns);
    arrivals_->push(std::move(arrival));
  });
  const Detector& detector = detectors_.front()->detector();
  SPDLOG_INFO("event=model_loaded file={} weights=\"{}\" input={}x{} threads={} workers={} device=\"{}\"",
              detector.config().model_path, service::describe_model(detector.config().model_path),
              detector.input_size().width_px, detector.input_size().height_px, config_.core.threads, detectors_.size(),
              detector.device());
  report_engine(*detectors_.front());
}

/// The writer of boxes comes after that of masks: who reads both has then both.
void DetectorService::load_masks() {
  const MaskConfig masks = mask_config(config_);
  if (!masks.model_path.empty()) {
    const bool in_time = runtime_.pace == service::Pace::kRealtime;
    masks_ = load_network([&] { return std::make_unique<MaskStage>(masks, detectors_.size(), in_time); });
    mask_writer_ = runtime_.bus.writer(bus::topics::kPersonMasks);
    runtime_.heartbeat.set_metric(service::metric::kMasks, 0);  // readers rely on it: masks come
    SPDLOG_INFO("event=masks_loaded file={} weights=\"{}\" device=\"{}\"", masks.model_path,
                service::describe_model(masks.model_path), masks_->segmenter().device());
  }
  detections_ = runtime_.bus.writer(bus::topics::kDetections);
}

/// A reader waits for its running callback, which may be blocked on the full queue.
DetectorService::~DetectorService() {
  arrivals_->close();
}

service::ExitCode DetectorService::run() {
  std::vector<std::thread> others;
  for (std::size_t i = 1; i < detectors_.size(); ++i) others.emplace_back([this, i] { work(i); });
  work(0);
  for (std::thread& other : others) other.join();
  const MaskStage::Counters masks = masks_ ? masks_->counters() : MaskStage::Counters{};
  const std::uint64_t detected = detected_;
  SPDLOG_INFO(
      "event=summary frames={} dropped={} broken={} detect_ms={:.1f} detect_ms_max={:.1f} masks={} masks_ms={:.1f}",
      detected, arrivals_->dropped(), broken_,
      total_detect_ms_ / static_cast<double>(std::max<std::uint64_t>(detected, 1)), max_detect_ms_, masks.masks,
      masks.mean_ms());
  return service::kOk;
}

/// Detects until the end. Several workers share the queue; their detections are published in the order of the images.
void DetectorService::work(std::size_t worker) {
  while (!runtime_.stop.stop_requested()) {
    runtime_.heartbeat.tick();
    report_state();
    const std::optional<Taken> taken = take();
    if (!taken) continue;
    const std::int64_t started_ns = service::monotonic_ns();
    const std::optional<Found> found = detect(worker, taken->arrival);
    const std::int64_t detected_ns = service::monotonic_ns();
    publish_in_turn(taken->turn, found);
    const std::uint64_t frame = taken->arrival.frame ? taken->arrival.frame->seq : taken->turn;
    runtime_.trace.span("detect", started_ns, detected_ns, frame);
    runtime_.trace.span("publish", detected_ns, service::monotonic_ns(), frame);
    keep_rate(started_ns);
  }
}

std::optional<DetectorService::Taken> DetectorService::take() {
  const std::lock_guard lock(take_mutex_);
  std::optional<Arrival> arrival = arrivals_->pop_for(service::state_period(taken_ > 0));
  if (!arrival) return std::nullopt;
  return Taken{std::move(*arrival), taken_++};
}

/// The masks first: who waits for both has both with the boxes, or soon after.
void DetectorService::publish_in_turn(std::uint64_t turn, const std::optional<Found>& found) {
  std::unique_lock lock(turn_mutex_);
  turn_changed_.wait(lock, [&] { return published_ == turn; });
  if (found && found->masks) mask_writer_.write(*found->masks);
  if (found) detections_.write(found->detections);
  ++published_;
  turn_changed_.notify_all();
}

/// The pixels of an arrival; empty or std::invalid_argument when they are broken. A frame's pixels stay in the message.
std::optional<cv::Mat> DetectorService::image_of(const Arrival& arrival) {
  if (arrival.jpeg) {
    vision::DecodedImage decoded = vision::decode_image(arrival.jpeg->data, vision::kBusImages);
    if (!decoded.problem.empty()) throw std::invalid_argument("it " + decoded.problem);
    return std::move(decoded.pixels);
  }
  const cv::Mat image = vision::view_color(*arrival.frame);
  return image.empty() ? std::nullopt : std::optional(image);
}

/// Empty for an image that cannot be used, which is counted and logged.
std::optional<DetectorService::Found> DetectorService::detect(std::size_t worker, const Arrival& arrival) {
  const std::int64_t started_ns = service::monotonic_ns();
  EngineGuard& detector = *detectors_[worker];
  try {
    if (const std::optional<cv::Mat> image = image_of(arrival)) {
      const auto boxes = detector.detect(*image);
      const double boxes_ms = static_cast<double>(service::monotonic_ns() - started_ns) / kNsPerMs;
      Found found{to_message(boxes, arrival.stamp_ns, service::camera_frame(runtime_.heartbeat, runtime_.bus)),
                  std::nullopt};
      found.masks = find_masks(worker, {*image, boxes, boxes_ms}, found.detections.header);
      report_engine(detector);
      count(boxes_ms);
      return found;
    }
    skip(arrival, "not an image of a readable size");
  } catch (const std::exception& error) {  // data from outside never ends the process
    skip(arrival, error.what());
  }
  return std::nullopt;
}

/// For every image while masks have a reader, also where no person is: who waits for them need not guess.
std::optional<msg::Image> DetectorService::find_masks(std::size_t worker, const BoxedImage& boxed,
                                                      const msg::Header& header) {
  if (!masks_ || mask_writer_.matched() == 0) return std::nullopt;
  return to_message(masks_->segment(worker, boxed), boxed.color_bgr.size(), header);
}

/// What computes the boxes, in the status and the log.
void DetectorService::report_engine(const EngineGuard& detector) {
  const std::lock_guard lock(counters_mutex_);
  engine_ = "computes on " + detector.detector().device();
  if (!detector.fallback().empty()) engine_ += " in place of " + config_.core.engine + ": " + detector.fallback();
  engine_log_.report(detector);
}

void DetectorService::skip(const Arrival& arrival, const std::string& cause) {
  const std::lock_guard lock(counters_mutex_);
  runtime_.heartbeat.set_metric(service::metric::kFramesBroken, static_cast<double>(++broken_));
  if (broken_log_.pass()) {
    SPDLOG_WARN("event=image_skipped stamp_ns={} total={} cause=\"{}\"", arrival.stamp_ns, broken_, cause);
  }
}

void DetectorService::count(double detect_ms) {
  const std::lock_guard lock(counters_mutex_);
  ++detected_;
  total_detect_ms_ += detect_ms;
  max_detect_ms_ = std::max(max_detect_ms_, detect_ms);
  runtime_.heartbeat.set_metric(service::metric::kFrames, static_cast<double>(detected_));
  runtime_.heartbeat.set_metric(service::metric::kFramesDropped, static_cast<double>(arrivals_->dropped()));
  runtime_.heartbeat.set_metric(service::metric::kDetectMs, total_detect_ms_ / static_cast<double>(detected_));
  runtime_.heartbeat.set_metric(service::metric::kDetectMsMax, max_detect_ms_);
  if (!masks_) return;
  const MaskStage::Counters masks = masks_->counters();
  runtime_.heartbeat.set_metric(service::metric::kMasks, static_cast<double>(masks.masks));
  runtime_.heartbeat.set_metric(service::metric::kMasksMs, masks.mean_ms());
}

bool DetectorService::peers_matched() const {
  return input_->matched() > 0 && detections_.matched() > 0;
}

void DetectorService::report_state() {
  input_->update();
  if (!peers_matched()) {
    runtime_.heartbeat.set_state(msg::ServiceState::kStarting, "waits for a camera and a filter");
  } else {
    const std::lock_guard lock(counters_mutex_);
    runtime_.heartbeat.set_state(detected_ > 0 ? msg::ServiceState::kRunning : msg::ServiceState::kReady, engine_);
  }
}

/// Realtime pace with a rate limit, of the configuration or of a busy computer: sleeps until the next detection is due;
/// newer images replace the queued one meanwhile.
void DetectorService::keep_rate(std::int64_t started_ns) const {
  if (runtime_.pace != service::Pace::kRealtime) return;
  double rate_hz = config_.max_rate_hz > 0 ? config_.max_rate_hz : std::numeric_limits<double>::infinity();
  if (const double busy_hz = service::asked_load_step(runtime_.heartbeat).max_detections_hz; busy_hz > 0)
    rate_hz = std::min(rate_hz, busy_hz);
  const auto period_ns = static_cast<std::int64_t>(kNsPerS / rate_hz);  // 0 without a limit
  const std::int64_t left_ns = started_ns + period_ns - service::monotonic_ns();
  if (left_ns <= 0) return;
  runtime_.heartbeat.idle();
  runtime_.stop.wait_for(std::chrono::nanoseconds(left_ns));
}

}  // namespace rtd::detector
