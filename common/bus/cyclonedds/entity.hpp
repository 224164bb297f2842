// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <dds/dds.h>

#include <memory>
#include <string>
#include <utility>

#include "common/bus/backend.hpp"

namespace rtd::bus::cyclonedds {

/// Owner of a Cyclone entity; what belongs to the entity goes with it. Move only.
class Entity {
 public:
  Entity() = default;
  explicit Entity(dds_entity_t handle) : handle_(handle) {}
  Entity(Entity&& other) noexcept : handle_(std::exchange(other.handle_, 0)) {}
  Entity& operator=(Entity&& other) noexcept {
    std::swap(handle_, other.handle_);
    return *this;
  }
  ~Entity() {
    if (handle_ > 0) dds_delete(handle_);
  }
  dds_entity_t get() const { return handle_; }

 private:
  dds_entity_t handle_ = 0;
};

/// Takes over what a dds_create_... returned. Throws BusError: "Cyclone DDS refused WHAT: reason".
inline Entity created(dds_entity_t handle, const std::string& what) {
  if (handle < 0) throw BusError("Cyclone DDS refused " + what + ": " + dds_strretcode(handle));
  return Entity(handle);
}

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
