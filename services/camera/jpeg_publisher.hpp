// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <thread>

#include "common/bus/bus.hpp"
#include "common/concurrency/bounded_queue.hpp"

namespace rtd::camera {

/// Encodes images as JPEG and publishes them in a thread of its own that yields to everything else of the pipeline, so
/// that a listener to the JPEG topic delays no pose. offer(): one thread.
class JpegPublisher {
 public:
  /// `overflow`: what happens to an image while two others wait to be encoded.
  JpegPublisher(bus::Writer<msg::CompressedImage> writer, int quality, concurrency::Overflow overflow);
  /// Publishes what waits.
  ~JpegPublisher();
  JpegPublisher(const JpegPublisher&) = delete;
  JpegPublisher& operator=(const JpegPublisher&) = delete;

  /// Takes an image (8-bit BGR, shared: not to be changed any more) if somebody listens.
  void offer(const cv::Mat& color_bgr, std::int64_t stamp_ns);
  int readers() const { return writer_.matched(); }
  std::uint64_t encoded() const { return encoded_; }
  /// Images that a newer one has replaced.
  std::uint64_t dropped() const { return waiting_.dropped(); }

 private:
  struct Waiting {
    cv::Mat color_bgr;
    std::int64_t stamp_ns = 0;
  };
  void publish(const Waiting& image);

  bus::Writer<msg::CompressedImage> writer_;
  int quality_;
  std::atomic<std::uint64_t> encoded_{0};
  concurrency::BoundedQueue<Waiting> waiting_;
  std::thread thread_;
};

}  // namespace rtd::camera
