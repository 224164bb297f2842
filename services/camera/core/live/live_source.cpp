// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/core/live/live_source.hpp"

#include <fmt/format.h>

#include <cstdlib>
#include <utility>
#include <vector>

#include "common/camera/calibration.hpp"
#include "common/camera/frame_source.hpp"
#include "common/camera/recording/ros_images.hpp"
#include "common/io/text.hpp"
#include "common/ros_codec/wire.hpp"
#include "common/camera/source_schemes.hpp"

namespace rtd::camera {
namespace {

/// Empty when the info describes none: it may still do to be left unused.
std::optional<geometry::CameraModel> usable_camera(const msg::CameraInfo& info, const std::string& image_topic,
                                                   const std::string& origin) {
  try {
    return to_camera_model(info, image_topic, origin);
  } catch (const SourceError&) {
    return std::nullopt;
  }
}

constexpr std::chrono::milliseconds kLook{100};          // between two looks at what is missing
constexpr std::int64_t kQuietNs = 1'000'000'000;         // without a frame: worth a report
constexpr std::int64_t kReportPeriodNs = 1'000'000'000;  // while it lasts
constexpr std::int64_t kAlignmentNs = 5'000'000'000;     // for what registers depth, once the images are there
constexpr std::uint64_t kSteppedImages = 30;             // in a row with a stamp before that of the last frame

}  // namespace

LiveSource::LiveSource(std::string uri, std::unique_ptr<LiveFeed> feed, LiveOptions options)
    : options_(std::move(options)),
      feed_(std::move(feed)),
      pairer_({.tolerance_ns = options_.tolerance_ns, .at_once = true}) {
  info_.uri = std::move(uri);
  info_.live = true;
  if (options_.calibration_file.empty()) return;
  apply(read_calibration(options_.calibration_file), info_);
  calibrated_ = true;
}

bool LiveSource::open() {
  const std::int64_t begin_ns = feed_->now_ns();
  last_pair_ns_ = begin_ns;
  while (!feed_->closed()) {
    std::optional<RecordedMessage> message = feed_->next(kLook);
    if (message && try_to_open(std::move(*message))) {
      report_frames();
      feed_->end_transforms();
      feed_->clear();
      dropped_ = feed_->dropped();
      return opened_ = true;
    }
    if (feed_->now_ns() - begin_ns > options_.open_timeout_ns) {
      throw SourceError(
          fmt::format("no frame within {:g} s: {}", static_cast<double>(options_.open_timeout_ns) * 1e-9, missing()));
    }
    give_up_aligning();
    report_wait();
  }
  return false;
}

/// True when a whole frame could be made of what has come.
bool LiveSource::try_to_open(RecordedMessage message) {
  take(std::move(message));
  const std::optional<FramePairer::Pair> pair = pairer_.next(skips_);
  if (!pair || !calibrated_) return false;
  check_first(*pair);
  return align_depth() && decode(*pair).has_value();
}

void LiveSource::take_calibration(const msg::CameraInfo& info) {
  if (color_origin_.camera) return;
  const std::string topic = "topic " + options_.topics.info;
  if (calibrated_) {  // by a file; to compare the two images their own intrinsics are needed all the same
    color_origin_.camera = usable_camera(info, options_.topics.color, topic);
    return check_after_opening();
  }
  color_origin_.camera = info_.camera = to_camera_model(info, options_.topics.color, topic);
  check_frame_size(info.width, info.height, topic);
  calibrated_ = true;
}

void LiveSource::take_depth_camera(const msg::CameraInfo& info) {
  if (depth_origin_.camera) return;
  depth_origin_.camera = usable_camera(info, options_.topics.depth, "topic " + options_.topics.depth_info);
  check_after_opening();
}

/// Frames may have been accepted before the camera of depth was known.
void LiveSource::check_after_opening() const {
  if (!opened_ || options_.registered || registration_) return;
  const std::string cause = why_unregistered(color_origin_, depth_origin_);
  if (!cause.empty()) throw unregistered(info_.uri, cause, "start the camera again, now that it is known");
}

void LiveSource::take_transforms(const RecordedMessage& message) {
  const auto transforms = ros::decode<msg::TFMessage>(message.wire, message.bytes);
  (message.topic == kLastingTransforms ? lasting_transforms_ : transforms_).add(transforms);
}

std::optional<Eigen::Isometry3d> LiveSource::extrinsics() const {
  if (same_place(color_origin_, depth_origin_)) return Eigen::Isometry3d::Identity();
  const std::string &color = color_origin_.frame_id, &depth = depth_origin_.frame_id;
  if (!names_a_place(color) || !names_a_place(depth)) return std::nullopt;
  if (auto T_color_depth = lasting_transforms_.between(color, depth)) return T_color_depth;
  return transforms_.between(color, depth);
}

/// What would make every frame unusable is an error, not a skipped frame.
void LiveSource::check_first(const FramePairer::Pair& pair) {
  try {
    const RecordedMessage &color = pair.color.message, &depth = pair.depth.message;
    const double unit_m = depth_unit_m(depth, kFloatDepthUnitM);
    if (options_.calibration_file.empty()) info_.depth_scale_m = unit_m;
    const ImageRead color_image = decode_color(color), depth_image = decode_depth(depth, kFloatDepthUnitM);
    color_origin_.topic = options_.topics.color;
    depth_origin_.topic = options_.topics.depth;
    color_origin_.frame_id = ros::decode<msg::Header>(color.wire, color.bytes).frame_id;
    depth_origin_.frame_id = ros::decode<msg::Header>(depth.wire, depth.bytes).frame_id;
    color_origin_.size_px = color_image.image.size();
    depth_origin_.size_px = depth_image.image.size();
    if (color_image.problem || depth_image.problem) return;
    const cv::Mat& fitting = options_.registered ? depth_image.image : color_image.image;
    const auto mismatch = size_mismatch(options_.topics.color, color_image.image, fitting, info_.camera);
    if (mismatch) throw SourceError(mismatch->detail);
  } catch (const ros::WireError&) {
    // decode() counts it
  }
}

bool LiveSource::align_depth() {
  lacking_.clear();
  if (options_.registered) return true;
  if (!first_lack_ns_) first_lack_ns_ = feed_->now_ns();
  unregistered_ = why_unregistered(color_origin_, depth_origin_);
  const bool may_come = !depth_origin_.camera && feed_->is_published(options_.topics.depth_info) &&
                        feed_->now_ns() - *first_lack_ns_ < kQuietNs;
  if (unregistered_.empty() && !may_come) return true;
  const std::optional<Eigen::Isometry3d> T_color_depth = extrinsics();
  if (!depth_origin_.camera) {
    lacking_ = fmt::format("a sensor_msgs/CameraInfo of depth on {} ({}; name another: ?depth_info=)",
                           options_.topics.depth_info, feed_->state_of(options_.topics.depth_info));
  } else if (!T_color_depth) {
    lacking_ =
        fmt::format("the transform from '{}' to '{}' on {} ({}) or {}", depth_origin_.frame_id, color_origin_.frame_id,
                    kLastingTransforms, feed_->state_of(kLastingTransforms), kTransforms);
  }
  if (!lacking_.empty()) return false;
  registration_.emplace(info_.camera, *depth_origin_.camera, *T_color_depth, info_.depth_scale_m);
  return true;
}

/// CameraInfos come with the images and lasting transforms at once: what is not there soon is not there.
void LiveSource::give_up_aligning() const {
  const bool over = !unregistered_.empty() && !lacking_.empty() && feed_->now_ns() - *first_lack_ns_ > kAlignmentNs;
  if (over) throw SourceError(missing());
}

std::optional<SourceFrame> LiveSource::next() {
  while (const std::optional<FramePairer::Pair> pair = next_pair()) {
    std::optional<SourceFrame> frame = decode(*pair);
    if (!frame) continue;
    skips_.number(*frame);
    report_frames();
    return frame;
  }
  return std::nullopt;
}

std::optional<FramePairer::Pair> LiveSource::next_pair() {
  while (!feed_->closed()) {
    if (std::optional<FramePairer::Pair> pair = pairer_.next(skips_)) return pair;
    std::optional<RecordedMessage> message = feed_->next(kLook);
    if (message) take(std::move(*message));
    refuse_stepped_clock();
    count_dropped();
    report_wait();
  }
  return std::nullopt;
}

void LiveSource::take(RecordedMessage message) {
  try {
    const std::string& topic = message.topic;
    if (topic == kLastingTransforms || topic == kTransforms) {
      if (!opened_) take_transforms(message);
    } else if (topic == options_.topics.info || topic == options_.topics.depth_info) {
      const auto info = ros::decode<msg::CameraInfo>(message.wire, message.bytes);
      if (topic == options_.topics.info) take_calibration(info);
      if (topic == options_.topics.depth_info) take_depth_camera(info);
    } else {
      take_image(std::move(message));
    }
  } catch (const ros::WireError& error) {
    skips_.add({SkipReason::kDamagedRecord, name_of(message) + ": " + error.what()});
  }
}

void LiveSource::take_image(RecordedMessage&& message) {
  const bool is_color = message.topic == options_.topics.color;
  if (!is_color && message.topic != options_.topics.depth) return;
  const msg::Header header = ros::decode<msg::Header>(message.wire, message.bytes);
  StampedMessage stamped{msg::to_ns(header.stamp), std::move(message)};
  Images& images = is_color ? color_ : depth_;
  images.any = true;
  images.stamp_ns = stamped.stamp_ns;
  images.arrived_ns = feed_->now_ns();
  is_color ? pairer_.add_color(std::move(stamped), skips_) : pairer_.add_depth(std::move(stamped));
}

std::optional<SourceFrame> LiveSource::decode(const FramePairer::Pair& pair) {
  return decode_pair(pair, kFloatDepthUnitM, info_, registration_, skips_);
}

/// A restarted driver or simulation gives stamps of the past, and no frame would ever follow.
void LiveSource::refuse_stepped_clock() {
  if (skips_.counters().of(SkipReason::kStampBackwards) - backwards_at_last_pair_ < kSteppedImages) return;
  throw SourceError(fmt::format(
      "the stamps on {} went back to {:.3f} s: was the driver restarted or its clock reset? Start the camera again",
      options_.topics.color, static_cast<double>(color_.stamp_ns) * 1e-9));
}

void LiveSource::count_dropped() {
  for (const std::uint64_t now = feed_->dropped(); dropped_ < now; ++dropped_) {
    skips_.add({SkipReason::kOverrun, "messages came faster than they were taken"});
  }
}

void LiveSource::report_wait() {
  const std::int64_t now_ns = feed_->now_ns();
  if (now_ns - last_pair_ns_ < kQuietNs || now_ns - reported_ns_ < kReportPeriodNs) return;
  waiting_ = true;
  reported_ns_ = now_ns;
  options_.on_wait(missing());
}

void LiveSource::report_frames() {
  last_pair_ns_ = feed_->now_ns();
  backwards_at_last_pair_ = skips_.counters().of(SkipReason::kStampBackwards);
  if (std::exchange(waiting_, false)) options_.on_wait({});
}

std::string LiveSource::missing() const {
  const auto no = [this](const char* what, const std::string& topic) {
    return fmt::format("no {} on {}: {}", what, topic, feed_->state_of(topic));
  };
  if (!lacking_.empty()) {
    if (unregistered_.empty()) return "no " + lacking_;
    return unregistered(options_.topics.depth, unregistered_, "there must be " + lacking_).what();
  }
  if (silent(color_)) return no("colour image", options_.topics.color);
  if (silent(depth_)) return no("depth image", options_.topics.depth);
  if (!calibrated_) return no("sensor_msgs/CameraInfo", options_.topics.info);
  return fmt::format(
      "no pair of colour and depth: the newest stamps on {} and {} are {:.1f} ms apart, allowed are {:g} "
      "(?tolerance_ms=)",
      options_.topics.color, options_.topics.depth,
      static_cast<double>(std::abs(color_.stamp_ns - depth_.stamp_ns)) * 1e-6,
      static_cast<double>(options_.tolerance_ns) * 1e-6);
}

bool LiveSource::silent(const Images& images) const {
  return !images.any || feed_->now_ns() - images.arrived_ns >= kQuietNs;
}

}  // namespace rtd::camera
