// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fastdds/dds/domain/DomainParticipantListener.hpp>

#include "common/bus/fastdds/greeter.hpp"
#include "common/bus/fastdds/server_watch.hpp"
#include "common/bus/topic_types.hpp"

namespace rtd::bus::fastdds {

/// Hears of the other participants of a domain and of their endpoints.
class ParticipantWatch : public eprosima::fastdds::dds::DomainParticipantListener {
 public:
  /// `next`, if any, hears all of it too.
  explicit ParticipantWatch(eprosima::fastdds::dds::DomainParticipantListener* next) : next_(next) {}
  Greeter& greeter() { return greeter_; }
  ServerWatch& server() { return server_; }
  TopicTypes& types() { return types_; }

 private:
  using Participant = eprosima::fastdds::dds::DomainParticipant;
  void on_participant_discovery(Participant* participant,
                                eprosima::fastrtps::rtps::ParticipantDiscoveryInfo&& info) override;
  void on_publisher_discovery(Participant* participant, eprosima::fastrtps::rtps::WriterDiscoveryInfo&& info) override;
  void on_subscriber_discovery(Participant* participant, eprosima::fastrtps::rtps::ReaderDiscoveryInfo&& info) override;

  eprosima::fastdds::dds::DomainParticipantListener* const next_;
  Greeter greeter_;
  ServerWatch server_;
  TopicTypes types_;
};

}  // namespace rtd::bus::fastdds
