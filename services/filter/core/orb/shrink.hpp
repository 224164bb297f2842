// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>

namespace rtd::filter {

/// Smooths a CV_8UC1 image for the descriptors: Gauss, 7x7, sigma 2 px, mirrored at the border. The pixels are those of
/// cv::GaussianBlur, which computes in the same fixed-point numbers, for a fifth of its instructions. `smoothed` keeps
/// its memory if the size fits.
void smooth(const cv::Mat& grey, cv::Mat& smoothed);

/// The CV_8UC1 image in a smaller size, by bilinear interpolation: the pixels of cv::resize(INTER_LINEAR), which
/// computes in the same fixed-point numbers, for a third of its instructions on x86. `to` keeps its memory if the size
/// fits.
void shrink(const cv::Mat& from, cv::Size size, cv::Mat& to);

}  // namespace rtd::filter
