// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <dds/dds.h>

#include <memory>

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

}  // namespace rtd::bus::cyclonedds
