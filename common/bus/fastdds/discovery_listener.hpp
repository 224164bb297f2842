// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <stop_token>
#include <thread>

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>

#include "common/bus/discovery.hpp"
#include "common/bus/fastdds/participant_security.hpp"

namespace rtd::bus::fastdds {

/// Announces our participant again to others that have just appeared. Fast DDS 2.9 answers a new participant's first
/// announcement once, but it announces itself some milliseconds before it can receive: an answer that comes too early
/// is lost, and the two match only at our next periodic announcement, half a second later. Thread-safe.
class Reannouncer {
 public:
  ~Reannouncer() { stop(); }
  void start(eprosima::fastdds::dds::DomainParticipant& participant);
  /// Afterwards the participant is not touched. To be called before it is deleted.
  void stop();
  /// A participant has appeared.
  void announce_again();

 private:
  void loop(eprosima::fastdds::dds::DomainParticipant& participant);

  std::mutex mutex_;
  std::condition_variable changed_;
  std::uint64_t appeared_ = 0;
  bool ended_ = false;
  std::thread thread_;
};

/// Calls BusOptions::on_problem when the Discovery Server does not answer within kServerPatience: without it no
/// participant is found, and Fast DDS continues asking without a message. Thread-safe.
class ServerWatch {
 public:
  ~ServerWatch() { stop(); }
  /// Does nothing without a server in the options.
  void start(const BusOptions& options);
  void stop();
  void appeared(const eprosima::fastrtps::rtps::GuidPrefix_t& participant);

 private:
  std::stop_source settled_;  ///< found, or to be stopped
  std::thread thread_;
};

/// Receives what Fast DDS discovers of the other participants of a domain and of their endpoints.
class DiscoveryListener : public eprosima::fastdds::dds::DomainParticipantListener {
 public:
  /// `registry`, if any, gets all endpoints and participants.
  DiscoveryListener(const BusOptions& options, EndpointRegistry* registry);
  void start(eprosima::fastdds::dds::DomainParticipant& participant, const BusOptions& options);
  void stop();
  TopicTypes& types() { return types_; }

 private:
  using Participant = eprosima::fastdds::dds::DomainParticipant;
  void note(const eprosima::fastrtps::rtps::ParticipantDiscoveryInfo& info);
  void on_participant_discovery(Participant*, eprosima::fastrtps::rtps::ParticipantDiscoveryInfo&& info) override;
  void onParticipantAuthentication(Participant*,
                                   eprosima::fastrtps::rtps::ParticipantAuthenticationInfo&& info) override;
  void on_publisher_discovery(Participant* participant, eprosima::fastrtps::rtps::WriterDiscoveryInfo&& info) override;
  void on_subscriber_discovery(Participant* participant, eprosima::fastrtps::rtps::ReaderDiscoveryInfo&& info) override;

  EndpointRegistry* const registry_;
  std::unique_ptr<SecurityWatch> security_;
  Reannouncer reannouncer_;
  ServerWatch server_;
  TopicTypes types_;
};

}  // namespace rtd::bus::fastdds
