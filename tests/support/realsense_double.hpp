// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "common/bus/raw_bus.hpp"
#include "common/ros_codec/wire.hpp"
#include "services/camera/realsense/realsense_protocol.hpp"

namespace rtd::camera::test {

/// What a RealsenseDouble shows: uniform images, or those of a source.
struct RealsenseScript {
  std::string serial = "1234";
  int width = 64, height = 48;
  double focal_px = 60;
  double unit_m = 0.002;       ///< of depth
  double depth_ahead_m = 0.1;  ///< the depth camera is so far in front of the colour camera
  /// The next pixels, RGB and depth; empty: bytes of 77 and of 1 (257 units).
  std::function<void(std::vector<std::uint8_t>& rgb, std::vector<std::uint8_t>& depth)> next = {};
};

/// A RealSense camera on DDS: writers of a participant of its own with the topics, types, QoS and messages of
/// librealsense's documentation (third-party/realdds/doc). It describes itself to everyone who subscribes, and sends 30
/// frames a second while they are subscribed, until it is destroyed. Its stamps continue where those of the one before
/// ended.
class RealsenseDouble {
 public:
  RealsenseDouble(const bus::BusOptions& options, RealsenseScript script)
      : script_(std::move(script)), bus_(connect(options)), root_("realsense/D555_" + script_.serial) {
    info_ = writer(realsense::kDeviceInfoTopic, realsense::kFlexibleType, true);
    notification_ = writer(root_ + "/notification", realsense::kFlexibleType, true);
    color_ = writer("rt/" + root_ + "_Color", "sensor_msgs::msg::dds_::Image_", false);
    depth_ = writer("rt/" + root_ + "_Depth", "sensor_msgs::msg::dds_::Image_", false);
    bus::RawHandlers handlers;
    handlers.on_sample = [this](const bus::RawSample& sample) { take_request(sample); };
    control_ = bus_->reader({root_ + "/control", realsense::kFlexibleType}, {}, handlers);
    thread_ = std::thread([this] { run(); });
  }
  ~RealsenseDouble() {
    ended_ = true;
    thread_.join();
  }
  void announce_stop() { stopping_ = true; }
  void refuse_requests() { refuses_ = true; }

 private:
  using json = nlohmann::json;
  static constexpr std::uint32_t kPadding = 8;  ///< bytes between rows

  /// The cameras use Fast DDS; Cyclone DDS has no topics with '-' in their names.
  static std::shared_ptr<bus::RawBus> connect(bus::BusOptions options) {
    options.vendor = "fastdds";
    return bus::connect_raw(options);
  }
  std::unique_ptr<bus::RawWriter> writer(const std::string& topic, const std::string& type, bool reliable) {
    bus::RawWriterOptions options;
    options.qos.reliable = reliable;
    options.qos.depth = 10;
    return bus_->writer({topic, type}, options);
  }
  static void send(bus::RawWriter& writer, const json& message) {
    const std::vector<std::uint8_t> cdr = realsense::write_flexible(message);
    writer.write(std::as_bytes(std::span(cdr)));
  }
  void take_request(const bus::RawSample& sample) {
    const auto* const bytes = reinterpret_cast<const std::uint8_t*>(sample.cdr().data());
    const json request = realsense::read_flexible({bytes, sample.cdr().size()});
    const json& color = request.at("stream-profiles").at("Color");
    const std::lock_guard lock(mutex_);
    if (!refuses_) {
      width_ = color.at(2);
      height_ = color.at(3);
    }
    reply_ = {{"id", "open-streams"}, {"status", refuses_ ? "error" : "ok"}};
    if (refuses_) (*reply_)["explanation"] = "the sensor streams to another program";
  }
  void describe() {
    send(*notification_, {{"id", "device-header"},
                          {"n-streams", 3},
                          {"extrinsics",
                           {{"Depth", "Infrared 1", {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}},
                            {"Color", "Infrared 1", {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, -script_.depth_ahead_m}}}}});
    send(*notification_, stream("Depth", "depth", {{30, "16UC1", script_.width, script_.height}}));
    send(*notification_, options("Depth"));
    send(*notification_, stream("Infrared 1", "ir", {{30, "mono8", script_.width, script_.height}}));
    send(*notification_, options("Infrared 1"));
    send(*notification_,
         stream("Color", "color",
                {{30, "rgb8", script_.width, script_.height}, {30, "rgb8", 2 * script_.width, 2 * script_.height}}));
    send(*notification_, options("Color"));
  }
  static json stream(const char* name, const char* type, const json& profiles) {
    return {{"id", "stream-header"}, {"name", name},         {"type", type},
            {"profiles", profiles},  {"sensor-name", "any"}, {"default-profile-index", 0}};
  }
  json options(const char* name) const {
    return {{"id", "stream-options"},
            {"stream-name", name},
            {"options", {{"Depth Units", script_.unit_m, 0.0001, 0.01, 0.0001, 0.001, "m"}}},
            {"intrinsics",
             {{"width", script_.width},
              {"height", script_.height},
              {"principal-point", {(script_.width - 1) / 2.0, (script_.height - 1) / 2.0}},
              {"focal-length", {script_.focal_px, script_.focal_px}}}}};
  }
  static void append_padded(std::vector<std::uint8_t>& bytes, const std::vector<std::uint8_t>& pixels, int rows) {
    const auto row = static_cast<std::ptrdiff_t>(pixels.size()) / rows;
    for (int y = 0; y < rows; ++y) {
      bytes.insert(bytes.end(), pixels.begin() + y * row, pixels.begin() + (y + 1) * row);
      bytes.insert(bytes.end(), kPadding, 0);
    }
  }
  void send_image(bus::RawWriter& writer, const char* encoding, int width, int height,
                  const std::vector<std::uint8_t>& pixels) const {
    msg::Image image;
    image.header = {msg::to_time(stamp_ns_), script_.serial};
    image.width = static_cast<std::uint32_t>(width);
    image.height = static_cast<std::uint32_t>(height);
    image.encoding = encoding;
    image.step = static_cast<std::uint32_t>(pixels.size()) / image.height + kPadding;
    append_padded(image.data, pixels, height);
    const std::vector<std::uint8_t> cdr = ros::encode<ros::Wire::kCdr>(image);
    writer.write(std::as_bytes(std::span(cdr)));
  }
  void send_images() {
    std::vector<std::uint8_t> rgb(static_cast<std::size_t>(width_) * height_ * 3, 77);
    std::vector<std::uint8_t> depth(static_cast<std::size_t>(script_.width) * script_.height * 2, 1);
    if (script_.next) script_.next(rgb, depth);
    if (color_->matched() > 0) send_image(*color_, "rgb8", width_, height_, rgb);
    if (depth_->matched() > 0) send_image(*depth_, "16UC1", script_.width, script_.height, depth);
  }
  void run() {
    int known = 0, listening = 0;
    for (; !ended_; stamp_ns_ += 33'000'000) {
      if (info_->matched() > known) {
        send(*info_, {{"name", "RealSense D555"}, {"serial", script_.serial}, {"topic-root", root_}});
      }
      known = info_->matched();
      if (notification_->matched() > listening) describe();
      listening = notification_->matched();
      if (stopping_) send(*info_, {{"stopping", true}});
      const std::lock_guard lock(mutex_);
      if (reply_) send(*notification_, *std::exchange(reply_, std::nullopt));
      send_images();
      std::this_thread::sleep_for(std::chrono::milliseconds(30));
    }
  }

  const RealsenseScript script_;
  std::shared_ptr<bus::RawBus> bus_;
  const std::string root_;
  std::unique_ptr<bus::RawWriter> info_, notification_, color_, depth_;
  std::unique_ptr<bus::RawReader> control_;
  std::mutex mutex_;
  std::optional<json> reply_;
  int width_ = script_.width, height_ = script_.height;  ///< of colour
  inline static std::atomic<std::int64_t> stamp_ns_ = 1'000'000'000;
  std::atomic<bool> ended_{false}, stopping_{false}, refuses_{false};
  std::thread thread_;
};

}  // namespace rtd::camera::test
