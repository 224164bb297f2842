// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <fstream>
#include <opencv2/core.hpp>
#include <string>
#include <string_view>

namespace rtd::test {

/// Writes an .oni file of uncompressed RGB and millimetre depth images, of the records that OpenNI2's own recorder
/// writes. Recordings of its Dummy driver lack the cropping without which its player gives no frames.
class OniWriter {
 public:
  OniWriter(const std::string& file, cv::Size size_px, std::uint32_t fps, double horizontal_fov_rad = 1.0,
            double vertical_fov_rad = 0.8)
      : file_(file, std::ios::binary), size_px_(size_px), fps_(fps) {
    file_ << "NI10";
    put<std::uint8_t>(1), put<std::uint8_t>(0), put<std::uint16_t>(1), put<std::uint32_t>(0);
    put<std::uint64_t>(~std::uint64_t{0}), put<std::uint32_t>(kDepth);
    add_node(kImage, "Image", 3, 200, horizontal_fov_rad, vertical_fov_rad);
    add_node(kDepth, "Depth", 2, 100, horizontal_fov_rad, vertical_fov_rad);
    for (const std::uint32_t node : {kImage, kDepth}) {
      record(9, node, {});
      record(8, node, std::string(12, '\xFF'));
    }
  }
  ~OniWriter() { record(11, 0, {}); }
  OniWriter(const OniWriter&) = delete;
  OniWriter& operator=(const OniWriter&) = delete;

  void color(std::uint64_t stamp_us, const cv::Mat& rgb) { image(kImage, stamp_us, ++colors_, rgb); }
  void depth(std::uint64_t stamp_us, const cv::Mat& depth_mm) { image(kDepth, stamp_us, ++depths_, depth_mm); }

 private:
  static constexpr std::uint32_t kImage = 1, kDepth = 2;
  static constexpr std::uint32_t kMaxFrames = 1'000'000;

  template <class T>
  static std::string bytes(T value) {
    return {reinterpret_cast<const char*>(&value), sizeof(value)};
  }
  static std::string text(std::string_view value) {
    return bytes(static_cast<std::uint32_t>(value.size() + 1)) + std::string(value) + '\0';
  }
  template <class T>
  void put(T value) {
    file_ << bytes(value);
  }
  void record(std::uint32_t type, std::uint32_t node, const std::string& fields, std::string_view payload = {}) {
    constexpr std::uint32_t kHeaderBytes = 28;
    put<std::uint32_t>(0x0052494E), put(type), put(node);
    put(static_cast<std::uint32_t>(kHeaderBytes + fields.size()));
    put(static_cast<std::uint32_t>(payload.size()));
    put<std::uint64_t>(0);
    file_ << fields << payload;
  }
  void number(std::uint32_t node, const char* name, std::uint64_t value) {
    record(3, node, text(name) + bytes<std::uint32_t>(8) + bytes(value));
  }
  void blob(std::uint32_t node, const char* name, const std::string& value) {
    record(6, node, text(name) + bytes(static_cast<std::uint32_t>(value.size())) + value);
  }
  void add_node(std::uint32_t node, const char* name, std::uint32_t type, std::uint64_t format, double fov_x,
                double fov_y) {
    const std::string counts = bytes<std::uint32_t>(kMaxFrames) + std::string(24, '\0');  // stamps, seek table: unknown
    record(13, node, text(name) + bytes(type) + "NONE" + counts);
    const std::uint64_t pixel_bytes = node == kImage ? 3 : 2;
    number(node, "oniRequiredFrameSize", static_cast<std::uint64_t>(size_px_.area()) * pixel_bytes);
    number(node, "xnIsGenerating", 1);
    blob(node, "xnMapOutputMode", bytes(size_px_.width) + bytes(size_px_.height) + bytes(fps_));
    blob(node, "xnCropping", std::string(12, '\0'));
    blob(node, "xnFOV", bytes(fov_x) + bytes(fov_y));
    number(node, "oniPixelFormat", format);
  }
  void image(std::uint32_t node, std::uint64_t stamp_us, std::uint32_t index, const cv::Mat& pixels) {
    const cv::Mat whole = pixels.isContinuous() ? pixels : pixels.clone();
    record(10, node, bytes(stamp_us) + bytes(index),
           {reinterpret_cast<const char*>(whole.data), whole.total() * whole.elemSize()});
  }

  std::ofstream file_;
  const cv::Size size_px_;
  const std::uint32_t fps_;
  std::uint32_t colors_ = 0, depths_ = 0;
};

}  // namespace rtd::test
