// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/process/notify_socket.hpp"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <system_error>

namespace rtd::process {
namespace {

void check(bool good) {
  if (!good) throw ProcessError("no socket for signs of life: " + std::generic_category().message(errno));
}

/// Set for each child, or meant for this process only.
bool replaced(std::string_view variable) {
  return std::ranges::any_of(std::array{"NOTIFY_SOCKET=", "WATCHDOG_USEC=", "WATCHDOG_PID="},
                             [&](const char* name) { return variable.starts_with(name); });
}

/// The sender that the kernel names; 0 when it names none.
ProcessId sender_of(const msghdr& message) {
  for (cmsghdr* part = CMSG_FIRSTHDR(&message); part != nullptr;
       part = CMSG_NXTHDR(const_cast<msghdr*>(&message), part)) {
    if (part->cmsg_level != SOL_SOCKET || part->cmsg_type != SCM_CREDENTIALS) continue;
    ucred sender{};
    std::memcpy(&sender, CMSG_DATA(part), sizeof(sender));
    return sender.pid;
  }
  return 0;
}

}  // namespace

NotifySocket::NotifySocket() : fd_(socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)) {
  check(fd_ >= 0);
  const int on = 1;
  check(setsockopt(fd_, SOL_SOCKET, SO_PASSCRED, &on, sizeof(on)) == 0);
  const sa_family_t any_name = AF_UNIX;  // the kernel chooses an abstract one, which leaves no file
  check(bind(fd_, reinterpret_cast<const sockaddr*>(&any_name), sizeof(any_name)) == 0);
}

NotifySocket::~NotifySocket() {
  close(fd_);
}

std::vector<std::string> NotifySocket::environment(std::chrono::microseconds longest_silence) const {
  std::vector<std::string> variables;
  for (char** variable = environ; *variable != nullptr; ++variable) {
    if (!replaced(*variable)) variables.emplace_back(*variable);
  }
  sockaddr_un address{};
  socklen_t length = sizeof(address);
  check(getsockname(fd_, reinterpret_cast<sockaddr*>(&address), &length) == 0);
  const std::string name(address.sun_path + 1, length - offsetof(sockaddr_un, sun_path) - 1);
  variables.push_back("NOTIFY_SOCKET=@" + name);
  variables.push_back("WATCHDOG_USEC=" + std::to_string(longest_silence.count()));
  return variables;
}

void NotifySocket::read(const std::function<void(ProcessId, std::string_view)>& on_message) const {
  std::array<char, 512> text{};
  alignas(cmsghdr) std::array<char, 256> extra{};
  for (;;) {
    iovec bytes{text.data(), text.size()};
    msghdr message{};
    message.msg_iov = &bytes;
    message.msg_iovlen = 1;
    message.msg_control = extra.data();
    message.msg_controllen = extra.size();
    const ssize_t got = recvmsg(fd_, &message, MSG_CMSG_CLOEXEC);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return;
    on_message(sender_of(message), {text.data(), static_cast<std::size_t>(got)});
  }
}

}  // namespace rtd::process
