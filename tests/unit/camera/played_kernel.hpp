// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <linux/videodev2.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <deque>
#include <map>
#include <string>
#include <vector>

#include "services/camera/devices/kernel_calls.hpp"

namespace rtd::camera::test {

/// A node of a camera, as a test sets it up.
struct PlayedNode {
  std::uint32_t format = V4L2_PIX_FMT_YUYV;
  std::string card = "Depth Camera", bus = "usb-1";
  std::vector<std::array<std::uint32_t, 2>> sizes = {{640, 480}, {320, 240}};
  std::uint32_t capabilities = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
  std::uint32_t padding = 0;                ///< bytes behind each row
  std::map<unsigned long, int> fails = {};  ///< errno by request
  int open_error = 0;
  bool present = true, streaming = false;
  std::uint32_t width = 0, height = 0, step = 0;
  std::vector<std::vector<std::uint8_t>> memory = {};
  std::deque<std::uint32_t> queued = {};
  std::deque<v4l2_buffer> filled = {};

  /// The camera has made an image of one value.
  void image(double stamp_s, std::uint8_t value, std::uint32_t flags = 0) {
    if (queued.empty()) return;  // no buffer: it is lost
    v4l2_buffer buffer{};
    buffer.index = queued.front();
    queued.pop_front();
    std::vector<std::uint8_t>& data = memory.at(buffer.index);
    std::fill(data.begin(), data.end(), value);
    buffer.bytesused = static_cast<std::uint32_t>(data.size());
    buffer.flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | flags;
    buffer.timestamp.tv_sec = static_cast<long>(stamp_s);
    buffer.timestamp.tv_usec = static_cast<long>((stamp_s - static_cast<double>(buffer.timestamp.tv_sec)) * 1e6 + 0.5);
    filled.push_back(buffer);
  }
};

struct PlayedNodes {
  std::map<std::string, PlayedNode> by_path;
  int open_now = 0, mapped_now = 0;
};

/// The kernel with the nodes of a test.
class PlayedKernel final : public KernelCalls {
 public:
  explicit PlayedKernel(PlayedNodes& nodes) : nodes_(nodes) {}

  int open(const std::string& path) override {
    const auto node = nodes_.by_path.find(path);
    if (node == nodes_.by_path.end() || !node->second.present) return -ENOENT;
    if (node->second.open_error != 0) return -node->second.open_error;
    ++nodes_.open_now;
    open_[++last_fd_] = &node->second;
    return last_fd_;
  }
  void close(int fd) override {
    --nodes_.open_now;
    open_.erase(fd);
  }
  int ioctl(int fd, unsigned long request, void* argument) override {
    PlayedNode& node = *open_.at(fd);
    if (!node.present) return -ENODEV;
    if (const auto failure = node.fails.find(request); failure != node.fails.end()) return -failure->second;
    switch (request) {
      case VIDIOC_QUERYCAP:
        return query(node, *static_cast<v4l2_capability*>(argument));
      case VIDIOC_ENUM_FMT: {
        auto& format = *static_cast<v4l2_fmtdesc*>(argument);
        format.pixelformat = node.format;
        return format.index == 0 ? 0 : -EINVAL;
      }
      case VIDIOC_ENUM_FRAMESIZES:
        return size(node, *static_cast<v4l2_frmsizeenum*>(argument));
      case VIDIOC_ENUM_FRAMEINTERVALS: {
        auto& interval = *static_cast<v4l2_frmivalenum*>(argument);
        interval.type = V4L2_FRMIVAL_TYPE_DISCRETE;
        interval.discrete = {1, interval.index == 0 ? 30U : 15U};
        return interval.index < 2 ? 0 : -EINVAL;
      }
      case VIDIOC_S_FMT:
        return set(node, static_cast<v4l2_format*>(argument)->fmt.pix);
      case VIDIOC_REQBUFS:
        node.memory.assign(4, std::vector<std::uint8_t>(node.step * node.height));
        return 0;
      case VIDIOC_QUERYBUF: {
        auto& buffer = *static_cast<v4l2_buffer*>(argument);
        buffer.length = node.step * node.height;
        buffer.m.offset = buffer.index;
        return 0;
      }
      case VIDIOC_QBUF:
        node.queued.push_back(static_cast<v4l2_buffer*>(argument)->index);
        return 0;
      case VIDIOC_DQBUF:
        if (node.filled.empty()) return -EAGAIN;
        *static_cast<v4l2_buffer*>(argument) = node.filled.front();
        node.filled.pop_front();
        return 0;
      case VIDIOC_STREAMON:
        node.streaming = true;
        return 0;
      case VIDIOC_STREAMOFF:
        node.streaming = false;
        node.queued.clear(), node.filled.clear();
        return 0;
      default:
        return -EINVAL;
    }
  }
  std::uint8_t* map(int fd, std::size_t, std::int64_t offset) override {
    ++nodes_.mapped_now;
    return open_.at(fd)->memory.at(static_cast<std::size_t>(offset)).data();
  }
  void unmap(std::uint8_t*, std::size_t) override { --nodes_.mapped_now; }
  int wait_for_frame(const std::vector<int>& fds, std::chrono::milliseconds) override {
    for (std::size_t i = 0; i < fds.size(); ++i) {
      if (!open_.at(fds[i])->present) return -ENODEV;
      if (!open_.at(fds[i])->filled.empty()) return static_cast<int>(i);
    }
    return -ETIMEDOUT;
  }
  std::vector<std::string> video_nodes() override {
    std::vector<std::string> paths;
    for (const auto& [path, node] : nodes_.by_path) {
      if (node.present) paths.push_back(path);
    }
    return paths;
  }

 private:
  static int query(const PlayedNode& node, v4l2_capability& capability) {
    std::strncpy(reinterpret_cast<char*>(capability.card), node.card.c_str(), sizeof(capability.card) - 1);
    std::strncpy(reinterpret_cast<char*>(capability.bus_info), node.bus.c_str(), sizeof(capability.bus_info) - 1);
    capability.capabilities = V4L2_CAP_DEVICE_CAPS;
    capability.device_caps = node.capabilities;
    return 0;
  }
  static int size(const PlayedNode& node, v4l2_frmsizeenum& size) {
    if (size.index >= node.sizes.size()) return -EINVAL;
    size.type = V4L2_FRMSIZE_TYPE_DISCRETE;
    size.discrete = {node.sizes[size.index][0], node.sizes[size.index][1]};
    return 0;
  }
  static int set(PlayedNode& node, v4l2_pix_format& format) {
    node.width = format.width, node.height = format.height;
    node.step = format.bytesperline = 2 * format.width + node.padding;
    return 0;
  }

  PlayedNodes& nodes_;
  std::map<int, PlayedNode*> open_;
  int last_fd_ = 2;
};

}  // namespace rtd::camera::test
