// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/core/live/device_source.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "common/camera/calibration.hpp"
#include "common/camera/recording/ros_images.hpp"
#include "services/camera/core/live/device_modes.hpp"

namespace rtd::camera {
namespace {

constexpr std::chrono::milliseconds kLookAtDevice{100};  // between two looks at what is missing
constexpr std::chrono::milliseconds kFirstBackOff{100}, kLongestBackOff{500};
constexpr std::int64_t kSilentNs = 1'000'000'000;              // without an image of a stream
constexpr std::int64_t kPatienceNs = 3'000'000'000;            // for the first images, and for a pair
constexpr std::int64_t kDeviceReportPeriodNs = 1'000'000'000;  // while a fault lasts

constexpr int kOtherSizes = 30;  // pairs in a row that make the new size that of the camera

double seconds(std::int64_t time_ns) {
  return static_cast<double>(time_ns) * 1e-9;
}

}  // namespace

DeviceSource::DeviceSource(std::unique_ptr<LiveDevice> device, std::unique_ptr<DeviceClock> clock,
                           DeviceOptions options)
    : options_(std::move(options)), device_(std::move(device)), clock_(std::move(clock)), back_off_(kFirstBackOff) {
  info_.uri = options_.uri.text;
  info_.live = !options_.uri.recorded;
  if (!options_.uri.calibration_file.empty()) apply(read_calibration(options_.uri.calibration_file), info_);
}

DeviceSource::~DeviceSource() {
  device_->close();
}

bool DeviceSource::open() {
  const std::int64_t begin_ns = clock_->now_ns();
  while (!clock_->closed()) {
    first_ = step();
    if (first_) {
      opened_ = true;
      if (run_by_others_) drop_waiting();
      return true;
    }
    if (ended_) throw SourceError(device_->name() + " ended before its first frame" + skips_.summary());
    if (clock_->now_ns() - begin_ns > options_.open_timeout_ns) {
      throw SourceError(fmt::format("no frame within {:g} s: {}", seconds(options_.open_timeout_ns),
                                    run_by_others_ ? silence() : cause()));
    }
  }
  return false;
}

std::optional<SourceFrame> DeviceSource::next() {
  if (std::exchange(opened_, false) && managed()) drop_waiting();
  while (!clock_->closed() && !ended_) {
    std::optional<SourceFrame> frame = first_ ? std::exchange(first_, std::nullopt) : step();
    if (!frame) continue;
    skips_.number(*frame);
    return frame;
  }
  return std::nullopt;
}

std::optional<SourceFrame> DeviceSource::step() {
  if (!running_) {
    try_to_start();
    return std::nullopt;
  }
  try {
    std::optional<SourceFrame> frame = read();
    if (frame) {
      back_off_ = kFirstBackOff;
      last_pair_ns_ = clock_->now_ns();
    }
    restart_if_silent();
    const std::string fault = cause();
    if (frame || !fault.empty()) report(fault);
    return frame;
  } catch (const DeviceError& error) {
    error.problem() == DeviceProblem::kChanged ? begin_again(error.what()) : lose(error);
  }
  return std::nullopt;
}

/// Another program gives its images a new size or calibration: they make their own camera.
void DeviceSource::begin_again(const std::string& why) {
  report_now(why);
  device_->begin_again();
  known_ = false;
  other_sizes_ = 0;
  registration_.reset();
  forget_pairs();
  ++skips_.counters().reconnects;
}

void DeviceSource::try_to_start() {
  try {
    start();
  } catch (const DeviceError& error) {
    device_->close();
    if (!known_ && error.problem() != DeviceProblem::kAbsent) throw SourceError(error.what());
    problem_ = error.what();
    report(problem_);
    back_off();
  }
}

void DeviceSource::back_off() {
  clock_->wait(back_off_);
  back_off_ = std::min(2 * back_off_, kLongestBackOff);
}

void DeviceSource::start() {
  device_->open();
  const std::optional<DeviceSetup> setup = device_->start(options_.uri.mode);
  run_by_others_ = !setup;
  if (setup) use(*setup);
  forget_pairs();
  timeline_.restart();
  color_ = depth_ = {};
  started_ns_ = last_pair_ns_ = last_frame_ns_ = clock_->now_ns();
  health_.restart(started_ns_, setup_.color.fps);
  running_ = true;
}

void DeviceSource::use(const DeviceSetup& setup) {
  if (known_) {
    const bool same = setup.color.size_px == setup_.color.size_px && setup.depth.size_px == setup_.depth.size_px;
    if (!same) {
      throw DeviceError(DeviceProblem::kUnsupportedMode,
                        fmt::format("{} came back with images of {} px, not {} as before: plug in the camera that the "
                                    "run began with, or start again",
                                    device_->name(), size_text(setup.color.size_px), size_text(setup_.color.size_px)));
    }
    ++skips_.counters().reconnects;
  } else {
    calibrate(setup);
  }
  setup_ = setup;
}

/// What would make every frame unusable is an error, not a skipped frame.
void DeviceSource::calibrate(const DeviceSetup& setup) {
  const std::string name = device_->name();
  if (options_.uri.calibration_file.empty() && !setup.camera) {
    throw SourceError(name +
                      " does not know its lens: write a file with 'key: value' lines (width height fx fy cx cy, "
                      "k1 k2 p1 p2 k3, depth_factor) and give it with ?calibration=FILE");
  }
  adopt(setup);
  info_.fps = setup.color.fps;
  check_frame_size(setup.color.size_px.width, setup.color.size_px.height, name);
  const auto& camera = info_.camera.parameters();
  const cv::Size calibrated(camera.width, camera.height);
  const cv::Size depth_px = setup.depth_camera ? calibrated : setup.depth.size_px;
  if (calibrated == setup.color.size_px && depth_px == calibrated) return;
  throw SourceError(
      fmt::format("{}: colour {}, depth {}, calibration {} px differ: choose one size with ?width=&height= "
                  "and give a calibration of that size",
                  name, size_text(setup.color.size_px), size_text(setup.depth.size_px), size_text(calibrated)));
}

void DeviceSource::adopt(const DeviceSetup& setup) {
  info_.frame_id = setup.frame_id;
  if (options_.uri.calibration_file.empty()) {
    info_.camera = *setup.camera;
    info_.depth_scale_m = setup.depth_scale_m;
  }
  for (const std::string& remark : setup.remarks) {
    if (std::ranges::find(info_.remarks, remark) == info_.remarks.end()) info_.remarks.push_back(remark);
  }
  if (!setup.depth_camera) return;
  const auto& [camera, T_color_depth] = *setup.depth_camera;
  registration_.emplace(info_.camera, camera, T_color_depth, info_.depth_scale_m);
}

std::optional<SourceFrame> DeviceSource::read() {
  std::optional<FramePairer::Pair> pair = pairer_->next(skips_);
  if (!pair) {
    if (std::optional<DeviceImage> image = device_->read(kLookAtDevice)) take(std::move(*image));
    for (SkippedInput& skipped : device_->take_skipped()) skips_.add(std::move(skipped));
    pair = pairer_->next(skips_);
  }
  return pair ? make_frame(*pair) : std::nullopt;
}

void DeviceSource::take(DeviceImage image) {
  const bool is_color = image.stream == Stream::kColor;
  const std::int64_t now_ns = clock_->now_ns();
  Images& images = is_color ? color_ : depth_;
  images = {true, image.stamp_ns, now_ns};
  RecordedMessage& message = image.message;
  if (is_color && managed()) {
    health_.note_color(now_ns, message.bytes);
    follow_clock(image.stamp_ns, now_ns);
  }
  if (message.topic.empty()) {
    message.topic = fmt::format("{} of {}", to_string(image.stream), device_->name());
    message.recorded_ns = now_ns;
  }
  StampedMessage stamped{image.stamp_ns, std::move(message)};
  is_color ? pairer_->add_color(std::move(stamped), skips_) : pairer_->add_depth(std::move(stamped));
}

void DeviceSource::follow_clock(std::int64_t stamp_ns, std::int64_t now_ns) {
  const std::int64_t jump_ns = timeline_.note(stamp_ns, now_ns);
  if (jump_ns == 0) return;
  forget_pairs();
  report_now(fmt::format("the stamps of {} jumped by {:.3f} s: frames continue with the time of this host",
                         device_->name(), seconds(jump_ns)));
}

void DeviceSource::forget_pairs() {
  pairer_.emplace(FramePairer::Options{.tolerance_ns = options_.uri.tolerance_ns, .at_once = true});
}

bool DeviceSource::settle(const FramePairer::Pair& first) {
  const std::optional<DeviceSetup> setup = device_->setup_by(first, info_);
  if (!setup) return false;
  adopt(*setup);
  setup_ = *setup;
  return true;
}

std::optional<SourceFrame> DeviceSource::make_frame(const FramePairer::Pair& pair) {
  if (run_by_others_ && !known_ && !settle(pair)) return std::nullopt;
  const std::int64_t now_ns = clock_->now_ns();
  if (!run_by_others_) last_pair_ns_ = now_ns;  // it is not silent, whatever its images are
  const RecordedMessage& color_message = pair.color.message;
  if (health_.frozen(now_ns)) {
    skips_.add({SkipReason::kColorFrozen, name_of(color_message) + ": the same bytes as for the last second"});
    return std::nullopt;
  }
  ImageRead color = device_->decode(setup_.color, color_message);
  if (color.problem) {
    skips_.add(*color.problem);
    return std::nullopt;
  }
  ImageRead depth = device_->decode(setup_.depth, pair.depth.message);
  if (depth.problem) {
    skips_.add(*depth.problem);
    return std::nullopt;
  }
  if (registration_ && depth.image.size() == registration_->depth_size()) depth.image = (*registration_)(depth.image);
  const auto mismatch = size_mismatch(name_of(color_message), color.image, depth.image, info_.camera);
  if (mismatch) {
    skips_.add(*mismatch);
    note_other_size(color.image.size(), depth.image.size());
    return std::nullopt;
  }
  other_sizes_ = 0;
  const std::int64_t color_ns = pair.color.stamp_ns;
  const std::int64_t stamp_ns = managed()                   ? timeline_.host_ns(color_ns) + options_.epoch_ns
                                : setup_.stamped_by_arrival ? color_ns + options_.epoch_ns
                                                            : color_ns;
  SourceFrame frame = to_frame(stamp_ns, std::move(color.image), std::move(depth.image), info_);
  set_depth_stamp(frame, stamp_ns + pair.depth.stamp_ns - color_ns, info_);
  if (managed()) health_.note_frame(now_ns, frame.has_depth);
  last_frame_ns_ = now_ns;
  known_ = true;
  return frame;
}

void DeviceSource::note_other_size(cv::Size color_px, cv::Size depth_px) {
  if (!run_by_others_ || ++other_sizes_ < kOtherSizes) return;
  const auto& camera = info_.camera.parameters();
  throw DeviceError(
      DeviceProblem::kChanged,
      fmt::format("{} now gives images of {} px (depth {}), no longer {} x {}: it begins again with them",
                  device_->name(), size_text(color_px), size_text(depth_px), camera.width, camera.height));
}

void DeviceSource::restart_if_silent() {
  if (!managed()) return;
  const std::int64_t now_ns = clock_->now_ns();
  const bool stopped = color_.any && depth_.any && (arrivals(color_).silent || arrivals(depth_).silent);
  if (!stopped && now_ns - last_pair_ns_ < kPatienceNs) return;
  throw DeviceError(DeviceProblem::kAbsent, silence() + "; it is started again");
}

void DeviceSource::lose(const DeviceError& error) {
  device_->close();
  running_ = false;
  ended_ = error.problem() == DeviceProblem::kEnded;
  problem_ = error.what();
  if (ended_) return;
  report_now(problem_);
  back_off();
}

void DeviceSource::drop_waiting() {
  first_.reset();
  if (!running_) return;
  try {
    device_->drop_waiting();
  } catch (const DeviceError& error) {
    return lose(error);
  }
  if (managed()) forget_pairs();
  last_pair_ns_ = last_frame_ns_ = color_.arrived_ns = depth_.arrived_ns = clock_->now_ns();
  health_.restart(last_pair_ns_, setup_.color.fps);
}

void DeviceSource::report(const std::string& what) {
  if (what.empty()) {
    if (std::exchange(reported_fault_, false)) options_.on_wait({});
    return;
  }
  if (!reported_fault_ || clock_->now_ns() - reported_ns_ >= kDeviceReportPeriodNs) report_now(what);
}

void DeviceSource::report_now(const std::string& what) {
  reported_fault_ = true;
  reported_ns_ = clock_->now_ns();
  options_.on_wait(what);
}

std::string DeviceSource::cause() const {
  if (!running_) return problem_;
  if (!info_.live) return {};
  const std::int64_t now_ns = clock_->now_ns();
  if (now_ns - last_pair_ns_ >= kSilentNs) return silence();
  const std::string fault = health_.fault(now_ns);
  if (!fault.empty() || now_ns - last_frame_ns_ < kSilentNs) return fault;
  return skips_.why_none();
}

std::string DeviceSource::silence() const {
  const Arrivals color = arrivals(color_), depth = arrivals(depth_);
  if (!color.silent && !depth.silent) {
    if (std::string why = skips_.why_none(); !why.empty()) return why;
  }
  if (std::string why = device_->why_no_frame(color, depth); !why.empty()) return why;
  const auto none_of = [this](Stream stream, const Images& images) {
    const std::int64_t since_ns = images.any ? images.arrived_ns : started_ns_;
    return fmt::format("no {} image from {} for {:.1f} s", to_string(stream), device_->name(),
                       seconds(clock_->now_ns() - since_ns));
  };
  if (color.silent) return none_of(Stream::kColor, color_);
  if (depth.silent) return none_of(Stream::kDepth, depth_);
  return fmt::format(
      "no pair of colour and depth from {}: the newest stamps are {:.1f} ms apart, allowed are {:g} (?tolerance_ms=)",
      device_->name(), seconds(std::abs(color.stamp_ns - depth.stamp_ns)) * 1e3,
      seconds(options_.uri.tolerance_ns) * 1e3);
}

Arrivals DeviceSource::arrivals(const Images& images) const {
  return {!images.any || clock_->now_ns() - images.arrived_ns >= kSilentNs, images.stamp_ns};
}

}  // namespace rtd::camera
