// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstdlib>

#include "common/service/bus_config.hpp"

namespace rtd::service {
namespace {

std::string form_with(const char* distribution, const std::string& setting) {
  ::setenv("ROS_DISTRO", distribution, 1);
  BusConfig config;
  config.options.ros_graph = setting;
  const std::string form = to_bus_options(config, "rtd-slam").ros_graph;
  ::unsetenv("ROS_DISTRO");
  return form;
}

TEST(RosGraphSetting, follows_the_distribution_unless_given) {
  EXPECT_EQ(form_with("humble", "auto"), "humble");
  EXPECT_EQ(form_with("galactic", "auto"), "humble");
  for (const char* newer : {"iron", "jazzy", "rolling", ""}) EXPECT_EQ(form_with(newer, "auto"), "iron");
  EXPECT_EQ(form_with("humble", "iron"), "iron");
  EXPECT_EQ(form_with("humble", "off"), "off");
}

}  // namespace
}  // namespace rtd::service
