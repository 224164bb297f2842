// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/fastdds/participant_watch.hpp"

#include <sstream>
#include <utility>

#include <fastdds/dds/domain/DomainParticipant.hpp>

namespace rtd::bus::fastdds {
namespace {

namespace rtps = eprosima::fastrtps::rtps;

/// `Info`: of a writer or of a reader.
template <class Info>
void note_type(const eprosima::fastdds::dds::DomainParticipant& participant, const Info& info, bool gone,
               TopicTypes& types) {
  if (info.guid().guidPrefix == participant.guid().guidPrefix) return;  // our own
  std::ostringstream id;
  id << info.guid();
  if (gone) {
    types.gone(id.str());
  } else {
    types.appeared(id.str(), info.topicName().to_string(), info.typeName().to_string());
  }
}

}  // namespace

void ParticipantWatch::on_participant_discovery(Participant* participant, rtps::ParticipantDiscoveryInfo&& info) {
  if (info.status == rtps::ParticipantDiscoveryInfo::DISCOVERED_PARTICIPANT) {
    greeter_.greet();
    server_.heard(info.info.m_guid.guidPrefix);
  }
  if (next_ != nullptr) next_->on_participant_discovery(participant, std::move(info));
}

void ParticipantWatch::on_publisher_discovery(Participant* participant, rtps::WriterDiscoveryInfo&& info) {
  note_type(*participant, info.info, info.status == rtps::WriterDiscoveryInfo::REMOVED_WRITER, types_);
  if (next_ != nullptr) next_->on_publisher_discovery(participant, std::move(info));
}

void ParticipantWatch::on_subscriber_discovery(Participant* participant, rtps::ReaderDiscoveryInfo&& info) {
  note_type(*participant, info.info, info.status == rtps::ReaderDiscoveryInfo::REMOVED_READER, types_);
  if (next_ != nullptr) next_->on_subscriber_discovery(participant, std::move(info));
}

}  // namespace rtd::bus::fastdds
