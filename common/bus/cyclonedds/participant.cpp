// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/cyclonedds/participant.hpp"

#include <algorithm>

#include "common/bus/cyclonedds/participant_security.hpp"
#include "common/bus/cyclonedds/vendor_log.hpp"
#include "common/bus/network.hpp"

namespace rtd::bus::cyclonedds {
namespace {

Entity create_participant(const BusOptions& options) {
  const Qos qos(dds_create_qos());
  dds_qset_entity_name(qos.get(), options.participant_name.empty() ? "rtd" : options.participant_name.c_str());
  map_security(options.security, qos);
  const LogCapture log;
  const dds_entity_t handle = dds_create_participant(options.domain, qos.get(), nullptr);
  if (handle < 0) {
    throw BusError("Cyclone DDS refused a participant in domain " + std::to_string(options.domain) + " (" +
                   dds_strretcode(handle) + ")" + log.reason());
  }
  return Entity(handle);
}

}  // namespace

WriterId guid_of(dds_entity_t entity) {
  WriterId id{};
  dds_guid_t guid{};
  if (dds_get_guid(entity, &guid) == DDS_RETCODE_OK) std::copy_n(guid.v, id.size(), id.begin());
  return id;
}

Participant::Participant(const BusOptions& options)
    : strangers_(StrangerWatch::start(options)),
      domain_(join_domain(options)),
      participant_(create_participant(options)),
      id_(guid_of(participant_.get())),
      shares_memory_(options.iceoryx),
      loopback_only_(options.network.loopback_only) {}

void Participant::set_writer_partition(const std::string& topic, dds_qos_t& qos) const {
  if (loopback_only_ || !stays_on_host(topic)) return;
  dds_qset_partition1(&qos, host_partition().c_str());
}

void Participant::set_reader_partition(const std::string& topic, dds_qos_t& qos) const {
  if (!stays_on_host(topic)) return;
  const std::string host = host_partition();
  const char* both[] = {"", host.c_str()};
  dds_qset_partition(&qos, 2, both);
}

VendorTopic Participant::topic(const std::string& name, const SampleType& type) {
  const std::lock_guard lock(mutex_);
  if (const auto known = topics_.find(name); known != topics_.end()) {
    if (known->second.type == type) return known->second.vendor;
    throw BusError("topic " + name + " has type " + known->second.type.name + ", not " + type.name);
  }
  ddsi_sertype* vendor_type = create_sertype(type);
  const dds_entity_t handle =
      dds_create_topic_sertype(participant_.get(), name.c_str(), &vendor_type, nullptr, nullptr, nullptr);
  if (handle < 0) {
    destroy_sertype(vendor_type);
    throw BusError("Cyclone DDS refused topic " + name + " of type " + type.name + ": " + dds_strretcode(handle));
  }
  return topics_.emplace(name, KnownTopic{type, {handle, vendor_type}}).first->second.vendor;
}

TopicTypes& Participant::types() {
  const std::lock_guard lock(mutex_);
  const auto note = [this](const WriterId& id, const dds_builtintopic_endpoint_t* endpoint) {
    if (endpoint == nullptr) return types_.gone(to_string(id));
    if (!is_own(id)) types_.appeared(to_string(id), endpoint->topic_name, endpoint->type_name);
  };
  using Direction = EndpointWatch::Direction;
  if (!writers_) writers_ = std::make_unique<EndpointWatch>(participant_.get(), Direction::kWriters, note);
  if (!readers_) readers_ = std::make_unique<EndpointWatch>(participant_.get(), Direction::kReaders, note);
  return types_;
}

bool Participant::is_own(const WriterId& endpoint) const {
  constexpr std::ptrdiff_t kPrefix = 12;  // of the participant
  return std::equal(endpoint.begin(), endpoint.begin() + kPrefix, id_.begin());
}

}  // namespace rtd::bus::cyclonedds
