// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/object_history.hpp"

#include <gtest/gtest.h>

namespace rtd::filter {
namespace {

constexpr std::size_t kCells = 160 * 120;
constexpr std::int64_t kSecond = 1'000'000'000;

SceneObject object_of(int first, int last) {
  SceneObject object{"person", 0.9F, MotionLevel::kHigh, {}, false};
  for (int cell = first; cell < last; ++cell) object.cells.push_back(cell);
  return object;
}

TEST(ObjectMotion, is_judged_by_the_cells_of_the_object) {
  DynamicRegions regions{true, CellMask(kCells, 0), 0};
  DepthEvidence evidence = DepthEvidence::none(kCells);
  const SceneObject object = object_of(1000, 1100);
  EXPECT_EQ(judge_motion(object, regions, evidence), ObjectMotion::kUnknown);
  for (std::size_t cell = 1000; cell < 1060; ++cell) evidence.consistent[cell] = 2;
  EXPECT_EQ(judge_motion(object, regions, evidence), ObjectMotion::kResting);
  for (std::size_t cell = 1050; cell < 1100; ++cell) regions.frames_left[cell] = 30;
  EXPECT_EQ(judge_motion(object, regions, evidence), ObjectMotion::kMoving);
  regions.trusted = false;
  EXPECT_EQ(judge_motion(object, regions, evidence), ObjectMotion::kUnknown);
}

TEST(ObjectHistory, measures_how_long_an_object_rests) {
  ObjectHistory history;
  for (int i = 0; i <= 20; ++i) {
    const auto resting_s = history.update({object_of(1000, 1100 + i)}, {ObjectMotion::kResting}, i * kSecond / 2);
    EXPECT_DOUBLE_EQ(resting_s[0], 0.5 * i);
  }
}

TEST(ObjectHistory, starts_again_after_a_motion) {
  ObjectHistory history;
  history.update({object_of(1000, 1100)}, {ObjectMotion::kResting}, 0);
  EXPECT_EQ(history.update({object_of(1000, 1100)}, {ObjectMotion::kMoving}, kSecond)[0], 0);
  EXPECT_EQ(history.update({object_of(1000, 1100)}, {ObjectMotion::kResting}, 2 * kSecond)[0], 0);
  EXPECT_EQ(history.update({object_of(1000, 1100)}, {ObjectMotion::kResting}, 3 * kSecond)[0], 1);
}

TEST(ObjectHistory, does_not_take_one_object_for_another) {
  ObjectHistory history;
  history.update({object_of(1000, 1100)}, {ObjectMotion::kResting}, 0);
  EXPECT_EQ(history.update({object_of(5000, 5100)}, {ObjectMotion::kResting}, kSecond)[0], 0);
}

}  // namespace
}  // namespace rtd::filter
