// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <memory>

#include "common/bus/bus_factory.hpp"
#include "tests/support/inprocess/inprocess_bus.hpp"

namespace rtd::camera::test {

inline constexpr std::chrono::seconds kPatience{20};
inline constexpr const char* kTinyScene = "synthetic:static?width=64&height=48&frames=";

/// Another domain within the process each time.
inline std::shared_ptr<bus::Bus> in_process_bus() {
  static std::uint32_t domain = 170;
  bus::BusOptions options;
  options.vendor = bus::inprocess::vendor();
  options.domain = domain++;
  return bus::connect(options);
}

}  // namespace rtd::camera::test
