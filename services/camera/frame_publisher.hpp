// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>

#include "common/bus/bus.hpp"
#include "services/camera/core/frame_source.hpp"

namespace rtd::camera {

/// Fills every field of a loaned frame.
void fill_frame(const vision::RgbdImage& image, std::uint64_t source_id, std::int64_t published_ns,
                msg::RgbdFrame& frame);

/// Puts frames on the bus: raw by loan, as JPEG while somebody listens, and the camera's calibration. One thread.
class FramePublisher {
 public:
  /// `on_matched` is called on a bus thread when readers of the frame come or go.
  FramePublisher(bus::Bus& bus, int jpeg_quality, std::function<void()> on_matched);

  /// False when the bus did not take the raw frame.
  bool publish(const vision::RgbdImage& image);
  /// Readers of the raw frame and of the JPEG topic.
  int frame_readers() const { return frames_.matched(); }
  int jpeg_readers() const { return jpegs_.matched(); }
  std::uint64_t jpegs_encoded() const { return jpegs_encoded_; }

 private:
  bool publish_raw(const vision::RgbdImage& image);
  void publish_jpeg(const vision::RgbdImage& image);

  int jpeg_quality_;
  std::uint64_t source_id_;
  bus::Writer<msg::RgbdFrame> frames_;
  bus::Writer<msg::CompressedImage> jpegs_;
  bus::Writer<msg::CameraInfo> infos_;
  bool info_sent_ = false;
  std::uint64_t jpegs_encoded_ = 0;
};

}  // namespace rtd::camera
