// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "common/bus/raw_bus.hpp"

namespace rtd::bus {

/// connect_raw() as an attacker has it: without our checks, only the vendor's.
std::shared_ptr<RawBus> connect_unchecked(const BusOptions& options);

}  // namespace rtd::bus
