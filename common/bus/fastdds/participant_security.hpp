// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>
#include <map>
#include <mutex>
#include <string>

#include "common/bus/bus_factory.hpp"

namespace rtd::bus::fastdds {

/// The enclave's files as Fast DDS's built-in plugins want them. No change without security.
void map_security(const SecurityOptions& security, eprosima::fastdds::dds::DomainParticipantQos& qos);

/// Leaves the shared memory that this process uses to its user. Fast DDS lets every user of the host read it, and the
/// raw frames in it are not encrypted.
void hide_shared_memory();

/// Tells BusOptions::on_problem, once each, of participants that a secured one cannot meet. Passes all that it hears on
/// to `next`.
class SecurityWatch : public eprosima::fastdds::dds::DomainParticipantListener {
 public:
  SecurityWatch(const BusOptions& options, eprosima::fastdds::dds::DomainParticipantListener* next);

 private:
  using Participant = eprosima::fastdds::dds::DomainParticipant;
  void on_participant_discovery(Participant*, eprosima::fastrtps::rtps::ParticipantDiscoveryInfo&& info) override;
  void onParticipantAuthentication(Participant*,
                                   eprosima::fastrtps::rtps::ParticipantAuthenticationInfo&& info) override;
  void on_publisher_discovery(Participant* participant, eprosima::fastrtps::rtps::WriterDiscoveryInfo&& info) override;

  void on_subscriber_discovery(Participant* participant, eprosima::fastrtps::rtps::ReaderDiscoveryInfo&& info) override;
  void look_at(const eprosima::fastrtps::rtps::ParticipantDiscoveryInfo& info);

  const std::uint32_t domain_;
  const std::function<void(const std::string&)> on_problem_;
  eprosima::fastdds::dds::DomainParticipantListener* const next_;
  std::mutex mutex_;
  std::map<eprosima::fastrtps::rtps::GuidPrefix_t, std::string> names_;  ///< of those not told of yet; else empty
};

}  // namespace rtd::bus::fastdds
