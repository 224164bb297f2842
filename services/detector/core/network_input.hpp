// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>

#include "services/detector/core/decoder.hpp"

namespace rtd::detector {

/// How a frame lies in the network's input: scaled with its aspect kept, centred, the rest grey.
///   input = scale * frame + pad   (pixel edges, so an image corner maps to an image corner)
struct Letterbox {
  double scale_x = 1, scale_y = 1;  ///< equal up to the rounding of the scaled size to whole pixels
  int pad_left_px = 0, pad_top_px = 0;
  int width_px = 0, height_px = 0;  ///< scaled frame inside the input
};

/// Both sizes must be positive.
Letterbox fit_letterbox(cv::Size frame, InputSize input);

/// Fills `blob` (CV_32F, 1x3xHxW, allocated when needed) with the letterboxed frame in this format.
/// `color_bgr` is CV_8UC3 of the size that `letterbox` was made for.
void fill_blob(const cv::Mat& color_bgr, const Letterbox& letterbox, InputSize input, const PixelFormat& pixels,
               cv::Mat& blob);

/// The candidate's box in pixels of the frame, clipped to it.
cv::Rect2f box_in_frame(const Candidate& candidate, const Letterbox& letterbox, cv::Size frame);

}  // namespace rtd::detector
