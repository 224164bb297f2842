// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <utility>

#include "common/camera/calibration.hpp"
#include "common/camera/depth_alignment.hpp"
#include "common/camera/frame_source.hpp"
#include "common/camera/recording/driver_topics.hpp"
#include "common/camera/recording/frame_pairer.hpp"
#include "common/camera/recording/recorded_extrinsics.hpp"
#include "common/camera/recording/recording_source.hpp"
#include "common/camera/recording/ros_images.hpp"
#include "common/geometry/transform_log.hpp"
#include "common/io/text.hpp"
#include "common/ros_codec/byte_cursor.hpp"
#include "common/ros_codec/wire.hpp"

namespace rtd::camera {
namespace {

double float_unit_of(const RecordedTopic& depth) {
  const auto factor = depth.metadata.find(kDepthFactor);
  const std::optional<double> value = factor == depth.metadata.end() ? std::nullopt : io::parse_number(factor->second);
  return value && *value >= 1 && *value <= 1e6 ? 1.0 / *value : kFloatDepthUnitM;
}

/// The unit of 16-bit depth that the RealSense SDK recorded beside it; empty when there is none. Throws SourceError.
std::optional<double> sdk_depth_unit_m(Recording& recording, const std::string& depth) {
  const std::string topic = sdk_depth_unit_topic(depth);
  if (topic.empty() || topic_named(recording, topic) == nullptr) return std::nullopt;
  constexpr float kMin_m = 1e-6F, kMax_m = 0.1F;
  const RecordedMessage message = first_of(recording, topic);
  ros::ByteCursor cursor(message.bytes);
  if (message.wire == ros::Wire::kCdr) cursor.take(4);  // header
  const auto unit_m = cursor.read<float>();
  if (unit_m >= kMin_m && unit_m <= kMax_m) return static_cast<double>(unit_m);  // NaN compares false
  throw SourceError(recording.name() + ", topic " + topic + ": the depth unit is " + std::to_string(unit_m) +
                    " m, allowed is 0.000001 to 0.1; give another with depth_factor in ?calibration=FILE");
}

class ImagePairs final : public RecordingSource {
 public:
  ImagePairs(std::string uri, std::unique_ptr<Recording> recording, const RecordingOptions& options);

  /// Of what was played so far.
  geometry::Trajectory groundtruth() const override;
  std::optional<Eigen::Isometry3d> true_pose(std::int64_t stamp_ns) const override {
    return transforms_.world_pose(color_.frame_id, stamp_ns, kTrueWithinNs);
  }

 private:
  std::optional<std::int64_t> advance() override;
  std::optional<SourceFrame> decode() override;
  void look_at_first_images();
  void load_calibration(const RecordingOptions& options);
  std::optional<geometry::CameraModel> recorded_camera(const std::string& info_topic, const std::string& image_topic);
  /// Sees to it that depth is registered to colour.
  void align_depth();
  void take(RecordedMessage message);

  ImageTopics topics_;
  ImageOrigin color_, depth_;
  double float_unit_m_;  ///< of depth in floats
  std::optional<vision::DepthRegistration> registration_;
  FramePairer pairer_;
  geometry::TransformLog transforms_;
  std::optional<FramePairer::Pair> pair_;  ///< gone to
  std::optional<std::int64_t> first_ns_;
  std::int64_t last_ns_ = 0;
};

ImagePairs::ImagePairs(std::string uri, std::unique_ptr<Recording> played, const RecordingOptions& options)
    : RecordingSource(std::move(uri), std::move(played)),
      topics_(choose_topics(*recording_, options.topics)),
      pairer_({.tolerance_ns = options.tolerance_ns}) {
  Recording& recording = *recording_;
  float_unit_m_ = float_unit_of(*topic_named(recording, topics_.depth));
  describe_rate(topics_.color);
  try {
    look_at_first_images();
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

void ImagePairs::look_at_first_images() {
  const RecordedMessage color = first_of(*recording_, topics_.color), depth = first_of(*recording_, topics_.depth);
  color_ = {
      topics_.color, ros::decode<msg::Header>(color.wire, color.bytes).frame_id, decode_color(color).image.size(), {}};
  depth_ = {topics_.depth,
            ros::decode<msg::Header>(depth.wire, depth.bytes).frame_id,
            decode_depth(depth, float_unit_m_).image.size(),
            {}};
  const auto sdk_unit_m = sdk_depth_unit_m(*recording_, topics_.depth);
  info_.depth_scale_m = sdk_unit_m ? *sdk_unit_m : depth_unit_m(depth, float_unit_m_);
}

/// The camera of a CameraInfo; empty when the recording has none.
std::optional<geometry::CameraModel> ImagePairs::recorded_camera(const std::string& info_topic,
                                                                 const std::string& image_topic) {
  if (info_topic.empty()) return std::nullopt;
  const RecordedMessage message = first_of(*recording_, info_topic);
  return to_camera_model(ros::decode<msg::CameraInfo>(message.wire, message.bytes), image_topic,
                         recording_->name() + ", topic " + info_topic);
}

void ImagePairs::load_calibration(const RecordingOptions& options) {
  if (!options.calibration_file.empty()) {
    apply(read_calibration(options.calibration_file), info_);
    return;
  }
  color_.camera = recorded_camera(topics_.info, topics_.color);
  if (!color_.camera) {
    throw SourceError(recording_->name() + ": no sensor_msgs/CameraInfo beside " + topics_.color +
                      "; name it (?info=TOPIC) or give ?calibration=FILE; its topics are:\n" +
                      list_topics(*recording_));
  }
  info_.camera = *color_.camera;
}

void ImagePairs::align_depth() {
  std::string missing = "there must be a sensor_msgs/CameraInfo beside " + topics_.depth +
                        "; if it is elsewhere, name it: ?depth_info=TOPIC";
  try {
    depth_.camera = recorded_camera(topics_.depth_info, topics_.depth);
    // A calibration file says nothing of how the two images compare.
    if (!color_.camera) color_.camera = recorded_camera(topics_.info, topics_.color);
  } catch (const SourceError& error) {
    missing = std::string("the cameras must be known, but ") + error.what();
  }
  const std::string cause = why_unregistered(color_, depth_);
  if (cause.empty()) return;
  if (!depth_.camera) throw unregistered(recording_->name(), cause, missing);
  const auto T_color_depth = recorded_extrinsics(*recording_, color_, depth_);
  if (!T_color_depth) {
    throw unregistered(recording_->name(), cause,
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
    const std::int64_t stamp_ns = msg::to_ns(ros::decode<msg::Header>(message.wire, message.bytes).stamp);
    StampedMessage stamped{stamp_ns, std::move(message)};
    is_color ? pairer_.add_color(std::move(stamped), skips_) : pairer_.add_depth(std::move(stamped));
  } catch (const ros::WireError& error) {
    skips_.add({SkipReason::kDamagedRecord, name_of(message) + ": " + error.what()});
  }
}

std::optional<SourceFrame> ImagePairs::decode() {
  take_damages();
  return decode_pair(*std::exchange(pair_, std::nullopt), float_unit_m_, info_, registration_, skips_);
}

geometry::Trajectory ImagePairs::groundtruth() const {
  if (!first_ns_) return {};
  return poses_of_span(transforms_.world_poses(color_.frame_id), *first_ns_, last_ns_);
}

}  // namespace

std::unique_ptr<FrameSource> make_image_pairs(std::string uri, std::unique_ptr<Recording> recording,
                                              const RecordingOptions& options) {
  return std::make_unique<ImagePairs>(std::move(uri), std::move(recording), options);
}

}  // namespace rtd::camera
