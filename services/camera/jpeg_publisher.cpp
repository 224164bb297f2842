// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/jpeg_publisher.hpp"

#include <sched.h>

#include <opencv2/imgcodecs.hpp>
#include <utility>

#include "common/concurrency/thread_priority.hpp"
#include "services/camera/core/recording/camera_info.hpp"

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

}  // namespace rtd::camera
