// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>

#include "common/ros_codec/wire.hpp"
#include "tests/support/rosbag1/bag_writer.hpp"

namespace rtd::camera::test {

/// A bag of 32 x 24 px images that a test puts together.
class ImageBag {
 public:
  static constexpr int kWidth = 32, kHeight = 24;
  static constexpr const char* kColor = "/camera/rgb/image_color";
  static constexpr const char* kDepth = "/camera/depth/image";
  static constexpr const char* kInfo = "/camera/rgb/camera_info";

  explicit ImageBag(const std::string& compression = "lz4") : writer_(compression) {}

  static cv::Mat color(int grey = 100) { return {kHeight, kWidth, CV_8UC3, cv::Scalar(grey, grey + 1, grey + 2)}; }
  static cv::Mat depth(int units = 1500) { return {kHeight, kWidth, CV_16UC1, cv::Scalar(units)}; }

  static msg::Image image(const cv::Mat& pixels, const std::string& encoding, double stamp_s) {
    msg::Image message;
    message.header = {msg::to_time(static_cast<std::int64_t>(stamp_s * 1e9)), "/kinect"};
    message.height = static_cast<std::uint32_t>(pixels.rows);
    message.width = static_cast<std::uint32_t>(pixels.cols);
    message.encoding = encoding;
    message.step = message.width * static_cast<std::uint32_t>(pixels.elemSize());
    message.data.assign(pixels.datastart, pixels.dataend);
    return message;
  }
  static msg::CameraInfo camera_info(double fx = 30) {
    msg::CameraInfo info;
    info.width = kWidth;
    info.height = kHeight;
    info.distortion_model = "plumb_bob";
    info.k = {fx, 0, 15.5, 0, 31, 11.5, 0, 0, 1};
    return info;
  }

  template <class Message>
  void add(const std::string& topic, const std::string& type, const Message& message, double recorded_s) {
    const std::vector<std::uint8_t> bytes = ros::encode<ros::Wire::kRos1>(message);
    writer_.message(id(topic, type), static_cast<std::int64_t>(recorded_s * 1e9), bytes);
  }
  /// Of a type that only the bag defines.
  void add_defined(const std::string& topic, const std::string& type, const std::string& definition,
                   const std::vector<std::uint8_t>& bytes, double recorded_s) {
    writer_.message(writer_.connection(topic, type, definition), static_cast<std::int64_t>(recorded_s * 1e9), bytes);
  }
  void add_info(const msg::CameraInfo& info = camera_info()) { add(kInfo, "sensor_msgs/CameraInfo", info, 0.5); }
  void add_color(double stamp_s, const cv::Mat& pixels = color(), const std::string& encoding = "bgr8") {
    add(kColor, "sensor_msgs/Image", image(pixels, encoding, stamp_s), stamp_s + 0.001);
  }
  void add_depth(double stamp_s, const cv::Mat& pixels = depth(), const std::string& encoding = "16UC1") {
    add(kDepth, "sensor_msgs/Image", image(pixels, encoding, stamp_s), stamp_s + 0.002);
  }
  void one_frame(const msg::CameraInfo& info = camera_info()) {
    add_info(info);
    add_color(1);
    add_depth(1);
  }
  /// Calibration and frames at 1.0, 1.1, 1.2 s, a chunk each.
  void three_frames() {
    add_info();
    for (const double stamp_s : {1.0, 1.1, 1.2}) {
      add_color(stamp_s);
      add_depth(stamp_s + 0.01);
      writer_.end_chunk();
    }
  }
  std::string bytes() { return writer_.closed(); }
  /// Closes the bag and gives its URI.
  std::string uri() { return uri_of(bytes()); }
  std::string uri_of(const std::string& bytes) {
    file_.emplace("camera.bag", bytes);
    return "bag:" + file_->path().string();
  }

 private:
  std::uint32_t id(const std::string& topic, const std::string& type) {
    const auto [found, is_new] = ids_.try_emplace(topic, 0);
    if (is_new) found->second = writer_.connection(topic, type);
    return found->second;
  }
  rtd::test::BagWriter writer_;
  std::map<std::string, std::uint32_t> ids_;
  std::optional<rtd::test::TemporaryFile> file_;
};

}  // namespace rtd::camera::test
