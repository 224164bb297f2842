// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <dds/dds.h>

#include <memory>
#include <string>

#include "common/bus/raw_bus.hpp"

namespace rtd::bus::cyclonedds {

/// Owner of a Cyclone entity; what belongs to the entity goes with it.
class Entity {
 public:
  explicit Entity(dds_entity_t handle) : handle_(handle) {}
  ~Entity() { dds_delete(handle_); }
  Entity(const Entity&) = delete;
  Entity& operator=(const Entity&) = delete;
  dds_entity_t get() const { return handle_; }

 private:
  const dds_entity_t handle_;
};

template <auto kDelete>
struct Deleter {
  template <class T>
  void operator()(T* owned) const {
    kDelete(owned);
  }
};
using Qos = std::unique_ptr<dds_qos_t, Deleter<dds_delete_qos>>;
using Listener = std::unique_ptr<dds_listener_t, Deleter<dds_delete_listener>>;

/// A profile's settings in the terms of RawQos, which has all that Cyclone needs.
RawQos to_raw_qos(const QosSettings& settings);

/// Every policy that an endpoint has is set: defaults differ between vendors.
Qos writer_qos(const RawQos& offered);
Qos reader_qos(const RawQos& requested);
/// Asks for nothing that would keep a writer from matching: no deadline, no liveliness, any data representation.
Qos raw_reader_qos(const RawReaderOptions& options);

/// What discovery finds of a writer; without identity and topic.
RawQos from_vendor(const dds_qos_t& qos);

/// Announces the type's hash, for ROS 2 (common/ros2/type_description.hpp).
void set_type_hash(dds_qos_t& qos, const std::string& dds_type);
/// What an endpoint announces besides its policies.
std::string user_data(const dds_qos_t& qos);

/// DDS name of a policy, e.g. "RELIABILITY".
std::string name_of(std::uint32_t policy);

}  // namespace rtd::bus::cyclonedds
