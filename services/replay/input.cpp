// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/replay/input.hpp"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <utility>

namespace rtd::replay {
namespace {

bool in_foreground() {
  return isatty(STDIN_FILENO) == 1 && tcgetpgrp(STDIN_FILENO) == getpgrp();
}

}  // namespace

Keyboard::Keyboard(std::function<void(Command)> on_command) : on_command_(std::move(on_command)) {
  if (!in_foreground() || tcgetattr(STDIN_FILENO, &before_) != 0) return;
  termios raw = before_;
  raw.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);  // Ctrl-C stays a signal
  raw.c_cc[VMIN] = 1;
  raw.c_cc[VTIME] = 0;
  wake_fd_ = eventfd(0, EFD_CLOEXEC);
  if (wake_fd_ < 0 || tcsetattr(STDIN_FILENO, TCSANOW, &raw) != 0) return;
  thread_ = std::thread([this] { listen(); });
}

Keyboard::~Keyboard() {
  if (thread_.joinable()) {
    const std::uint64_t wake = 1;
    (void)!write(wake_fd_, &wake, sizeof(wake));
    thread_.join();
    tcsetattr(STDIN_FILENO, TCSANOW, &before_);
  }
  if (wake_fd_ >= 0) close(wake_fd_);
}

void Keyboard::listen() {
  KeyCommands keys;
  std::array<pollfd, 2> waiting{pollfd{STDIN_FILENO, POLLIN, 0}, pollfd{wake_fd_, POLLIN, 0}};
  while (true) {
    const int ready = poll(waiting.data(), waiting.size(), -1);
    if (ready < 0 && errno == EINTR) continue;
    if (ready < 0 || waiting[1].revents != 0 || (waiting[0].revents & POLLIN) == 0) return;
    std::array<char, 64> bytes{};
    const ssize_t count = read(STDIN_FILENO, bytes.data(), bytes.size());
    if (count <= 0) return;
    for (ssize_t i = 0; i < count; ++i)
      if (const std::optional<Command> command = keys.next(bytes[static_cast<std::size_t>(i)])) on_command_(*command);
  }
}

}  // namespace rtd::replay
