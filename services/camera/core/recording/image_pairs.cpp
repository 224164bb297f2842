// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <iterator>
#include <map>

#include "common/io/text.hpp"
#include "common/ros_codec/wire.hpp"
#include "services/camera/core/calibration.hpp"
#include "services/camera/core/frame_source.hpp"
#include "services/camera/core/recording/frame_pairer.hpp"
#include "services/camera/core/recording/recording_source.hpp"
#include "services/camera/core/recording/ros_images.hpp"

namespace rtd::camera {
namespace {

double float_unit_of(const RecordedTopic& depth) {
  const auto factor = depth.metadata.find(kDepthFactor);
  const std::optional<double> value = factor == depth.metadata.end() ? std::nullopt : io::parse_number(factor->second);
  return value && *value >= 1 && *value <= 1e6 ? 1.0 / *value : kFloatDepthUnitM;
}

constexpr const char* kWorld = "world";

/// tf of old wrote frames with a slash in front.
std::string bare(const std::string& frame) {
  return frame.substr(frame.starts_with('/') ? 1 : 0);
}

/// Empty when it is not a rotation or not finite.
std::optional<Eigen::Isometry3d> to_isometry(const msg::RosTransform& transform) {
  const auto& [t, q] = transform;
  const Eigen::Quaterniond rotation(q.w, q.x, q.y, q.z);
  const Eigen::Vector3d translation(t.x, t.y, t.z);
  if (!translation.allFinite() || !(std::abs(rotation.norm() - 1.0) < 0.05)) return std::nullopt;
  Eigen::Isometry3d T_parent_child = Eigen::Isometry3d::Identity();
  T_parent_child.linear() = rotation.normalized().toRotationMatrix();
  T_parent_child.translation() = translation;
  return T_parent_child;
}

/// The transforms (tf) of a recording, and the camera's true path in them: TUM's bags contain the motion capture as
/// /world -> /kinect and the mounting below it down to the frame of the colour image.
class TransformLog {
 public:
  void add(const msg::TFMessage& message);
  /// T_world_camera at each measurement of the transform that begins at `world`; the transforms below are taken as they
  /// were nearest in time. Empty when no chain leads from `world` to `camera_frame`: odometry is not ground truth.
  geometry::Trajectory world_poses(const std::string& camera_frame) const;

 private:
  /// A frame below its parent.
  struct Link {
    std::string parent;
    std::map<std::int64_t, Eigen::Isometry3d> T_parent_child;  ///< by stamp, ns
    Eigen::Isometry3d at(std::int64_t stamp_ns) const;
  };
  std::map<std::string, Link> links_;  ///< by child
};

void TransformLog::add(const msg::TFMessage& message) {
  for (const msg::TransformStamped& transform : message.transforms) {
    const std::optional<Eigen::Isometry3d> T_parent_child = to_isometry(transform.transform);
    if (!T_parent_child) continue;
    Link& link = links_[bare(transform.child_frame_id)];
    link.parent = bare(transform.header.frame_id);
    link.T_parent_child.insert_or_assign(msg::to_ns(transform.header.stamp), *T_parent_child);
  }
}

Eigen::Isometry3d TransformLog::Link::at(std::int64_t stamp_ns) const {
  const auto after = T_parent_child.lower_bound(stamp_ns);
  if (after == T_parent_child.begin()) return after->second;
  const auto before = std::prev(after);
  const bool later = after != T_parent_child.end() && after->first - stamp_ns < stamp_ns - before->first;
  return later ? after->second : before->second;
}

geometry::Trajectory TransformLog::world_poses(const std::string& camera_frame) const {
  std::vector<const Link*> chain;  // from the camera up
  for (auto link = links_.find(bare(camera_frame)); link != links_.end(); link = links_.find(link->second.parent)) {
    chain.push_back(&link->second);
    if (link->second.parent == kWorld || chain.size() > links_.size()) break;  // a ring has no end
  }
  if (chain.empty() || chain.back()->parent != kWorld) return {};
  geometry::Trajectory poses;
  for (const auto& [stamp_ns, T_world_child] : chain.back()->T_parent_child) {
    Eigen::Isometry3d T_child_camera = Eigen::Isometry3d::Identity();
    for (std::size_t i = 0; i + 1 < chain.size(); ++i) T_child_camera = chain[i]->at(stamp_ns) * T_child_camera;
    poses.push_back({stamp_ns, T_world_child * T_child_camera});
  }
  return poses;
}

class ImagePairs final : public RecordingSource {
 public:
  ImagePairs(std::string uri, std::unique_ptr<Recording> recording, const RecordingOptions& options);

  /// Of what was played so far.
  geometry::Trajectory groundtruth() const override;

 private:
  std::optional<std::int64_t> advance() override;
  std::optional<SourceFrame> decode() override;
  void load_calibration(const RecordingOptions& options);
  void look_at_first_images(bool depth_named);
  void take(RecordedMessage message);

  ImageTopics topics_;
  std::string camera_frame_;
  double float_unit_m_;  ///< of depth in floats
  FramePairer pairer_;
  TransformLog transforms_;
  std::optional<FramePairer::Pair> pair_;  ///< gone to
  std::optional<std::int64_t> first_ns_;
  std::int64_t last_ns_ = 0;
};

ImagePairs::ImagePairs(std::string uri, std::unique_ptr<Recording> played, const RecordingOptions& options)
    : RecordingSource(std::move(uri), std::move(played)), topics_(choose_topics(*recording_, options.topics)) {
  Recording& recording = *recording_;
  float_unit_m_ = float_unit_of(*topic_named(recording, topics_.depth));
  describe_rate(topics_.color);
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
  read_first(recording.name());
}

void ImagePairs::look_at_first_images(bool depth_named) {
  const RecordedMessage color = first_of(*recording_, topics_.color), depth = first_of(*recording_, topics_.depth);
  camera_frame_ = ros::decode<msg::Header>(color.wire, color.bytes).frame_id;
  info_.depth_scale_m = depth_unit_m(depth, float_unit_m_);
  const std::string depth_frame = ros::decode<msg::Header>(depth.wire, depth.bytes).frame_id;
  if (depth_named || depth_frame == camera_frame_ || named_as_registered(topics_.depth)) return;
  throw SourceError(recording_->name() + ": " + topics_.depth + " is in frame '" + depth_frame + "', " + topics_.color +
                    " in '" + camera_frame_ +
                    "': depth must be registered to colour; when it is, name it: ?depth=" + topics_.depth);
}

void ImagePairs::load_calibration(const RecordingOptions& options) {
  if (!options.calibration_file.empty()) {
    apply(read_calibration(options.calibration_file), info_);
    return;
  }
  if (topics_.info.empty()) {
    throw SourceError(recording_->name() + ": no sensor_msgs/CameraInfo beside " + topics_.color +
                      "; name it (?info=TOPIC) or give ?calibration=FILE; its topics are:\n" +
                      list_topics(*recording_));
  }
  const RecordedMessage message = first_of(*recording_, topics_.info);
  info_.camera = to_camera_model(ros::decode<msg::CameraInfo>(message.wire, message.bytes), topics_.color,
                                 recording_->name() + ", topic " + topics_.info);
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
  if (!pair_) return take_damages(), std::nullopt;
  last_ns_ = pair_->color.stamp_ns;
  if (!first_ns_) first_ns_ = last_ns_;
  return last_ns_;
}

void ImagePairs::take(RecordedMessage message) try {
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

std::optional<SourceFrame> ImagePairs::decode() {
  take_damages();
  return decode_pair(*std::exchange(pair_, std::nullopt), float_unit_m_, info_, skips_);
}

geometry::Trajectory ImagePairs::groundtruth() const {
  if (!first_ns_) return {};
  return poses_of_span(transforms_.world_poses(camera_frame_), *first_ns_, last_ns_);
}

}  // namespace

std::unique_ptr<FrameSource> make_image_pairs(std::string uri, std::unique_ptr<Recording> recording,
                                              const RecordingOptions& options) {
  return std::make_unique<ImagePairs>(std::move(uri), std::move(recording), options);
}

}  // namespace rtd::camera
