// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "common/bus/cyclonedds/qos_mapping.hpp"
#include "common/bus/cyclonedds/samples.hpp"
#include "common/bus/cyclonedds/unmatched_participants.hpp"
#include "common/bus/discovery.hpp"
#include "common/bus/ros_graph.hpp"

namespace rtd::bus::cyclonedds {

/// Cyclone has one domain of a number in a process, and one configuration of it: all connections share it, the last one
/// ends it.
struct Domain {
  std::string config;
  Entity entity;
};

struct VendorTopic {
  dds_entity_t handle = 0;
  const ddsi_sertype* type = nullptr;
};

/// Notes the endpoints of one direction in the domain, ours and others', as they appear, change and go.
class EndpointWatch {
 public:
  enum class Direction { kWriters, kReaders };
  /// Runs on Cyclone's threads, one call at a time: take notes and return. `qos` is valid only for an endpoint that is
  /// there.
  using Note = std::function<void(const WriterId& id, const dds_builtintopic_endpoint_t* endpoint)>;

  EndpointWatch(dds_entity_t participant, Direction direction, Note note);
  ~EndpointWatch();
  EndpointWatch(const EndpointWatch&) = delete;
  EndpointWatch& operator=(const EndpointWatch&) = delete;

 private:
  void take_all();

  const Note note_;
  std::mutex mutex_;
  dds_entity_t reader_ = 0;
};

/// Our participant in a domain, and its topics. Thread-safe.
class Participant {
 public:
  /// `node`: where its endpoints enter themselves, nullptr: in one of its own. Throws BusError when Cyclone refuses.
  explicit Participant(const BusOptions& options, std::shared_ptr<NodeEndpoints> node = nullptr);

  dds_entity_t handle() const { return participant_.get(); }
  const WriterId& id() const { return id_; }
  /// Whether an endpoint of that identity belongs to us.
  bool is_own(const WriterId& endpoint) const;
  /// Names of the participants of the domain, ours included.
  std::map<ParticipantId, std::string> participants() const;
  /// Topics that stay on the host are in a partition of the host, so that no reader elsewhere is matched. Without a
  /// network they need none.
  void set_writer_partition(const std::string& topic, dds_qos_t& qos) const;
  void set_reader_partition(const std::string& topic, dds_qos_t& qos) const;
  /// The topic of that name, created when new; lives as long as the participant.
  /// Throws BusError when it exists with another type.
  VendorTopic topic(const std::string& name, const SampleType& type);
  TopicTypes& types();
  /// What is announced to ROS 2: endpoints enter themselves.
  NodeEndpoints& node_endpoints() { return *node_endpoints_; }

 private:
  struct KnownTopic {
    SampleType type;
    VendorTopic vendor;
  };

  std::unique_ptr<UnmatchedWatch> unmatched_;  ///< secured: from before the first participant to after the last
  std::shared_ptr<Domain> domain_;
  Entity participant_;  // its topics and endpoints end with it
  WriterId id_{};
  mutable std::once_flag asked_;
  mutable dds_entity_t participants_ = 0;  ///< a reader, from the first call of participants() on
  const bool loopback_only_;
  std::mutex mutex_;
  std::map<std::string, KnownTopic> topics_;
  TopicTypes types_;
  const std::shared_ptr<NodeEndpoints> node_endpoints_;
  std::unique_ptr<EndpointWatch> writers_, readers_;  ///< from the first call of types() on; they end first
};

/// Identity of an entity in its domain.
WriterId guid_of(dds_entity_t entity);

}  // namespace rtd::bus::cyclonedds
