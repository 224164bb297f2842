// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/frame_publisher.hpp"

#include <sched.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cstring>
#include <random>

#include "common/camera/open/source_factory.hpp"
#include "common/camera/recording/ros_images.hpp"
#include "common/concurrency/thread_priority.hpp"
#include "common/msg/imu.hpp"
#include "common/msg/transform_eigen.hpp"
#include "common/ros2/names.hpp"
#include "common/ros_codec/wire.hpp"
#include "common/service/monotonic_clock.hpp"
#include "common/vision/image_codecs.hpp"
#include "services/camera/core/depth_colors.hpp"

namespace rtd::camera {
namespace {

constexpr std::size_t kMaxWaiting = 2;
constexpr int kDepthQuality = 85;
constexpr int kNicer = 5;  // than the filter and slam, and before the detector

/// Niceness orders no real-time threads: in a process that was started as such this one leaves them.
void yield_to_poses() {
  const sched_param ordinary{};
  if (sched_getscheduler(0) != SCHED_OTHER) sched_setscheduler(0, SCHED_OTHER, &ordinary);
  concurrency::lower_thread_priority(kNicer);
}

std::uint64_t random_id() {
  std::random_device device;
  return (static_cast<std::uint64_t>(device()) << 32U) | device();
}

bus::StatusCallbacks on_match(const std::function<void()>& notify) {
  bus::StatusCallbacks callbacks;
  if (notify) callbacks.on_matched = [notify](int) { notify(); };
  return callbacks;
}

}  // namespace

JpegPublisher::JpegPublisher(bus::Bus& bus, int quality, concurrency::Overflow overflow,
                             const std::function<void()>& on_matched, const bus::Topic<msg::CompressedImage>& topic)
    : writer_(bus.writer(topic, on_match(on_matched))),
      quality_(quality),
      waiting_(kMaxWaiting, overflow),
      thread_([this] {
        yield_to_poses();
        while (const auto image = waiting_.pop()) publish(*image);
      }) {}

JpegPublisher::~JpegPublisher() {
  waiting_.close();
  thread_.join();
}

void JpegPublisher::offer(Draw draw, std::int64_t stamp_ns, const std::string& frame_id) {
  if (writer_.matched() == 0) return;
  constexpr double kEarly = 0.9;  // of the period: stamps jitter
  const bool too_soon =
      max_hz_ > 0 && stamp_ns > offered_ns_ && static_cast<double>(stamp_ns - offered_ns_) < kEarly * 1e9 / max_hz_;
  if (too_soon) return;
  offered_ns_ = stamp_ns;
  waiting_.push({std::move(draw), {msg::to_time(stamp_ns), frame_id}});
}

void JpegPublisher::publish(const Waiting& image) {
  msg::CompressedImage message;
  message.header = image.header;
  message.format = "bgr8; jpeg compressed bgr8";
  message.data = vision::encode_jpeg(image.draw(), quality_);
  if (message.data.empty()) return;
  ++encoded_;
  writer_.write(message);
}

void copy_packed(const cv::Mat& image, std::uint8_t* bytes, std::size_t size) {
  const std::size_t row_bytes = static_cast<std::size_t>(image.cols) * image.elemSize();
  for (int row = 0; row < image.rows; ++row, bytes += row_bytes) std::memcpy(bytes, image.ptr(row), row_bytes);
  std::memset(bytes, 0, size - row_bytes * static_cast<std::size_t>(image.rows));
}

FramePublisher::FramePublisher(bus::Bus& bus, int jpeg_quality, concurrency::Overflow jpeg_overflow,
                               std::function<void()> on_matched, std::uint64_t source_id)
    : bus_(bus),
      on_matched_(std::move(on_matched)),
      source_id_(source_id != 0 ? source_id : random_id()),
      frame_id_(bus.frame(kCameraFrame)),
      infos_(bus.writer(bus::topics::kCameraInfo)),
      jpegs_(bus, jpeg_quality, jpeg_overflow, on_matched_),
      depths_(bus, kDepthQuality, jpeg_overflow, {}, bus::topics::kDepthJpeg) {
  limit_jpeg_rate(0);
}

void FramePublisher::limit_jpeg_rate(double max_hz) {
  constexpr double kMostDepths_hz = 10;
  jpegs_.limit_rate(max_hz);
  depths_.limit_rate(max_hz > 0 ? std::min(max_hz, kMostDepths_hz) : kMostDepths_hz);
}

void FramePublisher::open(cv::Size size_px) {
  frames_ = bus::FrameWriter(bus_, static_cast<std::uint32_t>(size_px.width),
                             static_cast<std::uint32_t>(size_px.height), on_match(on_matched_));
  if (!size_px_.empty()) source_id_ = random_id();
  size_px_ = size_px;
  info_sent_ = false;
}

bool FramePublisher::publish(const vision::RgbdImage& image) {
  if (image.color_bgr.size() != size_px_) open(image.color_bgr.size());
  const bool taken = frames_.write([&](auto& frame) { fill_frame(image, source_id_, service::monotonic_ns(), frame); });
  jpegs_.offer(image.color_bgr, image.stamp_ns, frame_id_);
  depths_.offer([depth = image.depth, scale_m = image.depth_scale_m] { return depth_preview(depth, scale_m); },
                image.stamp_ns, frame_id_);
  if (!std::exchange(info_sent_, true) || infos_.matched() > 0) {
    infos_.write(to_camera_info(image.camera, image.stamp_ns, frame_id_));
  }
  return taken;
}

namespace {

constexpr int kMotionDepth = 64;                                       // of samples: a camera at 4 Hz
constexpr auto kFoundLate = bus::RawQos::Durability::kTransientLocal;  // slam may find it after the first frame

std::unique_ptr<bus::RawWriter> motion_writer(bus::RawBus& bus, const char* topic, const char* type) {
  bus::RawWriterOptions options;
  options.qos.depth = kMotionDepth;
  options.qos.durability = kFoundLate;
  return bus.writer({topic, type}, options);
}

msg::Vector3 to_vector(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

template <class Message>
void write(bus::RawWriter& writer, const Message& message) {
  const std::vector<std::uint8_t> bytes = ros::encode<ros::Wire::kCdr>(message);
  writer.write(std::as_bytes(std::span(bytes)));
}

}  // namespace

MotionPublisher::MotionPublisher(const bus::BusOptions& options, const SourceInfo& info, MotionFrames names)
    : names_(std::move(names)), bus_(bus::connect_raw(options)) {
  const auto name = [&](const char* topic) { return bus::topic_of_robot(topic, options.robot); };
  if (info.has_imu) imu_ = motion_writer(*bus_, name(msg::kImuTopic).c_str(), msg::kImuDdsType);
  if (info.has_wheels) wheels_ = motion_writer(*bus_, name(msg::kWheelTopic).c_str(), msg::kOdometryDdsType);
}

void MotionPublisher::publish(const SourceFrame& frame, std::int64_t after_ns) {
  for (const ImuReading& reading : frame.imu) {
    if (reading.stamp_ns <= after_ns) continue;
    msg::Imu imu;
    imu.header = {msg::to_time(reading.stamp_ns), names_.camera};
    imu.orientation_covariance[0] = -1;  // it has none
    imu.angular_velocity = to_vector(reading.gyro_rad_s);
    imu.linear_acceleration = to_vector(reading.accel_m_s2);
    write(*imu_, imu);
  }
  for (const WheelReading& reading : frame.wheels) {
    if (reading.stamp_ns <= after_ns) continue;
    const auto [t, q] = msg::to_message(reading.T_odom_base);
    msg::Odometry odometry;
    odometry.header = {msg::to_time(reading.stamp_ns), names_.odom};
    odometry.child_frame_id = names_.base;
    odometry.pose.pose = {{t[0], t[1], t[2]}, {q[0], q[1], q[2], q[3]}};
    odometry.twist.twist = {to_vector(reading.linear_m_s), to_vector(reading.angular_rad_s)};
    write(*wheels_, odometry);
  }
}

AuxiliaryPublisher::AuxiliaryPublisher(const bus::BusOptions& options, bus::Bus& bus, const std::string& source_uri,
                                       const std::vector<std::string>& topics)
    : bus_(bus::connect_raw(options)) {
  std::unique_ptr<recordings::Reader> recording = recording_of(source_uri);
  if (!recording)
    throw SourceError("source " + source_uri + ": only a recording has other topics than those of its frames");
  std::vector<std::string> played;
  for (const std::string& topic : topics) {
    if (topic == ros2::ros_topic(bus::topics::kTfStatic.name)) {
      transforms_ = bus.writer(bus::topics::kTfStatic);
      transforms_.write(lasting_transforms(*recording));
    } else {
      played.push_back(open(*recording, topic));
    }
  }
  messages_ = std::make_unique<AuxiliaryTopics>(std::move(recording), played);
}

std::string AuxiliaryPublisher::open(const recordings::Reader& recording, const std::string& topic) {
  constexpr int kDepth = 512;  // of samples: two seconds of an IMU
  const auto& all = recording.topics();
  const auto found = std::ranges::find_if(all, [&](const auto& t) { return ros2::ros_topic(t.name) == topic; });
  const bool fits = found != all.end() && (found->type == "sensor_msgs/Imu" || found->type == "nav_msgs/Odometry");
  if (!fits) {
    throw SourceError(recording.name() + ": no topic " + topic + " of an IMU or of wheels; its topics are:\n" +
                      recordings::list_topics(recording));
  }
  bus::RawWriterOptions options;
  options.qos.depth = kDepth;
  options.qos.durability = kFoundLate;
  const char* const type = found->type == "sensor_msgs/Imu" ? msg::kImuDdsType : msg::kOdometryDdsType;
  writers_[found->name] = bus_->writer({ros2::dds_topic(topic), type}, options);
  return found->name;
}

void AuxiliaryPublisher::publish(const SourceFrame& frame) {
  for (const recordings::RecordedMessage& message : messages_->until(frame.image.stamp_ns)) {
    writers_.at(message.topic)->write(std::as_bytes(std::span(message.bytes)));
  }
}

}  // namespace rtd::camera
