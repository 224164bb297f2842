// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/io/text.hpp"
#include "common/ros_codec/wire.hpp"
#include "services/camera/core/calibration.hpp"
#include "services/camera/core/frame_source.hpp"
#include "services/camera/core/recording/frame_pairer.hpp"
#include "services/camera/core/recording/recording_source.hpp"
#include "services/camera/core/recording/ros_images.hpp"
#include "services/camera/core/recording/transform_log.hpp"

namespace rtd::camera {
namespace {

double float_unit_of(const RecordedTopic& depth) {
  const auto factor = depth.metadata.find(kDepthFactor);
  const std::optional<double> value = factor == depth.metadata.end() ? std::nullopt : io::parse_number(factor->second);
  return value && *value >= 1 && *value <= 1e6 ? 1.0 / *value : kFloatDepthUnitM;
}

/// Frames from two topics of ROS images, one of their calibration and, where the recording has them, transforms.
class ImagePairs final : public FrameAssembly {
 public:
  ImagePairs(Recording& recording, const RecordingOptions& options);

  const SourceInfo& info() const override { return info_; }
  std::optional<std::int64_t> advance(SkipLog& skips) override;
  std::optional<SourceFrame> decode(SkipLog& skips) override;
  geometry::Trajectory groundtruth() const override;

 private:
  void load_calibration(const RecordingOptions& options);
  void look_at_first_images(bool depth_named);
  void take(RecordedMessage message, SkipLog& skips);

  Recording& recording_;
  ImageTopics topics_;
  std::string color_type_, depth_type_, camera_frame_;
  double float_unit_m_;  ///< of depth in floats
  SourceInfo info_;
  FramePairer pairer_;
  TransformLog transforms_;
  std::optional<FramePairer::Pair> pair_;  ///< gone to
  std::optional<std::int64_t> first_ns_;
  std::int64_t last_ns_ = 0;
};

ImagePairs::ImagePairs(Recording& recording, const RecordingOptions& options)
    : recording_(recording), topics_(choose_topics(recording, options.topics)) {
  color_type_ = topic_named(recording, topics_.color)->type;
  depth_type_ = topic_named(recording, topics_.depth)->type;
  float_unit_m_ = float_unit_of(*topic_named(recording, topics_.depth));
  describe_rate(recording, topics_.color, info_);
  try {
    look_at_first_images(!options.topics.depth.empty());
    load_calibration(options);
  } catch (const ros::WireError& error) {
    throw SourceError(recording.name() + ": a first message is damaged: " + error.what());
  }
  check_frame_size(info_.camera.parameters().width, info_.camera.parameters().height, recording.name());
  std::vector<std::string> playing = transform_topics(recording);
  playing.insert(playing.end(), {topics_.color, topics_.depth});
  recording.play(playing);
}

void ImagePairs::look_at_first_images(bool depth_named) {
  const RecordedMessage color = first_of(recording_, topics_.color), depth = first_of(recording_, topics_.depth);
  camera_frame_ = ros::decode<msg::Header>(color.wire, color.bytes).frame_id;
  info_.depth_scale_m = depth_unit_m(depth, depth_type_, float_unit_m_);
  const std::string depth_frame = ros::decode<msg::Header>(depth.wire, depth.bytes).frame_id;
  if (depth_named || depth_frame == camera_frame_ || named_as_registered(topics_.depth)) return;
  throw SourceError(recording_.name() + ": " + topics_.depth + " is in frame '" + depth_frame + "', " + topics_.color +
                    " in '" + camera_frame_ +
                    "': depth must be registered to colour; when it is, name it: ?depth=" + topics_.depth);
}

void ImagePairs::load_calibration(const RecordingOptions& options) {
  if (!options.calibration_file.empty()) {
    const Calibration own = read_calibration(options.calibration_file);
    info_.camera = own.camera;
    info_.depth_scale_m = own.depth_scale_m;
    return;
  }
  if (topics_.info.empty()) {
    throw SourceError(recording_.name() + ": no sensor_msgs/CameraInfo beside " + topics_.color +
                      "; name it (?info=TOPIC) or give ?calibration=FILE; its topics are:\n" + list_topics(recording_));
  }
  const RecordedMessage message = first_of(recording_, topics_.info);
  info_.camera = to_camera_model(ros::decode<msg::CameraInfo>(message.wire, message.bytes), topics_.color,
                                 recording_.name() + ", topic " + topics_.info);
}

std::optional<std::int64_t> ImagePairs::advance(SkipLog& skips) {
  while (!(pair_ = pairer_.next(skips))) {
    std::optional<RecordedMessage> message = recording_.next();
    if (message) {
      take(std::move(*message), skips);
      continue;
    }
    pairer_.finish();
    pair_ = pairer_.next(skips);
    break;
  }
  if (!pair_) return std::nullopt;
  last_ns_ = pair_->color.stamp_ns;
  if (!first_ns_) first_ns_ = last_ns_;
  return last_ns_;
}

void ImagePairs::take(RecordedMessage message, SkipLog& skips) try {
  const bool is_color = message.topic == topics_.color;
  if (!is_color && message.topic != topics_.depth) {
    return transforms_.add(ros::decode<msg::TFMessage>(message.wire, message.bytes));
  }
  const std::int64_t stamp_ns = msg::to_ns(ros::decode<msg::Header>(message.wire, message.bytes).stamp);
  StampedMessage stamped{stamp_ns, std::move(message)};
  is_color ? pairer_.add_color(std::move(stamped), skips) : pairer_.add_depth(std::move(stamped));
} catch (const ros::WireError& error) {
  skips.add({SkipReason::kDamagedRecord, name_of(message) + ": " + error.what()});
}

std::optional<SourceFrame> ImagePairs::decode(SkipLog& skips) {
  return decode_pair(*std::exchange(pair_, std::nullopt), {color_type_, depth_type_, float_unit_m_}, info_, skips);
}

geometry::Trajectory ImagePairs::groundtruth() const {
  if (!first_ns_) return {};
  return poses_of_span(transforms_.world_poses(camera_frame_), *first_ns_, last_ns_);
}

}  // namespace

std::unique_ptr<FrameAssembly> make_image_pairs(Recording& recording, const RecordingOptions& options) {
  return std::make_unique<ImagePairs>(recording, options);
}

}  // namespace rtd::camera
