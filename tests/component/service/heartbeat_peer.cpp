// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// heartbeat_peer VENDOR DOMAIN: a service "detector" that only lives, until it is killed, and reads rt/slam/odometry by
// mistake as poses.
#include <unistd.h>

#include <cstdlib>

#include "common/bus/bus_factory.hpp"
#include "common/service/runtime.hpp"

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  rtd::bus::BusOptions options;
  options.vendor = argv[1];
  options.domain = static_cast<std::uint32_t>(std::atoi(argv[2]));
  const auto bus = rtd::bus::connect(options);
  rtd::service::StopToken stop;
  rtd::service::Heartbeat heartbeat(*bus, "detector", stop);
  const rtd::bus::Topic<rtd::msg::PoseStamped> mistaken{rtd::bus::topics::kOdometry.name, rtd::bus::QosProfile::kPose};
  const auto reader = bus->reader(mistaken, [](const auto&) {});
  heartbeat.set_state(rtd::msg::ServiceState::kRunning);
  while (true) pause();
}
