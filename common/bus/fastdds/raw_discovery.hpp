// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <map>
#include <mutex>
#include <optional>

#include "common/bus/callback_thread.hpp"
#include "common/bus/raw_bus.hpp"

namespace rtd::bus::fastdds {

/// Keeps the list of a domain's writers. Fast DDS's discovery thread only takes notes; the watcher has a thread of its
/// own, so that it may create readers.
class RawDiscovery : public eprosima::fastdds::dds::DomainParticipantListener {
 public:
  std::vector<TopicWriter> writers() const;
  void watch(RawBus::Watcher watcher);

 private:
  void on_publisher_discovery(eprosima::fastdds::dds::DomainParticipant* participant,
                              eprosima::fastrtps::rtps::WriterDiscoveryInfo&& info) override;
  std::optional<WriterChange> note(const TopicWriter& writer, bool gone);

  mutable std::mutex mutex_;
  std::map<WriterId, TopicWriter> writers_;
  RawBus::Watcher watcher_;
  std::optional<CallbackThread> thread_;
};

}  // namespace rtd::bus::fastdds
