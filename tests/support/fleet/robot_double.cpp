// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/fleet/robot_double.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <utility>

#include "common/bus/robot.hpp"
#include "common/service/monotonic_clock.hpp"

namespace rtd::test_support {
namespace {

constexpr int kStep = 8;  // of grey between two marks: JPEG changes a block of one grey by 1 or 2
constexpr std::size_t kMaxUnanswered = 10'000;

cv::Mat block(const cv::Mat& image, int index) {
  const int width = image.cols / 4, height = image.rows / 2;
  return image(cv::Rect(index * width, 0, width, height));
}

int read_mark(const cv::Mat& image, int index) {
  const cv::Mat marked = block(image, index);
  const cv::Rect middle(marked.cols / 4, marked.rows / 4, marked.cols / 2, marked.rows / 2);
  return static_cast<int>(cv::mean(marked(middle))[0]) / kStep;
}

std::string class_of(int id) {
  return "robot" + std::to_string(id);
}

}  // namespace

/// Noise below the marks, so that a JPEG is about as large as one of a camera.
cv::Mat marked_image(cv::Size size, int id, int number) {
  cv::Mat image(size, CV_8UC3), coarse((size.height + 3) / 4, (size.width + 3) / 4, CV_8UC3);
  cv::theRNG().state = static_cast<std::uint64_t>(id * kNumbers + number + 1);
  cv::randu(coarse, 0, 255);
  for (int row = 0; row < size.height; ++row)
    for (int col = 0; col < size.width; ++col) image.at<cv::Vec3b>(row, col) = coarse.at<cv::Vec3b>(row / 4, col / 4);
  block(image, 0).setTo(cv::Scalar::all(id * kStep + kStep / 2));
  block(image, 1).setTo(cv::Scalar::all(number * kStep + kStep / 2));
  return image;
}

std::vector<vision::Detection> read_marks(const cv::Mat& image) {
  const auto number = static_cast<float>(read_mark(image, 1));
  return {{class_of(read_mark(image, 0)), 1.0F, number, 0, 10, 10}};
}

std::vector<std::vector<vision::Detection>> read_all_marks(std::span<const cv::Mat> images) {
  std::vector<std::vector<vision::Detection>> found;
  for (const cv::Mat& image : images) found.push_back(read_marks(image));
  return found;
}

RobotDouble::RobotDouble(const bus::BusOptions& options, Options robot)
    : robot_(std::move(robot)),
      bus_([&] {
        bus::BusOptions own = options;
        own.robot = robot_.name;
        return bus::connect(own);
      }()),
      rate_hz_(robot_.rate_hz),
      jpegs_(bus_->writer(bus::topics::kColorJpeg)) {
  for (int number = 0; number < kNumbers; ++number) {
    encoded_.emplace_back();
    if (robot_.broken) {
      encoded_.back().assign(5000, static_cast<std::uint8_t>(number));
      if (number % 2 == 0) {
        encoded_.back()[0] = 0xFF;
        encoded_.back()[1] = 0xD8;
      }
    } else {
      cv::imencode(".jpg", marked_image(robot_.size, robot_.id, number), encoded_.back());
    }
  }
  detections_ =
      bus_->reader<msg::Detection2DArray>(bus::topics::kDetections, [this](const auto& answer) { receive(*answer); });
  statuses_ = bus_->reader<msg::ServiceStatus>(bus::topics::kStatus, [this](const auto& status) {
    const std::lock_guard lock(mutex_);
    if (status->service == "detector") status_ = *status;
  });
  sender_ = std::thread([this] { send_until_ended(); });
}

RobotDouble::~RobotDouble() {
  ended_ = true;
  sender_.join();
}

void RobotDouble::send_until_ended() {
  auto due = std::chrono::steady_clock::now();
  for (std::uint64_t number = 0; !ended_; ++number) {
    send(number);
    due += std::chrono::nanoseconds(static_cast<std::int64_t>(1e9 / rate_hz_));
    due = std::max(due, std::chrono::steady_clock::now() - std::chrono::milliseconds(100));
    std::this_thread::sleep_until(due);
  }
}

void RobotDouble::send(std::uint64_t number) {
  const auto stamp_ns = static_cast<std::int64_t>(number + 1) * 1000;
  {
    const std::lock_guard lock(mutex_);
    sent_ns_[stamp_ns] = service::monotonic_ns();
    if (sent_ns_.size() > kMaxUnanswered) sent_ns_.erase(sent_ns_.begin());
    ++figures_.sent;
  }
  jpegs_.write({{msg::to_time(stamp_ns), "camera"}, "jpeg", encoded_[number % kNumbers]});
}

void RobotDouble::receive(const msg::Detection2DArray& answer) {
  const std::int64_t now_ns = service::monotonic_ns(), stamp_ns = msg::to_ns(answer.header.stamp);
  const auto number = static_cast<double>((stamp_ns / 1000 - 1) % kNumbers);
  const std::lock_guard lock(mutex_);
  const auto sent = sent_ns_.find(stamp_ns);
  const bool right = sent != sent_ns_.end() && answer.detections.size() == 1 &&
                     answer.detections[0].results[0].hypothesis.class_id == class_of(robot_.id) &&
                     std::abs(answer.detections[0].bbox.center.position.x - 5 - number) < 0.5 &&
                     answer.header.frame_id == bus::frame_of_robot("camera_color_optical_frame", robot_.name);
  ++figures_.answered;
  if (answered_ns_ > 0)
    figures_.longest_gap_ms = std::max(figures_.longest_gap_ms, (now_ns - answered_ns_) / 1'000'000);
  answered_ns_ = now_ns;
  if (!right) ++figures_.wrong;
  if (sent == sent_ns_.end()) return;
  figures_.latencies_ms.push_back(static_cast<double>(now_ns - sent->second) / 1e6);
  sent_ns_.erase(sent);
}

RobotDouble::Figures RobotDouble::figures() const {
  const std::lock_guard lock(mutex_);
  return figures_;
}

RobotDouble::Figures RobotDouble::take_figures() {
  const std::lock_guard lock(mutex_);
  answered_ns_ = 0;
  return std::exchange(figures_, {});
}

bool RobotDouble::wait_answers(std::uint64_t count, std::chrono::milliseconds patience) const {
  const auto give_up = std::chrono::steady_clock::now() + patience;
  while (figures().answered < count) {
    if (std::chrono::steady_clock::now() > give_up) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return true;
}

std::optional<msg::ServiceStatus> RobotDouble::status() const {
  const std::lock_guard lock(mutex_);
  return status_;
}

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  const auto rank = std::lround(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + rank, values.end());
  return values[static_cast<std::size_t>(rank)];
}

}  // namespace rtd::test_support
