// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>

#include "common/bus/bus.hpp"
#include "services/camera/core/frame_source.hpp"
#include "services/camera/jpeg_publisher.hpp"

namespace rtd::camera {

/// Fills every field of a loaned frame.
void fill_frame(const vision::RgbdImage& image, std::uint64_t source_id, std::int64_t published_ns,
                msg::RgbdFrame& frame);

/// Puts frames on the bus: raw by loan, as JPEG while somebody listens (beside, a little later), and the camera's
/// calibration. One thread.
class FramePublisher {
 public:
  /// `jpeg_overflow`: what happens when JPEGs are wanted faster than they can be encoded. `on_matched` is called on a
  /// bus thread when readers of the frame come or go.
  FramePublisher(bus::Bus& bus, int jpeg_quality, concurrency::Overflow jpeg_overflow,
                 std::function<void()> on_matched);

  /// False when the bus did not take the raw frame.
  bool publish(const vision::RgbdImage& image);
  /// Readers of the raw frame and of the JPEG topic.
  int frame_readers() const { return frames_.matched(); }
  int jpeg_readers() const { return jpegs_.readers(); }
  const JpegPublisher& jpegs() const { return jpegs_; }

 private:
  bool publish_raw(const vision::RgbdImage& image);

  std::uint64_t source_id_;
  bus::Writer<msg::RgbdFrame> frames_;
  bus::Writer<msg::CameraInfo> infos_;
  bool info_sent_ = false;
  JpegPublisher jpegs_;
};

}  // namespace rtd::camera
