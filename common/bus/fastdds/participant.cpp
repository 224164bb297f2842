// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/fastdds/participant.hpp"

#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastdds/rtps/transport/shared_mem/SharedMemTransportDescriptor.h>
#include <fastdds/dds/log/Log.hpp>
#include <fastdds/dds/log/StdoutErrConsumer.hpp>

namespace rtd::bus::fastdds {
namespace {

constexpr std::uint32_t kMib = 1024 * 1024;
constexpr std::uint32_t kMinSegmentMib = 8;  // below it one image does not fit and is repaired in 20 ms instead

/// Fast DDS logs to stdout by default, which belongs to our programs' results.
void log_to_stderr_once() {
  static std::once_flag once;
  std::call_once(once, [] {
    dds::Log::ClearConsumers();
    dds::Log::RegisterConsumer(std::make_unique<dds::StdoutErrConsumer>());
    dds::Log::SetVerbosity(dds::Log::Kind::Error);
  });
}

std::shared_ptr<eprosima::fastdds::rtps::SharedMemTransportDescriptor> shared_memory_transport(
    const BusOptions& options) {
  auto transport = std::make_shared<eprosima::fastdds::rtps::SharedMemTransportDescriptor>();
  transport->segment_size(options.shm_segment_mib * kMib);
  transport->max_message_size(options.shm_segment_mib * kMib);
  return transport;
}

std::shared_ptr<eprosima::fastdds::rtps::UDPv4TransportDescriptor> udp_transport(const BusOptions& options,
                                                                                 const HostLimits& limits) {
  auto transport = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
  transport->receiveBufferSize = socket_buffer_bytes(options.socket_buffer_kib, limits.rmem_max);
  transport->sendBufferSize = socket_buffer_bytes(options.socket_buffer_kib, limits.wmem_max);
  if (options.loopback_only) transport->interfaceWhiteList.emplace_back("127.0.0.1");
  return transport;
}

dds::DomainParticipantQos participant_qos(const BusOptions& options, const HostLimits& limits) {
  dds::DomainParticipantQos qos;
  qos.name(options.participant_name.empty() ? "rtd" : options.participant_name.c_str());
  qos.transport().use_builtin_transports = false;
  qos.transport().user_transports = {shared_memory_transport(options), udp_transport(options, limits)};
  // A killed process is forgotten after the lease; its heartbeat topic tells much earlier.
  auto& discovery = qos.wire_protocol().builtin.discovery_config;
  discovery.leaseDuration = {5, 0};
  discovery.leaseDuration_announcementperiod = {1, 0};
  return qos;
}

}  // namespace

Participant::Participant(const BusOptions& options, const HostLimits& limits) {
  if (options.shm_segment_mib < kMinSegmentMib || options.shm_segment_mib > 1024) {
    throw BusError("shared-memory segment of " + std::to_string(options.shm_segment_mib) +
                   " MiB, allowed: " + std::to_string(kMinSegmentMib) + "..1024");
  }
  log_to_stderr_once();
  factory_ = dds::DomainParticipantFactory::get_shared_instance();
  participant_ = factory_->create_participant(options.domain, participant_qos(options, limits));
  if (participant_ == nullptr) {
    throw BusError("Fast DDS refused to join domain " + std::to_string(options.domain) +
                   "; is the loopback interface up and are fewer than 60 participants in this domain?");
  }
  publisher_ = participant_->create_publisher(dds::PUBLISHER_QOS_DEFAULT);
  subscriber_ = participant_->create_subscriber(dds::SUBSCRIBER_QOS_DEFAULT);
}

Participant::~Participant() {
  if (participant_ == nullptr) return;
  participant_->delete_contained_entities();
  factory_->delete_participant(participant_);
}

dds::Topic* Participant::topic(const std::string& name, const Codec& codec) {
  const std::lock_guard lock(topics_mutex_);
  const dds::TypeSupport type = codec.create_type();
  if (auto* known = static_cast<dds::Topic*>(participant_->lookup_topicdescription(name))) {
    if (known->get_type_name() == type.get_type_name()) return known;
    throw BusError("topic " + name + " has type " + known->get_type_name() + ", not " + type.get_type_name());
  }
  type.register_type(participant_);
  dds::Topic* topic = participant_->create_topic(name, type.get_type_name(), dds::TOPIC_QOS_DEFAULT);
  if (topic == nullptr) throw BusError("Fast DDS refused topic " + name + " of type " + type.get_type_name());
  return topic;
}

}  // namespace rtd::bus::fastdds
