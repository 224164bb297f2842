// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <mutex>

#include "common/bus/cyclonedds/entity.hpp"
#include "common/bus/raw_bus.hpp"

namespace rtd::bus::cyclonedds {

/// Hears of the endpoints of one direction in the domain, ours and others', as they appear, change and go.
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

}  // namespace rtd::bus::cyclonedds
