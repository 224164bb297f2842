// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <opencv2/core.hpp>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "common/bus/bus_factory.hpp"
#include "common/vision/detection.hpp"

namespace rtd::test_support {

/// Images say whose they are and which: `id` of the robot and the number modulo kNumbers, each as a block of grey. What
/// stands in for a network reads both out of the pixels, so that an answer that goes astray is found.
inline constexpr int kMaxIds = 32, kNumbers = 32;
cv::Mat marked_image(cv::Size size, int id, int number);
/// One detection: class "robotID", left edge at the number.
std::vector<vision::Detection> read_marks(const cv::Mat& image);
std::vector<std::vector<vision::Detection>> read_all_marks(std::span<const cv::Mat> images);

/// A camera and a filter of one robot, on a connection of their own: sends JPEG images at a rate and checks every
/// answer for its topic, frame, stamp and content. Thread-safe.
class RobotDouble {
 public:
  struct Options {
    std::string name;  ///< "": the robot without a name
    int id = 0;        ///< 0 to kMaxIds - 1
    double rate_hz = 30;
    cv::Size size{320, 240};
    bool broken = false;  ///< sends bytes that are no image, without end
  };
  struct Figures {
    std::uint64_t sent = 0, answered = 0;
    std::uint64_t wrong = 0;           ///< answers to another robot, another image, or to none that was sent
    std::vector<double> latencies_ms;  ///< from write() to the answer
    std::int64_t longest_gap_ms = 0;   ///< between two answers
  };

  RobotDouble(const bus::BusOptions& options, Options robot);
  ~RobotDouble();
  RobotDouble(const RobotDouble&) = delete;
  RobotDouble& operator=(const RobotDouble&) = delete;

  /// Since the last take_figures().
  Figures figures() const;
  Figures take_figures();
  /// Waits for so many answers since the last take_figures().
  bool wait_answers(std::uint64_t count, std::chrono::milliseconds patience = std::chrono::seconds(20)) const;
  /// The newest heartbeat of its detector.
  std::optional<msg::ServiceStatus> status() const;
  /// Detectors that read its images.
  int readers() const { return jpegs_.matched(); }
  void set_rate(double rate_hz) { rate_hz_ = rate_hz; }

 private:
  void send_until_ended();
  void send(std::uint64_t number);
  void receive(const msg::Detection2DArray& answer);

  const Options robot_;
  const std::shared_ptr<bus::Bus> bus_;
  std::vector<std::vector<std::uint8_t>> encoded_;
  std::atomic<double> rate_hz_;
  mutable std::mutex mutex_;
  Figures figures_;
  std::map<std::int64_t, std::int64_t> sent_ns_;  ///< by stamp: images that have no answer yet
  std::int64_t answered_ns_ = 0;
  std::optional<msg::ServiceStatus> status_;
  bus::Writer<msg::CompressedImage> jpegs_;
  bus::Reader<msg::Detection2DArray> detections_;
  bus::Reader<msg::ServiceStatus> statuses_;
  std::atomic<bool> ended_{false};
  std::thread sender_;
};

/// The value below which the share lies; 0 without values.
double quantile(std::vector<double> values, double share);

}  // namespace rtd::test_support
