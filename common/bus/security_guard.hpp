// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "common/bus/backend.hpp"
#include "common/bus/bus_factory.hpp"
#include "common/bus/raw_bus.hpp"
#include "common/security/enclave.hpp"

/// What --secure requires of every vendor. Problems of the keystore and missing permissions are found here, before a
/// vendor sees them, and named with file or topic: the vendors only report that they refuse.
namespace rtd::bus {

/// The checked enclave of `options.security`. Calls options.on_problem when it expires within 30 days.
/// Throws BusError with cause and fix.
security::Enclave require_enclave(const BusOptions& options);

/// The same bus, which refuses topics that the enclave may not use. Throws BusError naming topic and enclave.
std::shared_ptr<BusBackend> guard(std::shared_ptr<BusBackend> bus, security::Enclave enclave);
std::shared_ptr<RawBus> guard(std::shared_ptr<RawBus> bus, security::Enclave enclave);

/// The problem of a participant in a secured domain that cannot be matched. `participant`: its name or id.
std::string other_vendor_problem(std::uint32_t domain, const std::string& participant, const std::string& vendor);
std::string not_secured_problem(std::uint32_t domain, const std::string& participant);
std::string refused_problem(std::uint32_t domain, const std::string& participant);

}  // namespace rtd::bus
