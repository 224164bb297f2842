// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <mutex>
#include <set>
#include <string>

#include "common/bus/fastdds/participant.hpp"

namespace rtd::bus {

/// Who opens which writers and readers in a domain, by participant name: "rtd-slam" writes "rtd/tracking".
class EndpointCensus : private fastdds::DiscoveryAdapter {
 public:
  explicit EndpointCensus(std::uint32_t domain) : participant_(options(domain), read_host_limits(), &writers_) {
    participant_.observe(*this);
  }
  ~EndpointCensus() override { participant_.silence(); }

  struct Topics {
    std::set<std::string> writes, reads;
  };
  std::map<std::string, Topics> by_participant() const;

 private:
  static BusOptions options(std::uint32_t domain);
  void found(const fastdds::FoundParticipant& participant) override;
  void found(const TopicWriter& writer, bool gone) override;
  void found(const TopicReader& reader, bool gone) override;

  mutable std::mutex mutex_;
  std::map<ParticipantId, std::string> names_;
  std::map<ParticipantId, Topics> topics_;
  EndpointRegistry writers_;          // with it, everything is discovered
  fastdds::Participant participant_;  // last: calls the others
};

}  // namespace rtd::bus
