// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "common/bus/bus_factory.hpp"
#include "services/launcher/doctor/findings.hpp"

namespace rtd::launcher {

/// With --secure: is the keystore there, and can every enclave in it join the domain at `now_s`? A host need not have
/// all of them. Returns an enclave that can, to try the bus with: that of the options if possible; empty: none.
std::string check_keystore(const bus::BusOptions& options, std::int64_t now_s, Findings& findings);

}  // namespace rtd::launcher
