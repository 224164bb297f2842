// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/recording/color_encodings.hpp"

#include <algorithm>
#include <array>
#include <opencv2/imgproc.hpp>

namespace rtd::camera {
namespace {

constexpr int kAsItIs = -1;

/// OpenCV's short names of Bayer patterns (BayerBG for rggb) are those of the second row and column; these are not.
constexpr std::array kEncodings = {ColorEncoding{"rgb8", CV_8UC3, cv::COLOR_RGB2BGR},
                                   ColorEncoding{"bgr8", CV_8UC3, kAsItIs},
                                   ColorEncoding{"rgba8", CV_8UC4, cv::COLOR_RGBA2BGR},
                                   ColorEncoding{"bgra8", CV_8UC4, cv::COLOR_BGRA2BGR},
                                   ColorEncoding{"mono8", CV_8UC1, cv::COLOR_GRAY2BGR},
                                   ColorEncoding{"rgb16", CV_16UC3, cv::COLOR_RGB2BGR},
                                   ColorEncoding{"bgr16", CV_16UC3, kAsItIs},
                                   ColorEncoding{"rgba16", CV_16UC4, cv::COLOR_RGBA2BGR},
                                   ColorEncoding{"bgra16", CV_16UC4, cv::COLOR_BGRA2BGR},
                                   ColorEncoding{"mono16", CV_16UC1, cv::COLOR_GRAY2BGR},
                                   ColorEncoding{"16UC1", CV_16UC1, cv::COLOR_GRAY2BGR},
                                   ColorEncoding{"8UC1", CV_8UC1, cv::COLOR_GRAY2BGR},
                                   ColorEncoding{"8UC3", CV_8UC3, kAsItIs},
                                   ColorEncoding{"8UC4", CV_8UC4, cv::COLOR_BGRA2BGR},
                                   ColorEncoding{"yuv422", CV_8UC2, cv::COLOR_YUV2BGR_UYVY},
                                   ColorEncoding{"uyvy", CV_8UC2, cv::COLOR_YUV2BGR_UYVY},
                                   ColorEncoding{"yuv422_yuy2", CV_8UC2, cv::COLOR_YUV2BGR_YUYV},
                                   ColorEncoding{"yuy2", CV_8UC2, cv::COLOR_YUV2BGR_YUYV},
                                   ColorEncoding{"yuyv", CV_8UC2, cv::COLOR_YUV2BGR_YUYV},
                                   ColorEncoding{"YUYV", CV_8UC2, cv::COLOR_YUV2BGR_YUYV},  // RealSense SDK
                                   ColorEncoding{"nv12", CV_8UC1, cv::COLOR_YUV2BGR_NV12},
                                   ColorEncoding{"nv21", CV_8UC1, cv::COLOR_YUV2BGR_NV21},
                                   ColorEncoding{"nv24", CV_8UC1, cv::COLOR_YUV2BGR_YUYV},  // by way of yuyv
                                   ColorEncoding{"bayer_rggb8", CV_8UC1, cv::COLOR_BayerRGGB2BGR},
                                   ColorEncoding{"bayer_bggr8", CV_8UC1, cv::COLOR_BayerBGGR2BGR},
                                   ColorEncoding{"bayer_gbrg8", CV_8UC1, cv::COLOR_BayerGBRG2BGR},
                                   ColorEncoding{"bayer_grbg8", CV_8UC1, cv::COLOR_BayerGRBG2BGR},
                                   ColorEncoding{"bayer_rggb16", CV_16UC1, cv::COLOR_BayerRGGB2BGR},
                                   ColorEncoding{"bayer_bggr16", CV_16UC1, cv::COLOR_BayerBGGR2BGR},
                                   ColorEncoding{"bayer_gbrg16", CV_16UC1, cv::COLOR_BayerGBRG2BGR},
                                   ColorEncoding{"bayer_grbg16", CV_16UC1, cv::COLOR_BayerGRBG2BGR}};

/// OpenCV does not know nv24: of each two pixels the blue chroma of the left and the red one of the right are taken.
cv::Mat yuyv_of_nv24(const cv::Mat& planes) {
  cv::Mat yuyv(planes.rows / 3, planes.cols, CV_8UC2);
  const cv::Mat chroma = planes.rowRange(yuyv.rows, planes.rows).clone().reshape(2, yuyv.rows);
  yuyv.forEach<cv::Vec2b>([&](cv::Vec2b& pixel, const int* at) {
    pixel = {planes.at<std::uint8_t>(at[0], at[1]), chroma.at<cv::Vec2b>(at[0], at[1])[at[1] % 2]};
  });
  return yuyv;
}

/// A view, or the upper eight of so many bits.
cv::Mat eight_bit(const cv::Mat& pixels, int bits) {
  if (pixels.depth() == CV_8U) return pixels;
  const double step = 1 << (bits - 8);
  cv::Mat upper;
  pixels.convertTo(upper, CV_8U, 1 / step, (1 - step) / (2 * step));  // convertTo() rounds
  return upper;
}

}  // namespace

const ColorEncoding* find_color_encoding(std::string_view name) {
  const auto* const found = std::ranges::find(kEncodings, name, &ColorEncoding::name);
  return found == kEncodings.end() ? nullptr : found;
}

std::string known_color_encodings() {
  std::string text;
  for (const ColorEncoding& encoding : kEncodings) {
    if (!text.empty()) text += ", ";
    text += encoding.name;
  }
  return text;
}

std::string size_defect(const ColorEncoding& encoding, cv::Size size_px) {
  constexpr int kBayer_px = 3;
  if (encoding.rows(2) == 3 && (size_px.width % 2 != 0 || size_px.height % 3 != 0)) return "its sides must be even";
  if ((CV_MAT_CN(encoding.type) == 2 || encoding.name == "nv24") && size_px.width % 2 != 0)
    return "its width must be even";
  if (!encoding.name.starts_with("bayer_") || (size_px.width >= kBayer_px && size_px.height >= kBayer_px)) return {};
  return "it needs 3 x 3 px";
}

cv::Mat to_bgr(const ColorEncoding& encoding, const cv::Mat& pixels, int bits) {
  const cv::Mat eight = encoding.name == "nv24" ? yuyv_of_nv24(pixels) : eight_bit(pixels, bits);
  cv::Mat bgr;
  if (encoding.conversion == kAsItIs) {
    eight.copyTo(bgr);
  } else {
    cv::cvtColor(eight, bgr, encoding.conversion);
  }
  return bgr;
}

}  // namespace rtd::camera
