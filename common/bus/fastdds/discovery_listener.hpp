// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <thread>

#include <fastdds/dds/domain/DomainParticipant.hpp>

namespace rtd::bus::fastdds {

/// Introduces us again to whoever has just appeared. Fast DDS 2.9 answers a newcomer's first announcement once, but a
/// newcomer announces itself some milliseconds before it listens: an answer that comes too early is lost, and the two
/// meet only at our next periodic announcement, half a second later. Thread-safe.
class Greeter {
 public:
  ~Greeter() { stop(); }
  void start(eprosima::fastdds::dds::DomainParticipant& participant);
  /// Afterwards the participant is not touched. To be called before it is deleted.
  void stop();
  /// Somebody has appeared.
  void greet();

 private:
  void loop(eprosima::fastdds::dds::DomainParticipant& participant);

  std::mutex mutex_;
  std::condition_variable changed_;
  std::uint64_t newcomers_ = 0;
  bool ended_ = false;
  std::thread thread_;
};

}  // namespace rtd::bus::fastdds
