// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/cyclonedds/sample_limits.hpp"

#include <dlfcn.h>
#include <pthread.h>
#include <sys/socket.h>

#include <algorithm>
#include <bit>
#include <string_view>

#include "common/bus/fastdds/screening/rtps_screen.hpp"

namespace rtd::bus::cyclonedds {

SampleLimits& SampleLimits::of_process() {
  static SampleLimits limits;
  return limits;
}

void SampleLimits::note(const void* reader, const std::set<WriterId>& writers, std::size_t largest) {
  const std::lock_guard lock(mutex_);
  for (auto& [writer, readers] : largest_)
    if (!writers.contains(writer)) readers.erase(reader);
  std::erase_if(largest_, [](const auto& entry) { return entry.second.empty(); });
  for (const WriterId& writer : writers) largest_[writer][reader] = largest;
}

std::optional<std::size_t> SampleLimits::of(const WriterId& writer) const {
  const std::lock_guard lock(mutex_);
  const auto found = largest_.find(writer);
  if (found == largest_.end()) return std::nullopt;
  return std::ranges::max_element(found->second, {}, [](const auto& entry) { return entry.second; })->second;
}

void SampleLimits::mark_too_large(std::span<std::byte> datagram) const {
  for (const SampleFragments& fragments : read_rtps_message(datagram).fragments) {
    constexpr std::byte kPad{1};
    const auto largest = of(std::bit_cast<WriterId>(fragments.writer));
    if (!largest || fragments.sample_bytes <= *largest) continue;
    const auto submessage = datagram.subspan(fragments.at);
    if (fragments.first_fragment == 1)
      std::ranges::fill(submessage.subspan(SampleFragments::kSizeBehind, 4), std::byte{0xff});
    else
      submessage[0] = kPad;
  }
}

}  // namespace rtd::bus::cyclonedds

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
namespace {

/// By the names that Cyclone gives its threads.
bool receives_for_cyclone() {
  static thread_local const bool receives = [] {
    char name[16] = {};
    pthread_getname_np(pthread_self(), name, sizeof(name));
    return std::string_view(name).starts_with("recv");
  }();
  return receives;
}

}  // namespace

/// Stands before the function of the C library.
extern "C" ssize_t recvmsg(int socket, msghdr* message, int flags) {
  static const auto original = reinterpret_cast<ssize_t (*)(int, msghdr*, int)>(dlsym(RTLD_NEXT, "recvmsg"));
  const ssize_t received = original(socket, message, flags);
  if (received > 0 && message->msg_iovlen == 1 && receives_for_cyclone()) {
    const std::span buffer(static_cast<std::byte*>(message->msg_iov->iov_base), message->msg_iov->iov_len);
    const auto size = std::min(buffer.size(), static_cast<std::size_t>(received));
    rtd::bus::cyclonedds::SampleLimits::of_process().mark_too_large(buffer.first(size));
  }
  return received;
}
#endif
