// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>

#include "common/bus/backend.hpp"

namespace rtd::bus::inprocess {

/// A bus inside this process: services in threads of one test see each other as over DDS, without sockets. Messages are
/// passed as shared pointers; a loaned message is never copied. Each reader has one thread.
std::shared_ptr<BusBackend> create_backend(std::uint32_t domain);

}  // namespace rtd::bus::inprocess
