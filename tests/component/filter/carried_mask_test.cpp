// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <limits>

#include "services/filter/core/dynamic_filter.hpp"
#include "tests/unit/filter/moving_scene.hpp"

namespace rtd::filter {
namespace {

using test::MovingScene;
using test::removed_share;

constexpr double kWalkerStepM = 0.02;  // 0.6 m/s

/// A person (the block of the scene) whom only the detector can know: semantic mode. The answers of the detector are
/// given by hand.
class CarriedMask : public ::testing::Test {
 protected:
  static FilterConfig config() {
    FilterConfig config;
    config.mode = FilterMode::kSemantic;
    return config;
  }
  static double block_x_m(std::uint64_t frame) { return -0.3 + kWalkerStepM * static_cast<double>(frame); }
  static std::int64_t stamp(std::uint64_t frame) { return static_cast<std::int64_t>(frame) * 33'333'333; }
  static DetectionBatch batch(std::uint64_t frame) {
    const cv::Rect block = MovingScene::block(0, block_x_m(frame));
    return {stamp(frame),
            {{"person", 0.9F, static_cast<float>(block.x - 5), static_cast<float>(block.y - 5),
              static_cast<float>(block.width + 10), static_cast<float>(block.height + 10)}}};
  }
  FilterResult frame(std::uint64_t number, std::vector<DetectionBatch> batches, bool active = true) {
    return filter_.apply(scene_.render(number, 0, block_x_m(number)), DetectorUpdate{active, std::move(batches)});
  }
  static double on_block(const FilterResult& result, std::uint64_t number) {
    return removed_share(result, MovingScene::block(0, block_x_m(number)), true);
  }
  static double beside_block(const FilterResult& result, std::uint64_t number) {
    return removed_share(result, MovingScene::block(0, block_x_m(number)), false);
  }

  const MovingScene scene_;
  DynamicFilter filter_{config(), [] { return std::int64_t{0}; }};
};

TEST_F(CarriedMask, stays_on_a_walker_with_late_detections_at_five_hertz) {
  for (std::uint64_t i = 0; i < 30; ++i) {
    std::vector<DetectionBatch> batches;
    if (i >= 4 && (i - 4) % 6 == 0) batches.push_back(batch(i - 4));  // 130 ms late
    const FilterResult result = frame(i, std::move(batches));
    if (i < 4) continue;
    EXPECT_GE(on_block(result, i), 0.95) << "frame " << i;
    EXPECT_LE(beside_block(result, i), 0.02) << "frame " << i;
    ASSERT_EQ(result.objects.size(), 1U) << "frame " << i;
    EXPECT_EQ(result.objects[0].track_id, 0) << "frame " << i;
    EXPECT_TRUE(result.objects[0].carried);
  }
}

TEST_F(CarriedMask, stays_on_a_walker_through_a_second_of_silence) {
  for (std::uint64_t i = 0; i < 40; ++i) {
    const FilterResult result = frame(i, i < 5 ? std::vector{batch(i)} : std::vector<DetectionBatch>{});
    if (i >= 35) continue;
    EXPECT_GE(on_block(result, i), 0.95) << "frame " << i;
  }
}

TEST_F(CarriedMask, is_dropped_half_a_second_after_the_detector_has_gone) {
  for (std::uint64_t i = 0; i < 5; ++i) frame(i, {batch(i)});
  FilterResult result;
  for (std::uint64_t i = 5; i < 12; ++i) result = frame(i, {}, false);
  EXPECT_EQ(result.objects.size(), 1U);
  for (std::uint64_t i = 12; i < 25; ++i) result = frame(i, {}, false);
  EXPECT_TRUE(result.objects.empty());
}

TEST_F(CarriedMask, survives_a_broken_detector) {
  const DetectionBatch good = batch(0);
  std::vector<vision::Detection> ten_thousand(10'000, {"person", 0.9F, 10, 10, 50, 50});
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<DetectionBatch> batches{good,
                                            good,
                                            {stamp(90), good.detections},
                                            {-stamp(90), good.detections},
                                            {stamp(0), {{"person", nan, nan, 1e30F, -5, 0}}},
                                            {stamp(0), ten_thousand}};
  const FilterResult result = frame(0, batches);
  EXPECT_EQ(result.objects.size(), 1U) << "one answer a frame: the first";
  const FilterResult flooded = frame(1, {{stamp(1), ten_thousand}});
  EXPECT_LE(flooded.objects.size(), kMaxObjects + 1);
}

}  // namespace
}  // namespace rtd::filter
