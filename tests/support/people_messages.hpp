// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <random>
#include <vector>

#include "common/msg/rgbd_frame.hpp"
#include "common/msg/ros.hpp"
#include "common/msg/stamps.hpp"
#include "common/ros_codec/wire.hpp"
#include "tests/support/frame_header.hpp"

/// Messages of a camera of 320 x 240 px that a person is in view of, and of its detector.
namespace rtd::test_support {

inline const cv::Rect kPerson{100, 40, 80, 180}, kFace{124, 48, 32, 40};

/// A textured room, and a person whose face has eyes and a mouth.
inline cv::Mat room_with_person() {
  cv::Mat image(240, 320, CV_8UC3);
  std::mt19937 random(5);
  for (std::size_t i = 0; i < image.total() * 3; ++i) image.data[i] = static_cast<std::uint8_t>(random() % 256);
  cv::rectangle(image, kPerson, {90, 60, 40}, cv::FILLED);
  cv::rectangle(image, kFace, {150, 180, 220}, cv::FILLED);
  for (const int x : {8, 24}) cv::circle(image, kFace.tl() + cv::Point(x, 14), 3, {30, 30, 30}, cv::FILLED);
  cv::ellipse(image, kFace.tl() + cv::Point(16, 30), {9, 4}, 0, 0, 180, {20, 20, 140}, cv::FILLED);
  return image;
}

inline std::vector<std::uint8_t> frame_cdr(std::int64_t stamp_ns, const cv::Mat& color_bgr) {
  auto frame = std::make_unique<msg::RgbdFrame>();
  fill_header(*frame, static_cast<std::uint32_t>(color_bgr.cols), static_cast<std::uint32_t>(color_bgr.rows));
  frame->stamp_ns = stamp_ns;
  frame->color_bgr.fill(0);
  frame->depth.fill(1500);
  std::copy(color_bgr.datastart, color_bgr.dataend, frame->color_bgr.begin());
  std::vector<std::uint8_t> cdr(4 + sizeof(msg::RgbdFrame));
  cdr[1] = 1;
  std::memcpy(cdr.data() + 4, frame.get(), sizeof(msg::RgbdFrame));
  return cdr;
}

/// Of a recorded frame.
inline cv::Mat colors_of(const std::vector<std::uint8_t>& frame_cdr) {
  cv::Mat image(240, 320, CV_8UC3);
  std::memcpy(image.data, frame_cdr.data() + 4 + offsetof(msg::RgbdFrame, color_bgr), image.total() * 3);
  return image;
}

inline msg::Detection2DArray detections(std::int64_t stamp_ns, const std::vector<cv::Rect>& people,
                                        const std::string& class_name = "person") {
  msg::Detection2DArray batch;
  batch.header = {msg::to_time(stamp_ns), "camera_color_optical_frame"};
  for (const cv::Rect& person : people) {
    msg::Detection2D& box = batch.detections.emplace_back();
    box.results.push_back({.hypothesis = {class_name, 0.8}});
    box.bbox.center.position = {person.x + person.width / 2.0, person.y + person.height / 2.0};
    box.bbox.size_x = person.width;
    box.bbox.size_y = person.height;
  }
  return batch;
}

inline std::vector<std::uint8_t> cdr_of(const auto& message) {
  return ros::encode<ros::Wire::kCdr>(message);
}

/// How much of what makes a face of another is left, 0 to 1: the correlation of what is finer than its outline, at the
/// best place near by.
inline double likeness(const cv::Mat& original, const cv::Mat& recorded) {
  cv::Mat face, around;
  cv::cvtColor(original(kFace), face, cv::COLOR_BGR2GRAY);
  cv::cvtColor(recorded(kFace + cv::Size(8, 8) - cv::Point(4, 4)), around, cv::COLOR_BGR2GRAY);
  cv::Mat match;
  cv::matchTemplate(around, face, match, cv::TM_CCOEFF_NORMED);
  double best = 0;
  cv::minMaxLoc(match, nullptr, &best);
  return best;
}

}  // namespace rtd::test_support
