// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// rmw_double RMW SETTING DOMAIN: joins and writes until stdin ends. For each line "look MS" on stdin it reads for so
/// long, or until it has received something; prints how many messages came.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <string>
#include <thread>

#include "tests/interop/bus/rmw_double.hpp"

int main(int argc, char** argv) {
  using namespace rtd::test_support;
  if (argc != 4) return 2;
  const std::string rmw = argv[1], setting = argv[2];
  const auto domain = static_cast<std::uint32_t>(std::atoi(argv[3]));
  try {
    const auto ros =
        rmw == "rmw_fastrtps" ? double_of_fastrtps(setting, domain) : double_of_cyclonedds(setting, domain);
    // Who is matched later than its own messages arrive still receives.
    const std::jthread writing([&ros](const std::stop_token& end) {
      while (!end.stop_requested()) {
        ros->write();
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
      }
    });
    int patience_ms = 0;
    for (std::string command; std::cin >> command >> patience_ms;) {
      const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(patience_ms);
      int received = 0;
      while (received == 0 && std::chrono::steady_clock::now() < end) {
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
        received += ros->take();
      }
      std::printf("received %d\n", received);
      std::fflush(stdout);
    }
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s %s: %s\n", rmw.c_str(), setting.c_str(), error.what());
    return 1;
  }
}
