// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "services/camera/core/live/live_device.hpp"
#include "services/camera/devices/kernel_calls.hpp"

namespace rtd::camera {

/// A /dev/video node that captures one stream into buffers that it shares with the kernel. Functions throw DeviceError.
class V4l2Node {
 public:
  V4l2Node(KernelCalls& calls, std::string path) : calls_(calls), path_(std::move(path)) {}
  ~V4l2Node() { close(); }
  V4l2Node(const V4l2Node&) = delete;
  V4l2Node& operator=(const V4l2Node&) = delete;

  /// Opens it and reads what it is; refuses nodes that do not capture video.
  void open();
  void close() noexcept;
  const std::string& path() const { return path_; }
  int fd() const { return fd_; }
  const std::string& card() const { return card_; }  ///< name of the camera
  const std::string& bus() const { return bus_; }    ///< where it is plugged in: the same for all nodes of a camera

  /// Z16 is a mode of depth, everything else of colour.
  std::vector<DeviceMode> modes();
  /// Sets the mode and starts to capture.
  void start(const DeviceMode& mode);
  /// A captured image, rows without bytes between them; empty when it is damaged or there is none.
  std::optional<DeviceImage> take();

 private:
  struct Buffer {
    std::uint8_t* data;
    std::size_t bytes;
  };

  void call(unsigned long request, void* argument, const char* what);
  DeviceError error_of(int code, const std::string& what) const;
  void add_sizes(std::uint32_t format, std::vector<DeviceMode>& modes);
  void add_rates(std::uint32_t format, cv::Size size_px, std::vector<DeviceMode>& modes);
  void set_mode(const DeviceMode& mode);
  void map_buffers();
  std::vector<std::uint8_t> pixels_of(const Buffer& buffer, std::size_t bytes) const;

  KernelCalls& calls_;
  const std::string path_;
  int fd_ = -1;
  std::string card_, bus_;
  DeviceMode mode_;
  std::size_t row_bytes_ = 0, step_bytes_ = 0;  ///< of pixels, and from a row to the next; 0 = compressed
  std::vector<Buffer> buffers_;
  bool streaming_ = false;
};

}  // namespace rtd::camera
