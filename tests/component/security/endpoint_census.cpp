// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/component/security/endpoint_census.hpp"

namespace rtd::bus {

BusOptions EndpointCensus::options(std::uint32_t domain) {
  BusOptions options;
  options.domain = domain;
  options.participant_name = "census";
  return options;
}

std::map<std::string, EndpointCensus::Topics> EndpointCensus::by_participant() const {
  const std::lock_guard lock(mutex_);
  std::map<std::string, Topics> all;
  for (const auto& [guid, topics] : topics_) {
    const auto name = names_.find(guid);
    if (name == names_.end()) continue;
    all[name->second].writes.insert(topics.writes.begin(), topics.writes.end());
    all[name->second].reads.insert(topics.reads.begin(), topics.reads.end());
  }
  return all;
}

void EndpointCensus::found(const fastdds::FoundParticipant& participant) {
  const std::lock_guard lock(mutex_);
  names_.try_emplace(participant.id, participant.name);
}

void EndpointCensus::found(const TopicWriter& writer, bool /*gone*/) {
  const std::lock_guard lock(mutex_);
  topics_[participant_of(writer.id)].writes.insert(writer.topic.name);
}

void EndpointCensus::found(const TopicReader& reader, bool /*gone*/) {
  const std::lock_guard lock(mutex_);
  topics_[participant_of(reader.id)].reads.insert(reader.topic.name);
}

}  // namespace rtd::bus
