// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "common/bus/backend.hpp"
#include "common/bus/bus_factory.hpp"

namespace rtd::bus::fastdds {

/// Joins the domain with Fast DDS over shared memory and UDP. Throws BusError with cause and fix.
std::shared_ptr<BusBackend> create_backend(const BusOptions& options);

}  // namespace rtd::bus::fastdds
