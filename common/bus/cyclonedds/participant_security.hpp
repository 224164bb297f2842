// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/bus/bus_factory.hpp"
#include "common/bus/cyclonedds/entity.hpp"

namespace rtd::bus::cyclonedds {

/// The enclave's files as Cyclone's built-in plugins want them. No change without security.
void map_security(const SecurityOptions& security, const Qos& qos);

}  // namespace rtd::bus::cyclonedds
