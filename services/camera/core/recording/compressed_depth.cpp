// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/core/recording/compressed_depth.hpp"

#include <cmath>

#include "common/ros_codec/byte_cursor.hpp"

namespace rtd::camera {
namespace {

constexpr double kMaxUnits = 65534;  // 65535 is TUM's "saturated"

/// depth = a / (pixel - b), 0 = no measurement.
cv::Mat from_inverse(const cv::Mat& pixels, float a, float b) {
  cv::Mat depth_m(pixels.size(), CV_32FC1);
  for (int row = 0; row < pixels.rows; ++row) {
    for (int column = 0; column < pixels.cols; ++column) {
      const std::uint16_t pixel = pixels.at<std::uint16_t>(row, column);
      depth_m.at<float>(row, column) = pixel == 0 ? 0.0F : a / (static_cast<float>(pixel) - b);
    }
  }
  return depth_m;
}

}  // namespace

cv::Mat quantize_depth(const cv::Mat& depth_m, double unit_m) {
  cv::Mat depth(depth_m.size(), CV_16UC1);
  for (int row = 0; row < depth.rows; ++row) {
    const auto* from = depth_m.ptr<float>(row);
    auto* to = depth.ptr<std::uint16_t>(row);
    for (int column = 0; column < depth.cols; ++column) {
      const double units = std::round(from[column] / unit_m);
      to[column] = units >= 0 && units <= kMaxUnits ? static_cast<std::uint16_t>(units) : 0;  // NaN compares false
    }
  }
  return depth;
}

bool is_compressed_depth(const msg::CompressedImage& image) {
  return image.format.find("compressedDepth") != std::string::npos;
}

ImageRead decode_compressed_depth(const msg::CompressedImage& image, const std::string& name, double float_unit_m) {
  if (image.format.find("rvl") != std::string::npos || image.format.find("RVL") != std::string::npos) {
    throw SourceError(name + " is encoded as '" + image.format + "', readable: compressedDepth with PNG");
  }
  ros::ByteCursor cursor(image.data);
  cursor.read<std::int32_t>();  // the driver's own code of the format; the text says more
  const auto a = cursor.read<float>(), b = cursor.read<float>();
  ImageRead result = decode_depth(cursor.take(cursor.remaining()), name);
  if (!result.problem && image.format.rfind("32FC1", 0) == 0) {
    result.image = quantize_depth(from_inverse(result.image, a, b), float_unit_m);
  }
  return result;
}

}  // namespace rtd::camera
