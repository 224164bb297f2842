// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>

#include "services/detector/core/decoders/decoder.hpp"

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

/// How a frame lies in the network's input when it is turned upright: turned about its centre, shrunk until all of it
/// fits, centred, the rest grey.
///   input = input centre + scale * R (frame - frame centre),   R = (cos -sin; sin cos)   (pixel edges, y down)
struct UprightView {
  double cos = 1, sin = 0;  ///< of the roll: turns the image clockwise, as it is seen
  double scale = 1;
  cv::Size frame;
  InputSize input;
};

/// `roll_rad`: by how much the image must be turned clockwise to stand upright (CameraRoll).
UprightView fit_upright(cv::Size frame, InputSize input, double roll_rad);

/// Fills `blob` as fill_blob() does. Turning and shrinking are one step: 1 ms for 640x480.
void fill_upright_blob(const cv::Mat& color_bgr, const UprightView& view, const PixelFormat& pixels, cv::Mat& blob);

/// The axis-parallel box in the frame, clipped to it, around the ellipse that fills `candidate`. The corners of an
/// upright box are background: a box around the turned corners would hold up to twice the area (w = h, 45 degrees),
/// and depth clusters of neighbours with it. An ellipse has no corners, touches the sides where people do (head, feet,
/// elbows), and at 0 and 90 degrees its box is exactly the detected one. With half sides a, b:
///   half width = sqrt((a cos)^2 + (b sin)^2),   half height = sqrt((a sin)^2 + (b cos)^2)
cv::Rect2f box_in_frame(const Candidate& candidate, const UprightView& view);

}  // namespace rtd::detector
