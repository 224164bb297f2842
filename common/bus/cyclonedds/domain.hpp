// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "common/bus/bus_factory.hpp"
#include "common/bus/cyclonedds/entity.hpp"

namespace rtd::bus::cyclonedds {

/// Cyclone has one domain of a number in a process, and one configuration of it: all connections share it, the last one
/// ends it.
struct Domain {
  std::string config;
  Entity entity;
};

/// Throws BusError: refused, with Cyclone's own words, or already there with other settings.
std::shared_ptr<Domain> join_domain(const BusOptions& options);

}  // namespace rtd::bus::cyclonedds
