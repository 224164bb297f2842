// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/component/security/endpoint_census.hpp"

#include <fastdds/rtps/participant/ParticipantDiscoveryInfo.h>
#include <fastdds/rtps/reader/ReaderDiscoveryInfo.h>
#include <fastdds/rtps/writer/WriterDiscoveryInfo.h>

namespace rtd::bus {

namespace rtps = eprosima::fastrtps::rtps;

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

void EndpointCensus::on_participant_discovery(fastdds::dds::DomainParticipant*, rtps::ParticipantDiscoveryInfo&& info) {
  const std::lock_guard lock(mutex_);
  names_.try_emplace(info.info.m_guid.guidPrefix, info.info.m_participantName.c_str());
}

void EndpointCensus::on_publisher_discovery(fastdds::dds::DomainParticipant*, rtps::WriterDiscoveryInfo&& info) {
  const std::lock_guard lock(mutex_);
  topics_[info.info.guid().guidPrefix].writes.insert(info.info.topicName().c_str());
}

void EndpointCensus::on_subscriber_discovery(fastdds::dds::DomainParticipant*, rtps::ReaderDiscoveryInfo&& info) {
  const std::lock_guard lock(mutex_);
  topics_[info.info.guid().guidPrefix].reads.insert(info.info.topicName().c_str());
}

}  // namespace rtd::bus
