// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "common/camera/calibration.hpp"
#include "common/camera/depth_alignment.hpp"
#include "common/camera/frame_source.hpp"
#include "common/camera/recording/emitter_switch.hpp"
#include "common/camera/recording/frame_pairer.hpp"
#include "common/camera/recording/recording.hpp"
#include "common/camera/recording/ros_images.hpp"
#include "common/camera/recording/sdk_topics.hpp"
#include "common/geometry/transform_log.hpp"
#include "common/io/text.hpp"
#include "common/ros_codec/wire.hpp"

namespace rtd::camera {
namespace {

double float_unit_of(const RecordedTopic& depth) {
  const auto factor = depth.metadata.find(kDepthFactor);
  const std::optional<double> value = factor == depth.metadata.end() ? std::nullopt : io::parse_number(factor->second);
  return value && *value >= 1 && *value <= 1e6 ? 1.0 / *value : kFloatDepthUnitM;
}

std::optional<Eigen::Isometry3d> tf_extrinsics(recordings::Reader& recording, const std::vector<std::string>& topics,
                                               const ImageOrigin& color, const ImageOrigin& depth) {
  if (topics.empty()) return std::nullopt;
  geometry::TransformLog transforms;
  recording.play(topics);
  while (const std::optional<RecordedMessage> message = recording.next()) {
    try {
      transforms.add(ros::decode<msg::TFMessage>(message->wire, message->bytes));
    } catch (const ros::WireError&) {
      continue;  // counted when it is played
    }
    if (auto T_color_depth = transforms.between(color.frame_id, depth.frame_id)) return T_color_depth;
  }
  return std::nullopt;
}

/// T_color_depth of a recording: identity for images in one frame, otherwise by what the camera's SDK
/// records with each stream, otherwise by tf (tf_static first). Reads transforms until it is found, whatever else was
/// played before; empty when it is not. Throws SourceError.
std::optional<Eigen::Isometry3d> recorded_extrinsics(recordings::Reader& recording, const ImageOrigin& color,
                                                     const ImageOrigin& depth) {
  if (same_place(color, depth)) return Eigen::Isometry3d::Identity();
  if (auto T_color_depth = sdk_extrinsics(recording, color.topic, depth.topic)) return T_color_depth;
  if (!names_a_place(color.frame_id) || !names_a_place(depth.frame_id)) return std::nullopt;
  const std::vector<std::string> all = transform_topics(recording);
  std::vector<std::string> lasting = all;
  std::erase_if(lasting, [](const std::string& topic) { return !topic.ends_with("tf_static"); });
  if (auto T_color_depth = tf_extrinsics(recording, lasting, color, depth)) return T_color_depth;
  return tf_extrinsics(recording, all, color, depth);
}

/// Two cameras may send on the topic in turn: of the first messages the one whose frame has most in common with that of
/// the colour images.
RecordedMessage first_beside(recordings::Reader& recording, const std::string& topic, const std::string& color_frame) {
  constexpr int kLookedAt = 4;
  RecordedMessage best = first_of(recording, topic);
  const auto in_common = [&](const RecordedMessage& message) {
    const std::string frame = ros::decode<msg::Header>(message.wire, message.bytes).frame_id;
    return std::ranges::mismatch(frame, color_frame).in1 - frame.begin();
  };
  recording.play({topic});
  for (int i = 0; i < kLookedAt; ++i) {
    std::optional<RecordedMessage> message = recording.next();
    if (!message) break;
    if (in_common(*message) > in_common(best)) best = std::move(*message);
  }
  return best;
}

class ImagePairs final : public RecordingSource {
 public:
  ImagePairs(std::string uri, std::unique_ptr<recordings::Reader> recording, const RecordingOptions& options);

  /// Of what was played so far.
  geometry::Trajectory groundtruth() const override;
  std::optional<Eigen::Isometry3d> true_pose(std::int64_t stamp_ns) const override {
    return transforms_.world_pose(color_.frame_id, stamp_ns, kTrueWithinNs);
  }

 private:
  std::optional<std::int64_t> advance() override;
  std::optional<SourceFrame> decode() override;
  void look_at_first_images(const RecordingOptions& options);
  void look_for_emitter_switch();
  bool shows_dots(const RecordedMessage& color);
  /// Whether the driver left all stamps of a topic at 0; then the times of recording take their place.
  bool lacks_stamps(const std::string& topic);
  void load_calibration(const RecordingOptions& options);
  void load_recorded_camera();
  void take_floats_per_metre(double per_metre);
  std::optional<geometry::CameraModel> recorded_camera(const std::string& info_topic, const ImageOrigin& image);
  /// Sees to it that depth is registered to colour.
  void align_depth();
  void take(RecordedMessage message);

  ImageTopics topics_;
  ImageOrigin color_, depth_;
  double float_step_;                  ///< of depth in floats: what becomes a unit, in the unit of the floats
  bool floats_ = false;                ///< depth is in floats
  int grey_bits_ = 16;                 ///< of 16-bit grey
  bool by_time_of_recording_ = false;  ///< frames have it in place of their stamps
  std::optional<vision::DepthRegistration> registration_;
  std::optional<EmitterSwitch> emitter_;  ///< of infrared in place of colour
  FramePairer pairer_;
  geometry::TransformLog transforms_;
  std::optional<FramePairer::Pair> pair_;  ///< gone to
  std::optional<std::int64_t> first_ns_;
  std::int64_t last_ns_ = 0;
};

ImagePairs::ImagePairs(std::string uri, std::unique_ptr<recordings::Reader> played, const RecordingOptions& options)
    : RecordingSource(std::move(uri), std::move(played)),
      topics_(choose_topics(*recording_, options.topics)),
      pairer_({.tolerance_ns = options.tolerance_ns}) {
  recordings::Reader& recording = *recording_;
  float_step_ = float_unit_of(*topic_named(recording, topics_.depth));
  describe_rate(topics_.color);
  info_.frames = std::min(info_.frames, topic_named(recording, topics_.depth)->messages);
  try {
    look_at_first_images(options);
    load_calibration(options);
    if (!options.registered) align_depth();
  } catch (const ros::WireError& error) {
    throw SourceError(recording.name() + ": a first message is damaged: " + error.what());
  }
  check_frame_size(info_.camera.parameters().width, info_.camera.parameters().height, recording.name());
  std::vector<std::string> playing = transform_topics(recording);
  playing.insert(playing.end(), {topics_.color, topics_.depth});
  recording.play(playing);
  read_first(recording.name());
}

void ImagePairs::look_at_first_images(const RecordingOptions& options) {
  const RecordedMessage color = first_of(*recording_, topics_.color);
  color_ = {topics_.color, ros::decode<msg::Header>(color.wire, color.bytes).frame_id, {}, {}};
  const RecordedMessage depth = first_beside(*recording_, topics_.depth, color_.frame_id);
  const ImageRead color_image = decode_color(color), depth_image = decode_depth(depth, float_step_);
  color_.size_px = color_image.image.size();
  info_.frame_id = place_named(color_.frame_id);
  depth_ = {topics_.depth, ros::decode<msg::Header>(depth.wire, depth.bytes).frame_id, depth_image.image.size(), {}};
  if (grey_bits_ = grey_bits(color); grey_bits_ < 16)
    info_.notes.push_back(fmt::format("{}: of {} bits of grey the upper eight are used", topics_.color, grey_bits_));
  for (const ImageRead* image : {&color_image, &depth_image}) {
    if (!image->remark.empty()) info_.remarks.push_back(image->remark);
  }
  for (const std::string& topic : {topics_.color, topics_.depth}) {
    if (by_time_of_recording_ || !lacks_stamps(topic)) continue;
    by_time_of_recording_ = true;
    info_.remarks.push_back(no_stamps(topic, "the times of recording"));
  }
  const std::optional<double>& requested = options.calibration.depth_factor;
  const auto sdk_unit_m = requested ? std::nullopt : sdk_depth_unit_m(*recording_, topics_.depth);
  info_.depth_scale_m = sdk_unit_m ? *sdk_unit_m : depth_unit_m(depth, float_step_);
  look_for_emitter_switch();
  floats_ = has_float_depth(depth);
  take_floats_per_metre(requested ? *requested : float_step(depth, info_.depth_scale_m) / info_.depth_scale_m);
}

void ImagePairs::look_for_emitter_switch() {
  if (!named_as_infrared(topics_.color)) return;
  emitter_.emplace();
  recording_->play({topics_.color});
  for (int i = 0; i < EmitterSwitch::kTurns + 2 && !emitter_->alternates(); ++i) {
    const std::optional<RecordedMessage> message = recording_->next();
    if (!message) return;
    shows_dots(*message);
  }
  if (emitter_->alternates())
    info_.notes.push_back(topics_.color +
                          ": the emitter is on in every second image; those with its dots are left out");
}

bool ImagePairs::shows_dots(const RecordedMessage& color) {
  if (!emitter_) return false;
  const ImageRead read = decode_color(color, grey_bits_);
  return !read.problem && emitter_->shows_dots(read.image);
}

/// Floats in another unit than ROS's metre.
void ImagePairs::take_floats_per_metre(double per_metre) {
  if (!floats_ || per_metre == 1) return;
  float_step_ = info_.depth_scale_m * per_metre;
  info_.notes.push_back(
      fmt::format("depth of {} is taken for 1/{:g} m, although ROS has metres in floats", topics_.depth, per_metre));
}

/// A simulation may well begin at 0: the second image decides.
bool ImagePairs::lacks_stamps(const std::string& topic) {
  std::size_t images = 0, unstamped = 0;
  recording_->play({topic});
  while (images < 2) {
    const std::optional<RecordedMessage> message = recording_->next();
    if (!message) break;
    ++images;
    if (msg::to_ns(ros::decode<msg::Header>(message->wire, message->bytes).stamp) == 0) ++unstamped;
  }
  return images == 2 && unstamped == 2;
}

/// The camera of a CameraInfo; empty when the recording has none.
std::optional<geometry::CameraModel> ImagePairs::recorded_camera(const std::string& info_topic,
                                                                 const ImageOrigin& image) {
  if (info_topic.empty()) return std::nullopt;
  msg::CameraInfo info = recorded_camera_info(*recording_, info_topic);
  if (info.width == 0 && info.height == 0) {  // not filled in
    info.width = static_cast<std::uint32_t>(image.size_px.width);
    info.height = static_cast<std::uint32_t>(image.size_px.height);
  }
  return to_camera_model(info, image.topic, recording_->name() + ", topic " + info_topic, image.size_px);
}

void ImagePairs::load_calibration(const RecordingOptions& options) {
  const CalibrationRequest& request = options.calibration;
  if (request.has_camera()) {
    const double recorded_m = info_.depth_scale_m;
    apply(requested_calibration(request, std::filesystem::path(recording_->name()).parent_path(), color_.size_px),
          info_);
    if (floats_) info_.depth_scale_m = recorded_m;  // floats say what they are
  } else {
    load_recorded_camera();
  }
  if (request.depth_factor && !floats_) info_.depth_scale_m = 1.0 / *request.depth_factor;
}

void ImagePairs::load_recorded_camera() {
  color_.camera = recorded_camera(topics_.info, color_);
  if (!color_.camera) {
    throw SourceError(
        recording_->name() + ": no sensor_msgs/CameraInfo next to " + topics_.color +
        "; name it (?info=TOPIC) or give ?calibration=FILE or ?intrinsics=fx,fy,cx,cy; its topics are:\n" +
        list_topics(*recording_));
  }
  info_.camera = *color_.camera;
}

void ImagePairs::align_depth() {
  std::string missing = "there must be a sensor_msgs/CameraInfo next to " + topics_.depth +
                        "; if it is elsewhere, name it: ?depth_info=TOPIC";
  try {
    depth_.camera = recorded_camera(topics_.depth_info, depth_);
    // A calibration file says nothing of how the two images compare.
    if (!color_.camera) color_.camera = recorded_camera(topics_.info, color_);
  } catch (const SourceError& error) {
    missing = std::string("the cameras must be known, but ") + error.what();
  }
  if (why_unregistered(color_, depth_).empty()) return;
  if (!depth_.camera) throw unregistered(recording_->name(), color_, depth_, missing);
  const auto T_color_depth = recorded_extrinsics(*recording_, color_, depth_);
  if (!T_color_depth) {
    throw unregistered(recording_->name(), color_, depth_,
                       "the transform between the two frames must be in tf_static or tf (RealSense SDK: .../tf/0)");
  }
  registration_.emplace(info_.camera, *depth_.camera, *T_color_depth, info_.depth_scale_m);
}

std::optional<std::int64_t> ImagePairs::advance() {
  while (!(pair_ = pairer_.next(skips_))) {
    std::optional<RecordedMessage> message = recording_->next();
    if (message) {
      take(std::move(*message));
      continue;
    }
    pairer_.finish();
    pair_ = pairer_.next(skips_);
    break;
  }
  if (!pair_) {
    take_damages();
    return std::nullopt;
  }
  last_ns_ = pair_->color.stamp_ns;
  if (!first_ns_) first_ns_ = last_ns_;
  return last_ns_;
}

void ImagePairs::take(RecordedMessage message) {
  try {
    const bool is_color = message.topic == topics_.color;
    if (!is_color && message.topic != topics_.depth) {
      return transforms_.add(ros::decode<msg::TFMessage>(message.wire, message.bytes));
    }
    const auto header = ros::decode<msg::Header>(message.wire, message.bytes);
    if (std::string other = of_other_camera(is_color ? color_ : depth_, header.frame_id); !other.empty()) {
      if (is_color) skips_.add({SkipReason::kOtherCamera, std::move(other)});
      return;
    }
    if (is_color && shows_dots(message))
      return skips_.add({SkipReason::kEmitterDots, name_of(message) + " shows the dots of the emitter"});
    const std::int64_t stamp_ns = by_time_of_recording_ ? message.recorded_ns : msg::to_ns(header.stamp);
    StampedMessage stamped{stamp_ns, std::move(message)};
    is_color ? pairer_.add_color(std::move(stamped), skips_) : pairer_.add_depth(std::move(stamped));
  } catch (const ros::WireError& error) {
    skips_.add({SkipReason::kDamagedRecord, name_of(message) + ": " + error.what()});
  }
}

std::optional<SourceFrame> ImagePairs::decode() {
  take_damages();
  return decode_pair(*std::exchange(pair_, std::nullopt), grey_bits_, float_step_, info_, registration_, skips_);
}

geometry::Trajectory ImagePairs::groundtruth() const {
  if (!first_ns_) return {};
  return poses_of_span(transforms_.world_poses(color_.frame_id), *first_ns_, last_ns_);
}

}  // namespace

std::unique_ptr<FrameSource> make_image_pairs(std::string uri, std::unique_ptr<recordings::Reader> recording,
                                              const RecordingOptions& options) {
  return std::make_unique<ImagePairs>(std::move(uri), std::move(recording), options);
}

}  // namespace rtd::camera
