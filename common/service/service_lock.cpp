// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/service_lock.hpp"

#include <fmt/format.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <thread>

#include "common/service/log.hpp"

namespace rtd::service {
namespace {

struct Address {
  sockaddr_un name{};
  socklen_t length = 0;
};

/// "\0rtd-slam/USER/DOMAIN/ROBOT/SERVICE"
Address address_of(const ServicePlace& place) {
  std::string text = fmt::format("rtd-slam/{}/{}/{}/{}", getuid(), place.domain, place.robot, place.service);
  if (place.own_process_only) text += fmt::format("/{}", getpid());
  Address address;
  address.name.sun_family = AF_UNIX;
  const std::size_t length = std::min(text.size(), sizeof(address.name.sun_path) - 1);
  std::copy_n(text.begin(), length, address.name.sun_path + 1);
  address.length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + length);
  return address;
}

int open_socket() {
  return socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
}

const sockaddr* raw(const Address& address) {
  return reinterpret_cast<const sockaddr*>(&address.name);
}

/// Who holds the place; pid 0 when no process answers.
ucred holder_of(const Address& address) {
  ucred holder{};
  socklen_t length = sizeof(holder);
  const int asking = open_socket();
  const bool known = connect(asking, raw(address), address.length) == 0 &&
                     getsockopt(asking, SOL_SOCKET, SO_PEERCRED, &holder, &length) == 0;
  close(asking);
  return known ? holder : ucred{};
}

std::string text_for(const ServicePlace& place, std::int64_t pid) {
  if (place.robot.empty()) {
    return fmt::format(
        "another {} (pid {}) already runs in DDS domain {}: stop it first or choose another domain with --domain",
        place.service, pid, place.domain);
  }
  return fmt::format(
      "robot '{}' already has a {} (pid {}) in DDS domain {}: stop it first or give this robot another name with "
      "--robot",
      place.robot, place.service, pid, place.domain);
}

}  // namespace

ServiceLock::ServiceLock(const ServicePlace& place, std::chrono::milliseconds patience) {
  constexpr std::chrono::milliseconds kPause{20};
  const Address address = address_of(place);
  socket_ = open_socket();
  const auto take = [&] { return bind(socket_, raw(address), address.length) == 0 && listen(socket_, 1) == 0; };
  for (auto waited = std::chrono::milliseconds(0); !take(); waited += kPause) {
    if (errno != EADDRINUSE) {
      SPDLOG_WARN("event=no_service_lock errno={} effect=\"a second {} is not noticed\"", errno, place.service);
      return;
    }
    if (waited < patience) {
      std::this_thread::sleep_for(kPause);
      continue;
    }
    const ucred holder = holder_of(address);
    if (holder.pid == 0 || holder.uid == getuid()) {
      close(socket_);
      throw AlreadyRuns(text_for(place, holder.pid));
    }
    SPDLOG_ERROR("event=no_service_lock held_by_user={} held_by_pid={} effect=\"a second {} is not noticed\"",
                 holder.uid, holder.pid, place.service);
    return;
  }
}

ServiceLock::~ServiceLock() {
  if (socket_ >= 0) close(socket_);
}

}  // namespace rtd::service
