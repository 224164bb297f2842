// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace rtd::camera {

/// The calls of the kernel that a V4L2 camera needs, so that a test can be the kernel. Like those of <unistd.h>, but
/// errors are -errno. One thread uses it.
class KernelCalls {
 public:
  virtual ~KernelCalls() = default;
  /// A descriptor, for reading and writing without blocking.
  virtual int open(const std::string& path) = 0;
  virtual void close(int fd) = 0;
  /// Repeated when a signal interrupts it.
  virtual int ioctl(int fd, unsigned long request, void* argument) = 0;
  /// Null on error.
  virtual std::uint8_t* map(int fd, std::size_t bytes, std::int64_t offset) = 0;
  virtual void unmap(std::uint8_t* data, std::size_t bytes) = 0;
  /// Waits until a frame is ready on one of them: its index; -ETIMEDOUT, -ENODEV when one is gone.
  virtual int wait_for_frame(const std::vector<int>& fds, std::chrono::milliseconds timeout) = 0;
  /// "/dev/video0", ...: all nodes.
  virtual std::vector<std::string> video_nodes() = 0;
};

/// Those of Linux.
std::unique_ptr<KernelCalls> linux_calls();

}  // namespace rtd::camera
