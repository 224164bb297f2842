// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <string>

#include "common/camera/frame_source.hpp"
#include "tests/support/temporary_folder.hpp"

namespace rtd::camera::layouts {

inline constexpr int kWidth = 64, kHeight = 48;
inline constexpr const char* kIntrinsics = "?intrinsics=52,53,31.5,23.5";

/// A folder below a temporary one, removed with the object.
class DataFolder {
 public:
  explicit DataFolder(const std::string& name = "kitchen") : path_(root_ / name) {
    std::filesystem::create_directories(path_);
  }
  const std::filesystem::path& path() const { return path_; }
  std::string uri(const std::string& parameters = "") const { return "folder:" + path_.string() + parameters; }
  void write(const std::string& file, const std::string& text) const {
    std::filesystem::create_directories((path_ / file).parent_path());
    std::ofstream(path_ / file, std::ios::binary) << text;
  }
  void color(const std::string& file, int width = kWidth, int height = kHeight) const {
    image(file, cv::Mat(height, width, CV_8UC3, cv::Scalar(40, 80, 120)));
  }
  void depth(const std::string& file, int units = 2000, int width = kWidth, int height = kHeight) const {
    image(file, cv::Mat(height, width, CV_16UC1, cv::Scalar(units)));
  }
  void image(const std::string& file, const cv::Mat& pixels) const {
    std::filesystem::create_directories((path_ / file).parent_path());
    ASSERT_TRUE(cv::imwrite((path_ / file).string(), pixels));
  }
  void npy(const std::string& file, const cv::Mat& values, const std::string& type, const std::string& shape) const {
    std::string header = "{'descr': '" + type + "', 'fortran_order': False, 'shape': " + shape + ", }";
    header.resize(118 - 1, ' ');
    header += '\n';
    const std::string start("\x93NUMPY\x01\x00\x76\x00", 10);
    write(file,
          start + header + std::string(reinterpret_cast<const char*>(values.data), values.total() * values.elemSize()));
  }

 private:
  rtd::test::TemporaryFolder root_;
  std::filesystem::path path_;
};

/// Metres at a pixel.
inline double metres(const SourceFrame& frame, int row = 10, int column = 10) {
  return frame.image.depth.at<std::uint16_t>(row, column) * frame.image.depth_scale_m;
}

inline std::string number(int i, int digits) {
  std::string text = std::to_string(i);
  return std::string(static_cast<std::size_t>(digits) - text.size(), '0') + text;
}

inline std::string notes_of(const FrameSource& source) {
  std::string notes;
  for (const std::string& note : source.info().notes) notes += note + "\n";
  return notes;
}

}  // namespace rtd::camera::layouts
