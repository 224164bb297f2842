// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "common/vision/motion_levels.hpp"
#include "services/filter/config.hpp"

namespace rtd::filter {
namespace {

TEST(FilterConfig, is_bound_completely_and_rejects_values_out_of_range) {
  ServiceConfig config;
  service::ConfigBinder binder;
  binder.section("filter", config);
  binder.set("filter.mode=geometry");
  binder.set("filter.geometry.tau_floor_m=0.4");
  EXPECT_EQ(config.core_config().mode, FilterMode::kGeometry);
  EXPECT_DOUBLE_EQ(config.core_config().geometry.tau_floor_m, 0.4);
  EXPECT_THROW(binder.set("filter.geometry.tau_floor_m=-1"), service::ConfigError);
  EXPECT_THROW(binder.set("filter.mode=magic"), service::ConfigError);
  EXPECT_THAT([&] { binder.set("filter.geometry.tau_flor_m=1"); },
              testing::ThrowsMessage<service::ConfigError>(testing::HasSubstr("tau_floor_m")));
}

}  // namespace
}  // namespace rtd::filter

namespace rtd::vision {
namespace {

TEST(MotionLevels, follow_the_paper_without_configuration) {
  const MotionLevels levels;
  EXPECT_EQ(levels.find("person"), MotionLevel::kHigh);
  EXPECT_EQ(levels.find("chair"), MotionLevel::kMedium);
  EXPECT_EQ(levels.find("tv"), MotionLevel::kLow);
  EXPECT_EQ(levels.find("traffic light"), std::nullopt);
}

TEST(MotionLevels, can_be_changed_class_by_class) {
  const MotionLevels levels({{"chair", "high"}, {"person", "none"}, {"forklift", "high"}});
  EXPECT_EQ(levels.find("chair"), MotionLevel::kHigh);
  EXPECT_EQ(levels.find("forklift"), MotionLevel::kHigh);
  EXPECT_EQ(levels.find("person"), std::nullopt);
}

TEST(MotionLevels, name_class_and_value_of_an_unknown_level) {
  EXPECT_THAT(
      [] {
        MotionLevels(std::map<std::string, std::string>{{"dog", "fast"}});
      },
      testing::ThrowsMessage<std::invalid_argument>(
          testing::AllOf(testing::HasSubstr("dog"), testing::HasSubstr("fast"))));
}

}  // namespace
}  // namespace rtd::vision
