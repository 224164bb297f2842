// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/devices/kernel_calls.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>

namespace rtd::camera {
namespace {

class LinuxCalls final : public KernelCalls {
 public:
  int open(const std::string& path) override {
    const int fd = ::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
    return fd >= 0 ? fd : -errno;
  }
  void close(int fd) override { ::close(fd); }
  int ioctl(int fd, unsigned long request, void* argument) override {
    int result = 0;
    do result = ::ioctl(fd, request, argument);
    while (result < 0 && errno == EINTR);
    return result >= 0 ? result : -errno;
  }
  std::uint8_t* map(int fd, std::size_t bytes, std::int64_t offset) override {
    void* const data = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, fd, offset);
    return data == MAP_FAILED ? nullptr : static_cast<std::uint8_t*>(data);
  }
  void unmap(std::uint8_t* data, std::size_t bytes) override { munmap(data, bytes); }
  int wait_for_frame(const std::vector<int>& fds, std::chrono::milliseconds timeout) override {
    std::vector<pollfd> polled;
    for (const int fd : fds) polled.push_back({fd, POLLIN, 0});
    const int ready = poll(polled.data(), polled.size(), static_cast<int>(timeout.count()));
    if (ready < 0 && errno != EINTR) return -errno;
    ++turn_;  // each begins in turn: a fast stream must not hide a slow one
    for (std::size_t i = 0; ready > 0 && i < polled.size(); ++i) {
      const std::size_t at = (i + turn_) % polled.size();
      if ((polled[at].revents & (POLLERR | POLLHUP | POLLNVAL)) != 0) return -ENODEV;
      if ((polled[at].revents & POLLIN) != 0) return static_cast<int>(at);
    }
    return -ETIMEDOUT;
  }
  std::vector<std::string> video_nodes() override {
    std::vector<std::string> nodes;
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator("/dev", error)) {
      const std::string name = entry.path().string();
      if (name.starts_with("/dev/video")) nodes.push_back(name);
    }
    std::ranges::sort(nodes);
    return nodes;
  }

 private:
  std::size_t turn_ = 0;
};

}  // namespace

std::unique_ptr<KernelCalls> linux_calls() {
  return std::make_unique<LinuxCalls>();
}

}  // namespace rtd::camera
