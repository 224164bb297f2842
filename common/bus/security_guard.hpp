// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "common/bus/backend.hpp"
#include "common/bus/bus_factory.hpp"
#include "common/bus/raw_bus.hpp"
#include "common/security/enclave.hpp"

/// What --secure asks of every vendor. Whatever is wrong with the keystore is said here, before a vendor sees it, and
/// with the name of the topic where permissions are missing: the vendors only say that they refuse.
namespace rtd::bus {

/// The checked enclave of `options.security`. Tells options.on_problem when it expires within 30 days.
/// Throws BusError with cause and fix.
security::Enclave require_enclave(const BusOptions& options);

/// The same bus, which refuses topics that the enclave may not use. Throws BusError naming topic and enclave.
std::shared_ptr<BusBackend> guard(std::shared_ptr<BusBackend> bus, security::Enclave enclave);
std::shared_ptr<RawBus> guard(std::shared_ptr<RawBus> bus, security::Enclave enclave);

/// What to tell of a stranger in a secured domain that cannot be met. `participant`: its name or id.
std::string other_vendor_problem(std::uint32_t domain, const std::string& participant, const std::string& vendor);
std::string not_secured_problem(std::uint32_t domain, const std::string& participant);
std::string refused_problem(std::uint32_t domain, const std::string& participant);

}  // namespace rtd::bus
