// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/recorder/mcap_export.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>

#include "common/camera/recording/recording.hpp"
#include "common/camera/recording/ros_images.hpp"
#include "common/io/atomic_file.hpp"
#include "common/mcap/writer.hpp"
#include "common/ros2/names.hpp"
#include "common/ros2/type_description.hpp"
#include "common/ros_codec/wire.hpp"

namespace rtd::recordings {
namespace {

namespace fs = std::filesystem;

bool in_millimetres(double depth_scale_m) {
  return std::abs(depth_scale_m - camera::kMillimetre) < 1e-12;
}

msg::Image to_message(const cv::Mat& pixels, const std::string& encoding, std::int64_t stamp_ns) {
  msg::Image message;
  message.header = {msg::to_time(stamp_ns), camera::kCameraFrame};
  message.height = static_cast<std::uint32_t>(pixels.rows);
  message.width = static_cast<std::uint32_t>(pixels.cols);
  message.encoding = encoding;
  message.step = message.width * static_cast<std::uint32_t>(pixels.elemSize());
  message.data.resize(std::size_t{message.step} * message.height);
  pixels.copyTo(cv::Mat(pixels.size(), pixels.type(), message.data.data()));
  return message;
}

msg::Image color_message(const vision::RgbdImage& image) {
  cv::Mat rgb(image.color_bgr.size(), CV_8UC3);
  const std::array<int, 6> swapped = {0, 2, 1, 1, 2, 0};
  cv::mixChannels(&image.color_bgr, 1, &rgb, 1, swapped.data(), 3);
  return to_message(rgb, "rgb8", image.stamp_ns);
}

msg::Image depth_message(const vision::RgbdImage& image) {
  if (in_millimetres(image.depth_scale_m)) return to_message(image.depth, "16UC1", image.stamp_ns);
  cv::Mat depth_m;
  image.depth.convertTo(depth_m, CV_32FC1, image.depth_scale_m);
  depth_m.setTo(std::numeric_limits<float>::quiet_NaN(), image.depth == 0);
  return to_message(depth_m, "32FC1", image.stamp_ns);
}

msg::TFMessage truth_message(const geometry::StampedPose& pose) {
  const Eigen::Vector3d t = pose.T_world_body.translation();
  const Eigen::Quaterniond q(pose.T_world_body.linear());
  msg::TransformStamped transform;
  transform.header = {msg::to_time(pose.stamp_ns), "world"};
  transform.child_frame_id = camera::kCameraFrame;
  transform.transform = {{t.x(), t.y(), t.z()}, {q.x(), q.y(), q.z(), q.w()}};
  return {{transform}};
}

/// The file while it grows.
class Recorder {
 public:
  Recorder(const fs::path& file, mcap::Compression compression, double depth_scale_m)
      : sink_(file, {.named_by = io::NamedBy::kOperator, .if_exists = io::IfExists::kFail}),
        writer_(sink_, {.profile = "ros2", .compression = compression}) {
    const mcap::SchemaId image = schema("sensor_msgs/msg/Image");
    color_ = channel("/camera/color/image_raw", image);
    depth_ = channel("/camera/aligned_depth_to_color/image_raw", image,
                     {{camera::kDepthFactor, fmt::format("{:.9g}", 1.0 / depth_scale_m)}});
    info_ = channel("/camera/color/camera_info", schema("sensor_msgs/msg/CameraInfo"));
    truth_ = channel("/tf", schema("tf2_msgs/msg/TFMessage"));
  }

  void write(const vision::RgbdImage& image) {
    write(info_, camera::to_camera_info(image.camera, image.stamp_ns), image.stamp_ns);
    write(color_, color_message(image), image.stamp_ns);
    write(depth_, depth_message(image), image.stamp_ns);
  }
  /// In chunks of its own: it overlaps everything.
  void write(const geometry::Trajectory& truth) {
    writer_.end_chunk();
    for (const geometry::StampedPose& pose : truth) write(truth_, truth_message(pose), pose.stamp_ns);
  }
  void close() {
    writer_.close();
    sink_.commit();
  }

 private:
  mcap::SchemaId schema(const std::string& type) {
    const ros2::TypeDefinition definition = ros2::definition_of(ros2::dds_type(type));
    return writer_.add(mcap::Schema{0, definition.name, definition.encoding, definition.text});
  }
  mcap::ChannelId channel(const std::string& topic, mcap::SchemaId schema,
                          std::map<std::string, std::string> metadata = {}) {
    return writer_.add(mcap::Channel{0, schema, topic, "cdr", std::move(metadata)});
  }
  template <class Message>
  void write(mcap::ChannelId channel, const Message& message, std::int64_t stamp_ns) {
    const std::vector<std::uint8_t> bytes = ros::encode<ros::Wire::kCdr>(message);
    const auto time = static_cast<mcap::Timestamp>(stamp_ns);
    writer_.write(mcap::Message{channel, sequence_[channel]++, time, time, std::as_bytes(std::span(bytes))});
  }

  io::AtomicFile sink_;
  mcap::Writer writer_;
  mcap::ChannelId color_ = 0, depth_ = 0, info_ = 0, truth_ = 0;
  std::map<mcap::ChannelId, std::uint32_t> sequence_;
};

}  // namespace

std::uint64_t export_mcap(camera::FrameSource& source, const fs::path& file, mcap::Compression compression,
                          std::uint64_t max_frames, const camera::OnFrame& on_frame) {
  camera::check_end(source, max_frames);
  if (fs::exists(file)) throw camera::SourceError(file.string() + " exists; name a new file or remove it");
  Recorder recorder(file, compression, source.info().depth_scale_m);
  std::uint64_t frames = 0;
  while (max_frames == 0 || frames < max_frames) {
    const std::optional<camera::SourceFrame> frame = source.next();
    if (!frame) break;
    recorder.write(frame->image);
    ++frames;
    if (on_frame) on_frame(frames);
  }
  recorder.write(source.groundtruth());
  recorder.close();
  return frames;
}

}  // namespace rtd::recordings
