// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <memory>
#include <mutex>
#include <string>

#include "common/bus/fastdds/codec.hpp"
#include "common/bus/fastdds/participant_security.hpp"
#include "common/bus/fastdds/participant_watch.hpp"
#include "common/bus/host/host_checks.hpp"

namespace rtd::bus::fastdds {

namespace dds = eprosima::fastdds::dds;

/// Our presence in a domain: transports, publisher, subscriber and topics. Thread-safe.
class Participant {
 public:
  /// Throws BusError when Fast DDS refuses.
  /// `listener`, if any, hears of other participants' endpoints from the first one on.
  Participant(const BusOptions& options, const HostLimits& limits, dds::DomainParticipantListener* listener = nullptr);
  ~Participant();
  Participant(const Participant&) = delete;
  Participant& operator=(const Participant&) = delete;

  /// Who writes or reads the topic of that name: stays_on_host() decides.
  dds::Publisher& publisher(const std::string& topic);
  dds::Subscriber& subscriber(const std::string& topic);
  /// The topic of that name, created when new; lives as long as the participant.
  /// Throws BusError when it exists with another type.
  dds::Topic* topic(const std::string& name, const Codec& codec);
  /// Tells endpoints of ours when somebody uses the topic's name with another type.
  TopicTypes& types() { return watch_.types(); }
  /// No listener is called any more.
  void silence() { participant_->set_listener(nullptr); }
  /// To be called when a writer has been created: secured, its shared memory is for our user only.
  void writer_created() {
    if (security_) hide_shared_memory();
  }
  const dds::DomainParticipant& vendor() const { return *participant_; }

 private:
  void create_publishers(const NetworkOptions& network);

  ParticipantWatch watch_;
  std::shared_ptr<dds::DomainParticipantFactory> factory_;  // keeps the vendor's singleton alive
  std::unique_ptr<SecurityWatch> security_;                 // outlives the participant, which calls it
  dds::DomainParticipant* participant_ = nullptr;
  dds::Publisher *publisher_ = nullptr, *host_publisher_ = nullptr;
  dds::Subscriber *subscriber_ = nullptr, *host_subscriber_ = nullptr;
  std::mutex topics_mutex_;
};

}  // namespace rtd::bus::fastdds
