// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/frame_publisher.hpp"

#include <sched.h>

#include <algorithm>
#include <cstring>
#include <opencv2/imgcodecs.hpp>
#include <random>
#include <utility>

#include "common/concurrency/thread_priority.hpp"
#include "common/service/monotonic_clock.hpp"
#include "services/camera/core/recording/ros_images.hpp"

namespace rtd::camera {
namespace {

constexpr std::size_t kMaxWaiting = 2;
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

/// Copies the rows packed and clears what a smaller image leaves of the fixed array.
template <class Array>
void copy_packed(const cv::Mat& image, Array& target) {
  auto* bytes = reinterpret_cast<std::uint8_t*>(target.data());
  const std::size_t row_bytes = static_cast<std::size_t>(image.cols) * image.elemSize();
  for (int row = 0; row < image.rows; ++row, bytes += row_bytes) std::memcpy(bytes, image.ptr(row), row_bytes);
  const std::size_t used = row_bytes * static_cast<std::size_t>(image.rows);
  std::memset(bytes, 0, sizeof(target) - used);
}

bus::StatusCallbacks on_match(const std::function<void()>& notify) {
  bus::StatusCallbacks callbacks;
  callbacks.on_matched = [notify](int) { notify(); };
  return callbacks;
}

}  // namespace

JpegPublisher::JpegPublisher(bus::Writer<msg::CompressedImage> writer, int quality, concurrency::Overflow overflow)
    : writer_(std::move(writer)), quality_(quality), waiting_(kMaxWaiting, overflow), thread_([this] {
        yield_to_poses();
        while (const auto image = waiting_.pop()) publish(*image);
      }) {}

JpegPublisher::~JpegPublisher() {
  waiting_.close();
  thread_.join();
}

void JpegPublisher::offer(const cv::Mat& color_bgr, std::int64_t stamp_ns) {
  if (writer_.matched() > 0) waiting_.push({color_bgr, stamp_ns});
}

void JpegPublisher::publish(const Waiting& image) {
  msg::CompressedImage message;
  message.header = {msg::to_time(image.stamp_ns), kCameraFrame};
  message.format = "bgr8; jpeg compressed bgr8";
  if (!cv::imencode(".jpg", image.color_bgr, message.data, {cv::IMWRITE_JPEG_QUALITY, quality_})) return;
  ++encoded_;
  writer_.write(message);
}

void fill_frame(const vision::RgbdImage& image, std::uint64_t source_id, std::int64_t published_ns,
                msg::RgbdFrame& frame) {
  const auto& p = image.camera.parameters();
  frame.seq = image.seq;
  frame.stamp_ns = image.stamp_ns;
  frame.published_ns = published_ns;
  frame.intrinsics = {p.fx, p.fy, p.cx, p.cy};
  frame.distortion = msg::unaligned(p.distortion);
  frame.depth_scale_m = image.depth_scale_m;
  frame.readout_s = image.readout_s;
  frame.depth_offset_s = image.depth_offset_s;
  frame.width = static_cast<std::uint32_t>(image.color_bgr.cols);
  frame.height = static_cast<std::uint32_t>(image.color_bgr.rows);
  frame.source_id = source_id;
  copy_packed(image.color_bgr, frame.color_bgr);
  copy_packed(image.depth, frame.depth);
}

FramePublisher::FramePublisher(bus::Bus& bus, int jpeg_quality, concurrency::Overflow jpeg_overflow,
                               std::function<void()> on_matched)
    : source_id_(random_id()),
      frames_(bus.writer(bus::topics::kFrame, on_match(on_matched))),
      infos_(bus.writer(bus::topics::kCameraInfo)),
      jpegs_(bus.writer(bus::topics::kColorJpeg, on_match(on_matched)), jpeg_quality, jpeg_overflow) {}

bool FramePublisher::publish(const vision::RgbdImage& image) {
  const bool taken = publish_raw(image);
  jpegs_.offer(image.color_bgr, image.stamp_ns);
  if (!std::exchange(info_sent_, true) || infos_.matched() > 0) {
    infos_.write(to_camera_info(image.camera, image.stamp_ns));
  }
  return taken;
}

bool FramePublisher::publish_raw(const vision::RgbdImage& image) {
  bus::Loan<msg::RgbdFrame> frame = frames_.loan();
  if (frame.operator->() == nullptr) return false;
  fill_frame(image, source_id_, service::monotonic_ns(), *frame);
  return frames_.write(std::move(frame));
}

}  // namespace rtd::camera
