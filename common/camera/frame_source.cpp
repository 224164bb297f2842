// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/frame_source.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <numeric>

#include "common/msg/stamps.hpp"

namespace rtd::camera {

namespace {

struct SkipText {
  const char* name;
  const char* explanation;
};

constexpr std::array<SkipText, kSkipReasons> kSkipTexts{{
    {"malformed_line", "lines of the list are not 'stamp file': correct them, or leave them out with '#'"},
    {"no_depth_partner",
     "no depth image has the time of the colour image: compare the stamps of both, or allow more with ?tolerance_ms="},
    {"stamp_backwards",
     "stamps are older than those before: they are not the times of the frames, or it was recorded twice; give each "
     "frame its time in seconds (its number / the rate is enough)"},
    {"stamp_doubled",
     "stamps are the same as those before: the driver does not fill header.stamp, or the list repeats them; give each "
     "frame its own time"},
    {"color_unreadable", "colour images are missing or cannot be decoded: the first one says why"},
    {"depth_unreadable", "depth images are missing or cannot be decoded: the first one says why"},
    {"depth_not_16_bit", "depth images are not of 16 bits and one channel: write them so, 0 for no measurement"},
    {"size_mismatch",
     "the sizes of colour, depth and calibration differ: record in one mode of the camera, and give the calibration of "
     "that mode"},
    {"damaged_record", "the recording is damaged: 'rtd record recover FILE' saves what can be read"},
    {"overrun", "images came faster than they were taken: choose a lower rate or size of the camera"},
    {"color_frozen", "the colour image did not change for a second: unplug the camera and plug it in again"},
    {"repeated", "images come more than once, with the same bytes and stamp: each counts once"},
    {"other_camera",
     "two cameras send on one topic, and only the first is followed: give each of them topics of its own, or stop one"},
    {"emitter_dots",
     "the infrared camera's emitter is switched on and off in turn: images with its dots are left out, as the dots "
     "move with the camera"},
}};

}  // namespace

const char* to_string(SkipReason reason) {
  return kSkipTexts.at(static_cast<std::size_t>(reason)).name;
}

const char* explain(SkipReason reason) {
  return kSkipTexts.at(static_cast<std::size_t>(reason)).explanation;
}

std::optional<SkipReason> skip_reason_of(std::string_view name) {
  for (std::size_t i = 0; i < kSkipReasons; ++i)
    if (kSkipTexts.at(i).name == name) return static_cast<SkipReason>(i);
  return std::nullopt;
}

bool is_intended(SkipReason reason) {
  return reason == SkipReason::kRepeated || reason == SkipReason::kEmitterDots;
}

std::uint64_t SourceCounters::skipped_total() const {
  return std::accumulate(skipped.begin(), skipped.end(), std::uint64_t{0});
}

std::uint64_t SourceCounters::frames_left_out() const {
  const std::uint64_t alone = of(SkipReason::kNoDepthPartner);
  std::uint64_t left_out = 0;
  for (std::size_t i = 0; i < kSkipReasons; ++i) left_out += is_intended(static_cast<SkipReason>(i)) ? 0 : skipped[i];
  return left_out - alone + std::min(alone, depth_alone);
}

std::string why_unread(const io::IoError& error) {
  const std::string text = error.what();
  return error.code().value() == EXDEV ? text + "; " + kOutsideAdvice : text;
}

void SkipLog::add(SkippedInput input) {
  const bool usable = input.reason == SkipReason::kNoDepthPartner || input.reason == SkipReason::kOverrun;
  if (!usable && !is_intended(input.reason)) {
    ++unusable_;
    newest_ = input.detail;
  }
  ++counters_.skipped[static_cast<std::size_t>(input.reason)];
  skipped_.push_back(std::move(input));
}

void SkipLog::number(SourceFrame& frame) {
  frame.image.seq = counters_.frames++;
  if (!frame.has_depth) ++counters_.frames_without_depth;
  unusable_ = 0;
}

std::string SkipLog::why_none() const {
  if (unusable_ == 0) return {};
  return "no image can be used, " + std::to_string(unusable_) + " left out, the newest: " + newest_;
}

std::string SkipLog::summary() const {
  if (skipped_.empty()) return {};
  std::string text = ":";
  for (std::size_t i = 0; i < kSkipReasons; ++i) {
    if (counters_.skipped[i] == 0) continue;
    text += ' ' + std::to_string(counters_.skipped[i]) + " x " + to_string(static_cast<SkipReason>(i)) + ',';
  }
  const auto most = std::ranges::max_element(counters_.skipped) - counters_.skipped.begin();
  return text + " first: " + skipped_.front().detail + "; " + explain(static_cast<SkipReason>(most));
}

std::optional<SourceFrame> PlayedSource::next() {
  std::optional<SourceFrame> frame = first_ ? std::exchange(first_, std::nullopt) : read_next();
  if (frame) skips_.number(*frame);
  return frame;
}

std::uint64_t PlayedSource::pass_over(std::int64_t stamp_ns) {
  std::uint64_t passed = 0;
  if (first_ && first_->image.stamp_ns < stamp_ns) {
    first_.reset();
    ++passed;
  }
  while (!first_) {
    if (!gone_to_) gone_to_ = advance();
    if (!gone_to_ || *gone_to_ >= stamp_ns) break;
    gone_to_.reset();
    if (is_there()) {
      ++passed;
    } else {
      decode();  // which counts why it is no frame
    }
  }
  skips_.counters().frames += passed;
  return passed;
}

std::optional<SourceFrame> PlayedSource::read_next() {
  while (gone_to_ || (gone_to_ = advance())) {
    gone_to_.reset();
    if (std::optional<SourceFrame> frame = decode()) return frame;
  }
  return std::nullopt;
}

void PlayedSource::read_first(const std::string& file) {
  first_ = read_next();
  if (!first_) throw SourceError("no usable frame in " + file + skips_.summary());
}

std::optional<SkippedInput> size_mismatch(const std::string& name, const cv::Mat& color, const cv::Mat& depth,
                                          const geometry::CameraModel& camera, const std::string& more) {
  const cv::Size calibrated(camera.parameters().width, camera.parameters().height);
  if (color.size() == calibrated && depth.size() == calibrated) return std::nullopt;
  std::string turned;
  if (color.size() == depth.size() && color.size() == cv::Size(calibrated.height, calibrated.width)) {
    const auto& p = camera.parameters();
    turned = fmt::format(
        ". The images are those of the calibration turned by 90 degrees: give that of the turned image, clockwise "
        "?intrinsics={:.6g},{:.6g},{:.6g},{:.6g}{}, else {:.6g},{:.6g},{:.6g},{:.6g}{}",
        p.fy, p.fx, p.height - 1 - p.cy, p.cx, more, p.fy, p.fx, p.cy, p.width - 1 - p.cx, more);
  }
  return SkippedInput{SkipReason::kSizeMismatch, name + ": colour " + size_text(color.size()) + ", depth " +
                                                     size_text(depth.size()) + ", calibration " +
                                                     size_text(calibrated) + " px differ" + turned};
}

SourceFrame to_frame(std::int64_t stamp_ns, cv::Mat color_bgr, cv::Mat depth, const SourceInfo& info) {
  const bool has_depth = cv::countNonZero(depth) > 0;
  return {.image = {0, stamp_ns, std::move(color_bgr), std::move(depth), info.depth_scale_m, info.camera,
                    info.readout_s, info.depth_offset_s},
          .has_depth = has_depth};
}

void set_depth_stamp(SourceFrame& frame, std::int64_t depth_ns, const SourceInfo& info) {
  frame.image.depth_offset_s = 0;
  frame.depth_after_color_ns.reset();
  constexpr double kNear_ns = 1e9;  // their difference cannot overflow
  if (std::abs(static_cast<double>(depth_ns) - static_cast<double>(frame.image.stamp_ns)) > kNear_ns) return;
  frame.depth_after_color_ns = depth_ns - frame.image.stamp_ns;
  const double offset_s = static_cast<double>(*frame.depth_after_color_ns) * 1e-9 + info.depth_offset_s;
  if (msg::is_sensor_time(offset_s)) frame.image.depth_offset_s = offset_s;
}

geometry::Trajectory poses_of_span(geometry::Trajectory poses, std::int64_t from_ns, std::int64_t to_ns) {
  std::erase_if(poses, [=](const geometry::StampedPose& pose) {
    return pose.stamp_ns < from_ns - kGroundtruthMarginNs || pose.stamp_ns > to_ns + kGroundtruthMarginNs;
  });
  return poses;
}

std::string size_text(cv::Size size_px) {
  return std::to_string(size_px.width) + " x " + std::to_string(size_px.height);
}

}  // namespace rtd::camera
