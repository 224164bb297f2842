// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/fastdds/greeter.hpp"

#include <chrono>
#include <string>

namespace rtd::bus::fastdds {
namespace {

namespace dds = eprosima::fastdds::dds;

/// After the newcomer was seen; the second one is for a busy host.
constexpr std::chrono::milliseconds kDelays[] = {std::chrono::milliseconds(30), std::chrono::milliseconds(80)};

/// A participant announces itself at once when its user data changes. Keys that a reader does not know mean nothing to
/// it, in ROS 2 neither.
void announce(dds::DomainParticipant& participant, std::uint64_t count) {
  dds::DomainParticipantQos qos = participant.get_qos();
  const auto& before = qos.user_data().getValue();
  std::string text(before.begin(), before.end());
  text = text.substr(0, text.find("greeting=")) + "greeting=" + std::to_string(count) + ';';
  qos.user_data().setValue({text.begin(), text.end()});
  participant.set_qos(qos);
}

}  // namespace

void Greeter::start(dds::DomainParticipant& participant) {
  thread_ = std::thread([this, &participant] { loop(participant); });
}

void Greeter::stop() {
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void Greeter::greet() {
  {
    const std::lock_guard lock(mutex_);
    ++newcomers_;
  }
  changed_.notify_all();
}

void Greeter::loop(dds::DomainParticipant& participant) {
  std::unique_lock lock(mutex_);
  std::uint64_t greeted = 0, announcements = 0;
  const auto ended = [this] { return ended_; };
  while (true) {
    changed_.wait(lock, [&] { return ended_ || newcomers_ > greeted; });
    greeted = newcomers_;
    for (const auto delay : kDelays) {
      if (changed_.wait_for(lock, delay, ended)) return;
      lock.unlock();
      announce(participant, ++announcements);
      lock.lock();
    }
  }
}

}  // namespace rtd::bus::fastdds
