// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "common/bus/cyclonedds/domain.hpp"
#include "common/bus/cyclonedds/endpoint_watch.hpp"
#include "common/bus/cyclonedds/sample_type.hpp"
#include "common/bus/cyclonedds/stranger_watch.hpp"
#include "common/bus/topic_types.hpp"

namespace rtd::bus::cyclonedds {

struct VendorTopic {
  dds_entity_t handle = 0;
  const ddsi_sertype* type = nullptr;
};

/// Our presence in a domain, and its topics. Thread-safe.
class Participant {
 public:
  /// Throws BusError when Cyclone refuses.
  explicit Participant(const BusOptions& options);

  dds_entity_t handle() const { return participant_.get(); }
  const WriterId& id() const { return id_; }
  /// Whether an endpoint of that identity belongs to us.
  bool is_own(const WriterId& endpoint) const;
  bool shares_memory() const { return shares_memory_; }
  /// Where writers of the topic are heard and readers look: topics that stay on the host are in a partition of the
  /// host, so that nobody elsewhere is matched. Without a network they need none.
  void set_writer_partition(const std::string& topic, dds_qos_t& qos) const;
  void set_reader_partition(const std::string& topic, dds_qos_t& qos) const;
  /// The topic of that name, created when new; lives as long as the participant.
  /// Throws BusError when it exists with another type.
  VendorTopic topic(const std::string& name, const SampleType& type);
  /// Tells endpoints of ours when somebody uses the topic's name with another type.
  TopicTypes& types();

 private:
  struct KnownTopic {
    SampleType type;
    VendorTopic vendor;
  };

  std::unique_ptr<StrangerWatch> strangers_;  ///< secured: hears from the first one on, to the last
  std::shared_ptr<Domain> domain_;
  Entity participant_;  // its topics and endpoints end with it
  WriterId id_{};
  const bool shares_memory_, loopback_only_;
  std::mutex mutex_;
  std::map<std::string, KnownTopic> topics_;
  TopicTypes types_;
  std::unique_ptr<EndpointWatch> writers_, readers_;  ///< once somebody wants to know types; they end first
};

/// Identity of an entity in its domain.
WriterId guid_of(dds_entity_t entity);

}  // namespace rtd::bus::cyclonedds
