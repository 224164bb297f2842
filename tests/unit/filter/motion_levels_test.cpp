// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/vision/motion_levels.hpp"

#include <gmock/gmock.h>

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
