// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>

namespace rtd::camera {

/// Distinguishes the images of an infrared camera whose emitter is switched on and off in turn ("emitter on/off",
/// "alternating emitter" of RealSense). Dots of the emitter move with the camera, so that features on them say that it
/// rests; they also make an image richer in fine texture. Whether images alternate is known after kTurns + 2 of them.
/// Not thread-safe.
class EmitterSwitch {
 public:
  static constexpr int kTurns = 6;

  /// Whether the next image (8-bit, any channels) shows dots that those before and after it do not show.
  bool shows_dots(const cv::Mat& image);
  /// So many images in turn have had more and less texture that the emitter is switched.
  bool alternates() const { return alternates_; }

 private:
  void count_turn(double texture);
  bool has_more(double texture);

  bool alternates_ = false;
  double last_ = 0;                     ///< texture of the image before
  int turns_ = 0, direction_ = 0;       ///< changes up and down in a row, and that of the last one
  double with_dots_ = 0, without_ = 0;  ///< texture of either kind
  int same_ = 0;                        ///< images of one kind in a row
  bool had_dots_ = false;
};

}  // namespace rtd::camera
