// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/launcher/core/settings/settings_list.hpp"

#include <gmock/gmock.h>

namespace rtd::launcher {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kSlam =
    "bus:\n"
    "  vendor: fastdds  # DDS implementation (--dds)\n"
    "  network:\n"
    "    peers: []  # hosts, HOST:PORT, e.g. gpubox (--peers)\n"
    "slam:\n"
    "  imu:\n"
    "    noise: 0.1  # of the gyroscope\n"
    "    topic: \"/imu: data\"  # topic of an IMU (--imu)\n"
    "  out: \"\"  # folder (--out)\n";

TEST(settings_list, reads_what_a_service_prints) {
  const auto settings = parse_printed(kSlam);
  ASSERT_EQ(settings.size(), 5U);
  EXPECT_EQ(settings[1].key, "bus.network.peers");
  EXPECT_EQ(settings[1].help, "hosts, HOST:PORT, e.g. gpubox (--peers)");
  EXPECT_EQ(settings[3].key, "slam.imu.topic");
  EXPECT_EQ(settings[3].value, "\"/imu: data\"");
  EXPECT_EQ(settings[4].key, "slam.out");
}

TEST(settings_list, shows_those_that_people_change_with_values_and_options) {
  const std::string text =
      settings_text([](const std::string& service) { return service == "slam" ? std::string(kSlam) : ""; });
  EXPECT_THAT(text, AllOf(HasSubstr("slam.imu.topic"), HasSubstr("/imu: data"), HasSubstr("(--imu)"),
                          HasSubstr("--print-config"), Not(HasSubstr("noise"))));
}

}  // namespace
}  // namespace rtd::launcher
