// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cstring>
#include <utility>

#include "common/camera/frame_source.hpp"
#include "common/camera/recording/recording.hpp"
#include "common/camera/recording/ros_images.hpp"
#include "common/msg/rgbd_frame.hpp"
#include "common/vision/rgbd_image.hpp"

namespace rtd::camera {
namespace {

constexpr char kTypeStem[] = "rtd_msgs/RgbdFrame";

template <class Frame>
std::shared_ptr<const msg::FrameView> frame_in(const RecordedMessage& message) {
  constexpr std::size_t kHeaderBytes = 4, kBytes = kHeaderBytes + sizeof(Frame);
  if (message.bytes.size() != kBytes) {
    throw ros::WireError(fmt::format(
        "it has {} bytes, a frame has {}: it is cut, or was recorded by another version of RTD-SLAM, which can play it",
        message.bytes.size(), kBytes));
  }
  auto frame = std::make_shared<Frame>();
  std::memcpy(frame.get(), message.bytes.data() + kHeaderBytes, sizeof(Frame));
  return std::make_shared<const msg::FrameView>(*frame, frame);
}

/// The frame behind the 4-byte header of CDR, of any size class. Throws ros::WireError: cut, or of a version of the
/// program with another frame type; a size, calibration or time that cannot be.
std::shared_ptr<const msg::FrameView> to_frame_message(const RecordedMessage& message) {
  std::shared_ptr<const msg::FrameView> frame;
  msg::for_each_frame_type([&]<class Frame>() {
    if (message.type == msg::type_name(msg::TypeOf<Frame>())) frame = frame_in<Frame>(message);
  });
  if (!frame) throw ros::WireError(message.type + " is not a type of frames");
  if (const std::string defect = vision::defect(*frame); !defect.empty()) throw ros::WireError(defect);
  return frame;
}

/// Frames that our own recorder took from the topic rtd/frame: colour, depth and calibration in one message, the same
/// bytes as in memory.
class OwnFrames final : public RecordingSource {
 public:
  OwnFrames(std::string uri, std::unique_ptr<recordings::Reader> recording);

  /// None: slam's estimate of the path is not ground truth.
  geometry::Trajectory groundtruth() const override { return {}; }

 private:
  std::optional<std::int64_t> advance() override;
  std::optional<SourceFrame> decode() override;
  bool take(const RecordedMessage& message);

  std::shared_ptr<const msg::FrameView> frame_;  ///< gone to
  std::uint64_t source_id_ = 0;
  std::optional<std::int64_t> last_ns_;
};

OwnFrames::OwnFrames(std::string uri, std::unique_ptr<recordings::Reader> recording)
    : RecordingSource(std::move(uri), std::move(recording)) {
  const std::string topic = own_frames_topic(*recording_);
  const RecordedMessage first = first_of(*recording_, topic);
  try {
    const auto frame = to_frame_message(first);
    const vision::RgbdImage image = vision::view_image(*frame);
    info_.camera = image.camera;
    info_.depth_scale_m = image.depth_scale_m;
    info_.readout_s = image.readout_s;
    source_id_ = frame->source_id;
  } catch (const ros::WireError& error) {
    throw SourceError(recording_->name() + ": the first frame of " + topic + " is damaged: " + error.what());
  }
  describe_rate(topic);
  recording_->play({topic});
  read_first(recording_->name());
}

std::optional<std::int64_t> OwnFrames::advance() {
  while (const std::optional<RecordedMessage> message = recording_->next()) {
    if (take(*message)) return last_ns_ = frame_->stamp_ns;
  }
  take_damages();
  return std::nullopt;
}

bool OwnFrames::take(const RecordedMessage& message) {
  try {
    frame_ = to_frame_message(message);
    const auto leave_out = [&](SkipReason reason, const char* cause) {
      skips_.add({reason, name_of(message) + " " + cause});
      return false;
    };
    if (frame_->source_id != source_id_) return leave_out(SkipReason::kDamagedRecord, "comes from another camera");
    if (last_ns_ && frame_->stamp_ns == *last_ns_) return leave_out(SkipReason::kStampDoubled, "was sent again");
    if (last_ns_ && frame_->stamp_ns < *last_ns_)
      return leave_out(SkipReason::kStampBackwards, "is older than the last");
    return true;
  } catch (const ros::WireError& error) {
    skips_.add({SkipReason::kDamagedRecord, name_of(message) + ": " + error.what()});
    return false;
  }
}

std::optional<SourceFrame> OwnFrames::decode() {
  take_damages();
  const vision::RgbdImage image = vision::view_image(*frame_);
  if (const auto mismatch = size_mismatch("frame", image.color_bgr, image.depth, info_.camera)) {
    skips_.add(*mismatch);
    return std::nullopt;
  }
  SourceFrame frame = to_frame(image.stamp_ns, image.color_bgr.clone(), image.depth.clone(), info_);
  frame.image.readout_s = image.readout_s;
  frame.image.depth_offset_s = image.depth_offset_s;
  return frame;
}

}  // namespace

std::string own_frames_topic(const recordings::Reader& recording) {
  for (const RecordedTopic& topic : recording.topics()) {
    if (topic.type.starts_with(kTypeStem) && topic.messages > 0) return topic.name;
  }
  return {};
}

std::unique_ptr<FrameSource> make_own_frames(std::string uri, std::unique_ptr<recordings::Reader> recording) {
  return std::make_unique<OwnFrames>(std::move(uri), std::move(recording));
}

}  // namespace rtd::camera
