// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// How old is an image when `rt/tf` says where it was taken? Plays a source as a camera driver of ROS 2 does, each pair
// of images stamped with the time at which it is sent, and measures at each transform how long ago its stamp is. The
// services run beside it:
//
//   rtd run --source ros2:/cam/color/image_raw,/cam/depth/image_raw?registered=1 --domain 42 --out OUT
//   tf_latency --source tum:FOLDER --domain 42
//
// Exit code 1: the 99th percentile is above --max-p99-ms, or there were no transforms.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <map>
#include <mutex>
#include <opencv2/core/mat.hpp>
#include <string>
#include <thread>
#include <vector>

#include "common/bus/bus_factory.hpp"
#include "common/bus/raw_bus.hpp"
#include "common/bus/topics.hpp"
#include "common/camera/open/source_factory.hpp"
#include "common/camera/recording/ros_images.hpp"
#include "common/msg/stamps.hpp"
#include "common/ros_codec/wire.hpp"
#include "common/service/monotonic_clock.hpp"

namespace rtd::slam {
namespace {

struct Options {
  std::string source = "synthetic:office";
  std::uint32_t domain = 0;
  std::string vendor = bus::BusOptions{}.vendor;
  std::size_t frames = 600, warm_up = 60;
  double fps = 30, max_p99_ms = 0;
};

bus::BusOptions bus_options(const Options& options) {
  bus::BusOptions bus;
  bus.vendor = options.vendor;
  bus.domain = options.domain;
  bus.participant_name = "tf-latency";
  return bus;
}

/// Reliable, keep-last 5, on a connection of its own.
class Driver {
 public:
  explicit Driver(const Options& options) : bus_(bus::connect_raw(bus_options(options))) {
    color_ = writer("rt/cam/color/image_raw", "Image");
    depth_ = writer("rt/cam/depth/image_raw", "Image");
    info_ = writer("rt/cam/color/camera_info", "CameraInfo");
  }
  bool has_reader() const { return color_->matched() > 0 && depth_->matched() > 0 && info_->matched() > 0; }
  void send(const camera::SourceFrame& frame, std::int64_t stamp_ns) {
    send(*info_, camera::to_camera_info(frame.image.camera, stamp_ns));
    send(*color_, image(frame.image.color_bgr, "bgr8", stamp_ns));
    cv::Mat depth_mm;
    frame.image.depth.convertTo(depth_mm, CV_16U, frame.image.depth_scale_m * 1000);
    send(*depth_, image(depth_mm, "16UC1", stamp_ns));
  }

 private:
  std::unique_ptr<bus::RawWriter> writer(const std::string& topic, const std::string& type) {
    bus::RawWriterOptions options;
    options.qos.depth = 5;
    return bus_->writer({topic, "sensor_msgs::msg::dds_::" + type + "_"}, options);
  }
  template <class Message>
  static void send(bus::RawWriter& writer, const Message& message) {
    const std::vector<std::uint8_t> cdr = ros::encode<ros::Wire::kCdr>(message);
    writer.write(std::as_bytes(std::span(cdr)));
  }
  static msg::Image image(const cv::Mat& pixels, const char* encoding, std::int64_t stamp_ns) {
    msg::Image image;
    image.header = {msg::to_time(stamp_ns), camera::kCameraFrame};
    image.width = static_cast<std::uint32_t>(pixels.cols);
    image.height = static_cast<std::uint32_t>(pixels.rows);
    image.encoding = encoding;
    image.step = static_cast<std::uint32_t>(pixels.cols * pixels.elemSize());
    const auto* const first = pixels.ptr();
    image.data.assign(first, first + std::size_t{image.step} * image.height);
    return image;
  }

  std::shared_ptr<bus::RawBus> bus_;
  std::unique_ptr<bus::RawWriter> color_, depth_, info_;
};

/// The age of each stamp when its first message comes. Filled by a thread of the bus.
class Ages {
 public:
  void note(std::int64_t stamp_ns) {
    const std::int64_t age_ns = service::realtime_ns() - stamp_ns;
    const std::lock_guard lock(mutex_);
    ages_ms_.try_emplace(stamp_ns, static_cast<double>(age_ns) * 1e-6);
  }
  /// Sorted, of the stamps from `first_ns` on.
  std::vector<double> since(std::int64_t first_ns) const {
    const std::lock_guard lock(mutex_);
    std::vector<double> ages_ms;
    for (const auto& [stamp_ns, age_ms] : ages_ms_)
      if (stamp_ns >= first_ns) ages_ms.push_back(age_ms);
    std::ranges::sort(ages_ms);
    return ages_ms;
  }

 private:
  mutable std::mutex mutex_;
  std::map<std::int64_t, double> ages_ms_;
};

double percentile(const std::vector<double>& sorted, double share) {
  return sorted.empty() ? 0 : sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
}

void report(const char* topic, const std::vector<double>& ages_ms, std::size_t sent) {
  std::printf("%-18s %zu of %zu frames, age p50 %.1f ms, p90 %.1f, p99 %.1f, max %.1f\n", topic, ages_ms.size(), sent,
              percentile(ages_ms, 0.5), percentile(ages_ms, 0.9), percentile(ages_ms, 0.99), percentile(ages_ms, 1));
}

int measure(const Options& options) {
  std::vector<camera::SourceFrame> frames;  // decoded before: a camera needs no processor for that
  const auto source = camera::make_source(options.source);
  while (frames.size() < options.frames) {
    auto frame = source->next();
    if (!frame) break;
    frames.push_back(std::move(*frame));
  }
  Driver driver(options);
  Ages tf, odometry;
  const auto bus = bus::connect(bus_options(options));
  const auto tf_reader = bus->reader(bus::topics::kTf, [&](const std::shared_ptr<const msg::TFMessage>& message) {
    if (!message->transforms.empty()) tf.note(msg::to_ns(message->transforms.back().header.stamp));
  });
  const auto odometry_reader = bus->reader(
      bus::topics::kOdometry,
      [&](const std::shared_ptr<const msg::Odometry>& message) { odometry.note(msg::to_ns(message->header.stamp)); });
  const std::chrono::nanoseconds period(static_cast<std::int64_t>(1e9 / options.fps));
  std::printf("waiting for a camera in domain %u\n", options.domain);
  std::fflush(stdout);
  // The camera looks at the first images before it and the others are ready: these are sent again and again.
  auto next = std::chrono::steady_clock::now();
  while (!driver.has_reader() || tf.since(0).size() < 3) {
    driver.send(frames.front(), service::realtime_ns());
    std::this_thread::sleep_until(next += period);
  }
  std::int64_t first_ns = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const std::int64_t stamp_ns = service::realtime_ns();
    if (i == options.warm_up) first_ns = stamp_ns;
    driver.send(frames[i], stamp_ns);
    std::this_thread::sleep_until(next += period);
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  const std::vector<double> ages_ms = tf.since(first_ns);
  const std::size_t sent = frames.size() - std::min(frames.size(), options.warm_up);
  report("/tf", ages_ms, sent);
  report("/slam/odometry", odometry.since(first_ns), sent);
  return ages_ms.empty() || (options.max_p99_ms > 0 && percentile(ages_ms, 0.99) > options.max_p99_ms) ? 1 : 0;
}

}  // namespace
}  // namespace rtd::slam

int main(int argc, char** argv) {
  rtd::slam::Options options;
  CLI::App app("Measures how old an image is when /tf says where it was taken");
  app.add_option("--source", options.source, "what the driver shows");
  app.add_option("--domain", options.domain);
  app.add_option("--dds", options.vendor);
  app.add_option("--frames", options.frames, "at most");
  app.add_option("--warm-up", options.warm_up, "frames that do not count");
  app.add_option("--fps", options.fps);
  app.add_option("--max-p99-ms", options.max_p99_ms, "0: whatever it is");
  CLI11_PARSE(app, argc, argv);
  return rtd::slam::measure(options);
}
