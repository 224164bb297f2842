// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// Publishes a pose as slam does, 50 a second, for at most a minute: pose_source VENDOR DOMAIN.
#include <chrono>
#include <cstdio>
#include <exception>
#include <thread>

#include "common/bus/bus_factory.hpp"

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fputs("usage: pose_source VENDOR DOMAIN\n", stderr);
    return 2;
  }
  try {
    rtd::bus::BusOptions options;
    options.vendor = argv[1];
    options.domain = static_cast<std::uint32_t>(std::stoul(argv[2]));
    const auto bus = rtd::bus::connect(options);
    auto writer = bus->writer(rtd::bus::topics::kPose);
    rtd::msg::PoseStamped pose;
    pose.header.frame_id = "map";
    pose.pose.position = {1.5, -2.25, 0.125};
    for (std::int64_t i = 0; i < 3000; ++i) {
      pose.header.stamp = rtd::msg::to_time(1'000'000'000 + i * 20'000'000);
      writer.write(pose);
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "pose_source: %s\n", error.what());
    return 1;
  }
  return 0;
}
