// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/config.hpp"

#include <gmock/gmock.h>

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
