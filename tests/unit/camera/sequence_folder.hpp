// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <string>

#include "tests/support/temporary_folder.hpp"

namespace rtd::camera::test {

/// A TUM folder of 64 x 48 px frames that a test writes and damages; removed with the object.
class SequenceFolder {
 public:
  static constexpr int kWidth = 64, kHeight = 48;

  explicit SequenceFolder(const std::string& name = "sequence") : path_(root_ / name) {
    std::filesystem::create_directories(path_ / "rgb");
    std::filesystem::create_directories(path_ / "depth");
  }
  const std::filesystem::path& path() const { return path_; }
  std::string uri() const { return "tum:" + path_.string(); }

  void write(const std::string& file, const std::string& text) const {
    std::ofstream(path_ / file, std::ios::binary) << text;
  }
  void append(const std::string& file, const std::string& text) const {
    std::ofstream(path_ / file, std::ios::binary | std::ios::app) << text;
  }
  void image(const std::string& file, const cv::Mat& pixels) const { cv::imwrite((path_ / file).string(), pixels); }
  void truncate(const std::string& file) const {
    std::filesystem::resize_file(path_ / file, std::filesystem::file_size(path_ / file) / 2);
  }

  static std::string calibration(int width = kWidth, int height = kHeight) {
    return "width: " + std::to_string(width) + "\nheight: " + std::to_string(height) +
           "\nfx: 52\nfy: 53\ncx: 31.5\ncy: 23.5\ndepth_factor: 5000\nfps: 30\n";
  }
  static cv::Mat color(int width = kWidth, int height = kHeight) {
    cv::Mat pixels(height, width, CV_8UC3);
    cv::randu(pixels, 0, 255);
    return pixels;
  }
  static cv::Mat depth(int units = 5000) { return cv::Mat(kHeight, kWidth, CV_16UC1, cv::Scalar(units)); }

  /// Colour and depth of one frame at `stamp` and their lines in the lists.
  void frame(const std::string& stamp, const cv::Mat& depth_image = depth()) const {
    image("rgb/" + stamp + ".png", color());
    image("depth/" + stamp + ".png", depth_image);
    append("rgb.txt", stamp + " rgb/" + stamp + ".png\n");
    append("depth.txt", stamp + " depth/" + stamp + ".png\n");
  }
  /// A sound sequence of three frames at 1.0, 1.1 and 1.2 s.
  void three_frames() const {
    write("calibration.yaml", calibration());
    for (const char* stamp : {"1.0", "1.1", "1.2"}) frame(stamp);
  }

 private:
  rtd::test::TemporaryFolder root_;
  std::filesystem::path path_;
};

}  // namespace rtd::camera::test
