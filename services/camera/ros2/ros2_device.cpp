// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/ros2/ros2_device.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "common/camera/calibration.hpp"
#include "common/io/printable.hpp"
#include "common/ros_codec/wire.hpp"

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

constexpr std::int64_t kInfoNs = 1'000'000'000;       // for a CameraInfo of depth that is published
constexpr std::int64_t kAlignmentNs = 5'000'000'000;  // for what registers depth, once the images are there
constexpr std::uint64_t kSteppedImages = 30;          // in a row with a stamp before that of the last frame
constexpr std::uint64_t kRecalibratedImages = 30;     // in a row with another CameraInfo
constexpr std::uint64_t kOtherImages = 30;            // in a row in another frame
constexpr double kRecalibrated_px = 1;
constexpr std::uint64_t kUnstamped = 3;  // one of two streams has two then, and no clock stands still

}  // namespace

Ros2Device::Ros2Device(std::string uri, std::unique_ptr<LiveFeed> feed, LiveOptions options)
    : uri_(std::move(uri)), feed_(std::move(feed)), options_(std::move(options)) {}

std::optional<DeviceImage> Ros2Device::read(std::chrono::milliseconds timeout) {
  if (!opened_) give_up_aligning();
  std::optional<RecordedMessage> message = feed_->next(timeout);
  if (!message) return std::nullopt;
  try {
    return take(*message);
  } catch (const ros::WireError& error) {
    skipped_.push_back({SkipReason::kDamagedRecord, name_of(*message) + ": " + error.what()});
    return std::nullopt;
  }
}

std::optional<DeviceImage> Ros2Device::take(RecordedMessage& message) {
  const std::string& topic = message.topic;
  if (topic == kLastingTransforms || topic == kTransforms) {
    if (!opened_) take_transforms(message);
  } else if (topic == options_.topics.info || topic == options_.topics.depth_info) {
    const auto info = ros::decode<msg::CameraInfo>(message.wire, message.bytes);
    if (topic == options_.topics.info) take_calibration(info);
    if (topic == options_.topics.depth_info) take_depth_camera(info);
  } else {
    return take_image(message);
  }
  return std::nullopt;
}

std::optional<DeviceImage> Ros2Device::take_image(RecordedMessage& message) {
  const bool is_color = message.topic == options_.topics.color;
  if (!is_color && message.topic != options_.topics.depth) return std::nullopt;
  if (opened_ && is_of_other_camera(message)) return std::nullopt;
  const std::optional<std::int64_t> stamp_ns = stamp_of(message);
  if (!stamp_ns) return std::nullopt;
  if (is_color) note_color(*stamp_ns);
  if (is_color && shows_dots(message)) {
    skipped_.push_back({SkipReason::kEmitterDots, name_of(message) + " shows the dots of the emitter"});
    return std::nullopt;
  }
  return DeviceImage{is_color ? Stream::kColor : Stream::kDepth, *stamp_ns, std::move(message)};
}

bool Ros2Device::shows_dots(const RecordedMessage& color) {
  if (!named_as_infrared(color.topic)) return false;
  const ImageRead read = decode_color(color, grey_bits_);
  return !read.problem && emitter_.shows_dots(read.image);
}

/// In turn with its own: a second camera. Its own no more: the driver was started again with another name.
bool Ros2Device::is_of_other_camera(const RecordedMessage& message) {
  const bool is_color = message.topic == options_.topics.color;
  const auto header = ros::decode<msg::Header>(message.wire, message.bytes);
  std::string other = of_other_camera(is_color ? color_origin_ : depth_origin_, header.frame_id);
  if (is_color && other.empty()) other_camera_ = 0;
  if (!is_color || other.empty()) return !other.empty();
  if (++other_camera_ >= kOtherImages)
    throw DeviceError(DeviceProblem::kChanged,
                      fmt::format("the images on {} are in frame '{}' now: the camera begins again with them",
                                  options_.topics.color, io::abridged(header.frame_id)));
  skipped_.push_back({SkipReason::kOtherCamera, std::move(other)});
  return true;
}

/// A simulation may well begin at 0, and continues.
std::optional<std::int64_t> Ros2Device::stamp_of(const RecordedMessage& message) {
  if (by_arrival_) return message.recorded_ns;
  const std::int64_t stamp_ns = msg::to_ns(ros::decode<msg::Header>(message.wire, message.bytes).stamp);
  if (stamp_ns != 0 || opened_) {
    unstamped_ = 0;
    return stamp_ns;
  }
  by_arrival_ = ++unstamped_ >= kUnstamped;
  if (!by_arrival_) return std::nullopt;
  remarks_.push_back(no_stamps(message.topic, "the times of arrival"));
  return message.recorded_ns;
}

/// A restarted driver or simulation gives stamps of the past, and no frame would ever follow.
void Ros2Device::note_color(std::int64_t stamp_ns) {
  if (recalibrated_ > 0 && ++recalibrated_ > kRecalibratedImages) {
    throw DeviceError(
        DeviceProblem::kChanged,
        fmt::format("{} has changed (now {} x {} px, fx {:g}, it was {} x {} px, fx {:g}): the camera begins again "
                    "with it",
                    options_.topics.info, newest_info_->width, newest_info_->height, newest_info_->k[0],
                    color_origin_.camera->parameters().width, color_origin_.camera->parameters().height,
                    color_origin_.camera->parameters().fx));
  }
  if (stamp_ns > newest_color_ns_) stepped_ = 0;
  if (stamp_ns < newest_color_ns_) ++stepped_;
  newest_color_ns_ = std::max(newest_color_ns_, stamp_ns);
  if (!opened_ || stepped_ < kSteppedImages) return;
  throw SourceError(fmt::format(
      "the stamps on {} went back to {:.3f} s: was the driver restarted or its clock reset? Start the camera again",
      options_.topics.color, static_cast<double>(stamp_ns) * 1e-9));
}

void Ros2Device::take_calibration(const msg::CameraInfo& info) {
  newest_info_ = info;
  if (opened_ && color_origin_.camera) return watch_calibration(info);
  const std::string topic = "topic " + options_.topics.info;
  if (!options_.calibration_file
           .empty()) {  // by a file; to compare the two images their own intrinsics are needed all the same
    color_origin_.camera = usable_camera(info, options_.topics.color, topic);
    return check_after_opening();
  }
  color_origin_.camera = to_camera_model(info, options_.topics.color, topic);
  check_frame_size(info.width, info.height, topic);
}

/// Infos that change with each image belong to images of two kinds: the sizes of these decide.
void Ros2Device::watch_calibration(const msg::CameraInfo& info) {
  if (!options_.calibration_file.empty()) return;
  const auto camera = usable_camera(info, options_.topics.color, "topic " + options_.topics.info);
  const bool other = camera && difference_px(*camera, *color_origin_.camera) > kRecalibrated_px;
  if (!other || recalibrated_ == 0) recalibrated_ = other ? 1 : 0;
}

void Ros2Device::take_depth_camera(const msg::CameraInfo& info) {
  newest_depth_info_ = info;
  if (opened_ && depth_origin_.camera) return;
  depth_origin_.camera = usable_camera(info, options_.topics.depth, "topic " + options_.topics.depth_info);
  check_after_opening();
}

/// Frames may have been accepted before the camera of depth was known.
void Ros2Device::check_after_opening() const {
  if (!opened_ || options_.registered || depth_camera_) return;
  const std::string cause = why_unregistered(color_origin_, depth_origin_);
  if (cause.empty()) return;
  throw DeviceError(DeviceProblem::kChanged,
                    fmt::format("the camera of depth is known now: {}. The camera begins again to register it", cause));
}

void Ros2Device::take_transforms(const RecordedMessage& message) {
  const auto transforms = ros::decode<msg::TFMessage>(message.wire, message.bytes);
  (message.topic == kLastingTransforms ? lasting_transforms_ : transforms_).add(transforms);
}

std::optional<Eigen::Isometry3d> Ros2Device::extrinsics() const {
  if (same_place(color_origin_, depth_origin_)) return Eigen::Isometry3d::Identity();
  const std::string &color = color_origin_.frame_id, &depth = depth_origin_.frame_id;
  if (!names_a_place(color) || !names_a_place(depth)) return std::nullopt;
  if (auto T_color_depth = lasting_transforms_.between(color, depth)) return T_color_depth;
  return transforms_.between(color, depth);
}

std::optional<DeviceSetup> Ros2Device::setup_by(const FramePairer::Pair& first, const SourceInfo& known) {
  if (!calibrated()) return std::nullopt;
  if (!check_first(first, known) || !align_depth()) return std::nullopt;
  opened_ = begun_again_;
  DeviceSetup setup;
  setup.color.stream = Stream::kColor;
  setup.depth.stream = Stream::kDepth;
  setup.depth_scale_m = unit_m_;
  setup.camera = color_origin_.camera;
  setup.depth_camera = depth_camera_;
  setup.remarks = remarks_;
  setup.frame_id = place_named(color_origin_.frame_id);
  setup.stamped_by_arrival = by_arrival_;
  return setup;
}

void Ros2Device::begin_again() {
  begun_again_ = true;
  opened_ = by_arrival_ = false;
  color_origin_ = depth_origin_ = {};
  depth_camera_.reset();
  first_lack_ns_.reset();
  first_misfit_ns_.reset();
  unregistered_.clear();
  lacking_.clear();
  remarks_.clear();
  recalibrated_ = unstamped_ = stepped_ = other_camera_ = 0;
  newest_color_ns_ = std::numeric_limits<std::int64_t>::min();
  if (newest_info_) take_calibration(msg::CameraInfo(*newest_info_));  // a latched one does not come again
  if (newest_depth_info_) take_depth_camera(msg::CameraInfo(*newest_depth_info_));
}

/// What would make every frame unusable is an error, not a skipped frame.
bool Ros2Device::check_first(const FramePairer::Pair& pair, const SourceInfo& known) {
  lacking_.clear();
  try {
    const RecordedMessage &color = pair.color.message, &depth = pair.depth.message;
    unit_m_ = depth_unit_m(depth, kFloatDepthUnitM);
    float_step_ = float_step(depth, kFloatDepthUnitM);
    grey_bits_ = grey_bits(color);
    const ImageRead color_image = decode_color(color), depth_image = decode_depth(depth, float_step_);
    color_origin_.topic = options_.topics.color;
    depth_origin_.topic = options_.topics.depth;
    color_origin_.frame_id = ros::decode<msg::Header>(color.wire, color.bytes).frame_id;
    depth_origin_.frame_id = ros::decode<msg::Header>(depth.wire, depth.bytes).frame_id;
    color_origin_.size_px = color_image.image.size();
    depth_origin_.size_px = depth_image.image.size();
    if (color_image.problem || depth_image.problem) return true;
    for (const ImageRead* image : {&color_image, &depth_image}) {
      if (!image->remark.empty() && std::ranges::count(remarks_, image->remark) == 0) remarks_.push_back(image->remark);
    }
    const cv::Mat fitting =
        options_.registered ? scaled_to(color_origin_.size_px, depth_image.image) : color_image.image;
    const auto& camera = options_.calibration_file.empty() ? *color_origin_.camera : known.camera;
    const auto mismatch = size_mismatch(options_.topics.color, color_image.image, fitting, camera);
    if (mismatch) return may_still_fit(mismatch->detail);
  } catch (const ros::WireError&) {
    // decode() reports it
  }
  return true;
}

/// A driver that was just restarted may publish its images before its CameraInfo.
bool Ros2Device::may_still_fit(const std::string& mismatch) {
  if (!first_misfit_ns_) first_misfit_ns_ = feed_->now_ns();
  if (feed_->now_ns() - *first_misfit_ns_ > kInfoNs) throw SourceError(mismatch);
  lacking_ = "sensor_msgs/CameraInfo that fits the images: " + mismatch;
  return false;
}

bool Ros2Device::align_depth() {
  lacking_.clear();
  if (options_.registered) return true;
  if (!first_lack_ns_) first_lack_ns_ = feed_->now_ns();
  unregistered_ = why_unregistered(color_origin_, depth_origin_);
  const bool may_come = !depth_origin_.camera && feed_->is_published(options_.topics.depth_info) &&
                        feed_->now_ns() - *first_lack_ns_ < kInfoNs;
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
  depth_camera_ = {*depth_origin_.camera, *T_color_depth};
  return true;
}

std::string Ros2Device::lack() const {
  if (unregistered_.empty()) return "no " + lacking_;
  return unregistered(options_.topics.depth, color_origin_, depth_origin_, "there must be " + lacking_).what();
}

/// CameraInfos come with the images and lasting transforms at once: what is not there soon is not there.
void Ros2Device::give_up_aligning() const {
  const bool over = !unregistered_.empty() && !lacking_.empty() && feed_->now_ns() - *first_lack_ns_ > kAlignmentNs;
  if (over) throw SourceError(lack());
}

void Ros2Device::drop_waiting() {
  feed_->end_transforms();
  feed_->clear();
  dropped_ = feed_->dropped();
  of_others_ = feed_->of_others();
  stepped_ = 0;
  opened_ = true;
}

ImageRead Ros2Device::decode(const DeviceMode& mode, const RecordedMessage& message) const {
  if (mode.stream == Stream::kColor) return decode_color(message, grey_bits_);
  ImageRead depth = decode_depth(message, float_step_);
  if (options_.registered) depth.image = scaled_to(color_origin_.size_px, depth.image);
  return depth;
}

std::vector<SkippedInput> Ros2Device::take_skipped() {
  if (opened_) {
    for (const std::uint64_t now = feed_->dropped(); dropped_ < now; ++dropped_)
      skipped_.push_back({SkipReason::kOverrun, "messages came faster than they were taken"});
    for (const std::uint64_t now = feed_->of_others(); of_others_ < now; ++of_others_)
      skipped_.push_back(
          {SkipReason::kOtherCamera, "two publishers send on " + options_.topics.color + ": the first is followed"});
  }
  return std::exchange(skipped_, {});
}

std::string Ros2Device::why_no_frame(const Arrivals& color, const Arrivals& depth) const {
  const auto no = [this](const char* what, const std::string& topic) {
    return fmt::format("no {} on {}: {}", what, topic, feed_->state_of(topic));
  };
  if (!lacking_.empty()) return lack();
  if (color.silent) return no("colour image", options_.topics.color);
  if (depth.silent) return no("depth image", options_.topics.depth);
  if (!calibrated()) return no("sensor_msgs/CameraInfo", options_.topics.info);
  if (std::abs(color.stamp_ns - depth.stamp_ns) <= options_.tolerance_ns) return "colour and depth come, no frame yet";
  return fmt::format(
      "no pair of colour and depth: the newest stamps on {} and {} are {:.1f} ms apart, allowed are {:g} "
      "(?tolerance_ms=)",
      options_.topics.color, options_.topics.depth,
      static_cast<double>(std::abs(color.stamp_ns - depth.stamp_ns)) * 1e-6,
      static_cast<double>(options_.tolerance_ns) * 1e-6);
}

}  // namespace rtd::camera
