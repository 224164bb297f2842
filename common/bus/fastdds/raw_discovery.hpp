// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fastdds/dds/domain/DomainParticipantListener.hpp>

#include "common/bus/writer_registry.hpp"

namespace rtd::bus::fastdds {

/// Keeps the list of a domain's writers.
class RawDiscovery : public eprosima::fastdds::dds::DomainParticipantListener {
 public:
  std::vector<TopicWriter> writers() const { return registry_.writers(); }
  void watch(RawBus::Watcher watcher) { registry_.watch(std::move(watcher)); }

  void on_publisher_discovery(eprosima::fastdds::dds::DomainParticipant* participant,
                              eprosima::fastrtps::rtps::WriterDiscoveryInfo&& info) override;

 private:
  WriterRegistry registry_;
};

}  // namespace rtd::bus::fastdds
