// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "common/bus/raw_bus.hpp"

/// A bus inside this process: services in threads of one test see each other as over DDS, without sockets. Messages are
/// passed as shared pointers; a loaned message is never copied. Each reader has one thread. Raw endpoints: discovery,
/// reliability, durability and keep-last histories behave as over DDS.
namespace rtd::bus::inprocess {

std::shared_ptr<BusBackend> create_backend(const BusOptions& options);
std::shared_ptr<RawBus> create_raw_bus(const BusOptions& options);

/// Its name as BusOptions::vendor, which connect() knows from the first call on.
std::string vendor();
/// It and those of this build.
std::vector<std::string> all_vendors();

}  // namespace rtd::bus::inprocess
