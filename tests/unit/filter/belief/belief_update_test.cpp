// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "services/filter/core/belief/static_probability.hpp"
#include "tests/unit/filter/grid_scenes.hpp"

namespace rtd::filter {
namespace {

constexpr std::size_t kBeliefCells = 40 * 30;
constexpr double kFrameS = 1.0 / 30;

/// An object on the first half of a small image, seen for a while.
class BeliefTest : public ::testing::Test {
 protected:
  BeliefTest() {
    for (int cell = 0; cell < static_cast<int>(kBeliefCells / 2); ++cell) objects_[0].cells.push_back(cell);
    for (std::size_t cell = 0; cell < kBeliefCells; cell += 4) votes_.votes.push_back({static_cast<int>(cell), false});
  }
  /// Frames until now; returns the probability on the object.
  double see(int frames) {
    const MotionEvidence evidence{regions_, depth_, votes_};
    const auto on = objects_on_cells({40, 30}, objects_);
    for (int i = 0; i < frames; ++i) {
      motion_ = judge_objects(objects_, evidence, config_);
      beliefs_ = update_beliefs(std::move(beliefs_), {objects_, motion_, on, evidence, kFrameS}, config_, techniques_);
    }
    return on_object();
  }
  double on_object() const { return probability(beliefs_[100]); }
  double on_wall() const { return probability(beliefs_[kBeliefCells - 100]); }
  void rest() {
    depth_.consistent.assign(kBeliefCells, 2);
    depth_.lasting.assign(kBeliefCells, 1);
  }

  std::vector<SceneObject> objects_{{"person", 0.9F, MotionLevel::kHigh, {}, false}};
  std::vector<ObjectMotion> motion_;
  DynamicRegions regions_{true, CellMask(kBeliefCells, 0), 0};
  DepthEvidence depth_ = DepthEvidence::none(kBeliefCells);
  FeatureVotes votes_;
  BeliefConfig config_;
  Techniques techniques_;
  CellBeliefs beliefs_ = CellBeliefs(kBeliefCells, kNoBelief);
};

TEST_F(BeliefTest, starts_from_the_prior_of_the_class) {
  see(1);
  EXPECT_NEAR(on_object(), config_.high_prior, 1e-3);
  EXPECT_NEAR(on_wall(), config_.background_prior, 1e-3);
}

TEST_F(BeliefTest, rises_slowly_for_a_person_at_rest_and_stays_below_its_limit) {
  rest();
  EXPECT_LT(see(10), 0.25) << "a third of a second";
  EXPECT_GT(see(20), 0.4) << "a second";
  EXPECT_NEAR(see(200), config_.high_limit, 1e-3);
  EXPECT_NEAR(on_wall(), config_.highest_probability, 1e-3);
}

TEST_F(BeliefTest, falls_at_once_when_the_person_moves) {
  rest();
  see(100);
  regions_.hold_cs.assign(kBeliefCells / 2, 30);
  regions_.hold_cs.resize(kBeliefCells, 0);
  EXPECT_NEAR(see(1), config_.lowest_probability, 1e-3);
  EXPECT_GT(on_wall(), 0.9);
}

TEST_F(BeliefTest, falls_when_a_third_of_the_features_are_displaced) {
  rest();
  see(100);
  for (std::size_t i = 0; i < votes_.votes.size() / 2; ++i) votes_.votes[i].moving = i % 2 == 0;
  EXPECT_NEAR(see(1), config_.lowest_probability, 1e-3);
  EXPECT_EQ(motion_[0], ObjectMotion::kMoving);
}

TEST_F(BeliefTest, removes_only_the_arm_of_a_person_who_waves) {
  rest();
  see(100);
  for (std::size_t cell = 0; cell < 25; ++cell) regions_.hold_cs[cell] = 5;  // 4 % of the person
  see(1);
  EXPECT_NEAR(probability(beliefs_[10]), config_.lowest_probability, 1e-3);
  EXPECT_GT(on_object(), 0.5);
}

TEST_F(BeliefTest, recovers_after_a_stop_within_two_seconds) {
  regions_.hold_cs.assign(kBeliefCells, 30);
  see(5);
  regions_.hold_cs.assign(kBeliefCells, 0);
  rest();
  EXPECT_LT(see(15), 0.25);
  EXPECT_GT(see(30), 0.25);
  EXPECT_GT(on_wall(), 0.9);
}

TEST_F(BeliefTest, returns_to_the_prior_without_a_statement) {
  rest();
  see(100);
  depth_ = DepthEvidence::none(kBeliefCells);
  EXPECT_LT(see(30), config_.high_limit - 0.1);
  EXPECT_NEAR(see(600), config_.high_prior, 0.01);
}

TEST_F(BeliefTest, keeps_a_wall_that_a_box_sometimes_covers) {
  rest();
  objects_[0].level = MotionLevel::kLow;
  see(60);
  objects_[0].level = MotionLevel::kHigh;
  depth_ = DepthEvidence::none(kBeliefCells);
  EXPECT_GT(see(10), 0.9) << "ten frames of a wrong box";
}

TEST_F(BeliefTest, makes_no_statement_without_a_pose) {
  rest();
  see(60);
  const double before = on_object();
  regions_.trusted = false;
  EXPECT_DOUBLE_EQ(see(30), before);
}

TEST_F(BeliefTest, has_no_memory_when_switched_off) {
  techniques_.belief = false;
  rest();
  EXPECT_NEAR(see(100), config_.high_prior, 1e-3) << "one frame is not enough to trust a person";
  EXPECT_NEAR(on_wall(), config_.highest_probability, 1e-3);
}

TEST_F(BeliefTest, never_uses_high_levels_when_resting_objects_is_off) {
  techniques_.resting_objects = false;
  rest();
  EXPECT_LE(see(300), config_.high_prior + 1e-3);
}

TEST(ObjectsOnCells, let_the_higher_level_win_and_leave_pictures_out) {
  std::vector<SceneObject> objects{{"person", 0.9F, MotionLevel::kHigh, {1, 2}, false},
                                   {"tv", 0.9F, MotionLevel::kLow, {0, 1, 2, 3}, false},
                                   {"person", 0.9F, MotionLevel::kHigh, {3, 4}, true}};
  EXPECT_EQ(objects_on_cells({5, 1}, objects), (std::vector<std::int16_t>{1, 0, 0, 1, -1}));
}

constexpr std::size_t kGridCells = 1200;
const std::vector<int> kObject{10, 11, 12, 13};

/// Features on an object that has shifted, with 1 px of noise each, and as many beside it that rest.
FeatureVotes shifted_by(float x_px, int features) {
  std::mt19937 random(7);
  std::normal_distribution<float> noise_px(0, 1);
  FeatureVotes votes;
  for (int i = 0; i < features; ++i) {
    votes.shifts.push_back(
        {kObject[static_cast<std::size_t>(i) % kObject.size()], x_px + noise_px(random), noise_px(random)});
    votes.shifts.push_back({500, noise_px(random), noise_px(random)});
  }
  return votes;
}
bool moves(const FeatureVotes& votes) {
  return drifts(drift_of(kObject, votes, kGridCells), BeliefConfig{});
}

TEST(ObjectDrift, is_more_precise_than_the_shift_of_one_feature) {
  const ObjectDrift drift = drift_of(kObject, shifted_by(3, 100), kGridCells);
  EXPECT_EQ(drift.features, 100);
  EXPECT_NEAR(drift.shift_px, 3, 0.4);
  EXPECT_NEAR(drift.sigma_px, std::sqrt(2 * 1.57 / 100), 0.05) << "two axes";
}

TEST(ObjectDrift, distinguishes_a_shift_of_three_pixels_from_rest) {
  EXPECT_TRUE(moves(shifted_by(3, 100)));
  EXPECT_FALSE(moves(shifted_by(0, 100)));
  EXPECT_FALSE(moves(shifted_by(1.4F, 100))) << "the pose may be off so far";
}

TEST(ObjectDrift, makes_no_statement_about_few_features_or_none) {
  EXPECT_FALSE(moves(shifted_by(5, 8)));
  EXPECT_FALSE(moves({}));
}

TEST(ObjectDrift, does_not_take_waving_arms_for_the_person) {
  FeatureVotes votes = shifted_by(0, 100);
  for (std::size_t i = 0; i < 60; i += 2) votes.shifts[i].x_px += 10;
  EXPECT_FALSE(moves(votes));
}

/// A wall parallel to the image, and what was believed of it.
class SurfaceBeliefsTest : public ::testing::Test {
 protected:
  DepthGrid wall(double depth_m) { return sampler_.sample(test::wall_image(depth_m)); }
  CellBeliefs recall(const DepthGrid& now, const Eigen::Isometry3d& T_last_current = Eigen::Isometry3d::Identity()) {
    return beliefs_.recall(now, sampler_.rays(), camera_, T_last_current);
  }
  const geometry::CameraModel camera_ = test::wall_image().camera;
  DepthGridSampler sampler_ = test::make_sampler();
  SurfaceBeliefs beliefs_;
};

TEST(LogOdds, adds_up_and_returns) {
  EXPECT_FLOAT_EQ(log_odds(0.5), 0);
  EXPECT_NEAR(probability(log_odds(0.1)), 0.1, 1e-6);
  EXPECT_TRUE(std::isfinite(log_odds(0)));
  EXPECT_TRUE(std::isfinite(log_odds(1)));
}

TEST_F(SurfaceBeliefsTest, follow_a_wall_that_the_camera_passes) {
  const DepthGrid at_2_m = wall(2.0);
  CellBeliefs stored(at_2_m.depth_m.size(), -1.0F);
  const int spot = at_2_m.shape.index(80, 60);
  stored[static_cast<std::size_t>(spot)] = 3.0F;
  beliefs_.store(at_2_m, stored);
  Eigen::Isometry3d T_last_current = Eigen::Isometry3d::Identity();
  T_last_current.translation().x() = 2.0 * 5 * kCellPx / camera_.parameters().fx;  // five cells to the right
  const CellBeliefs recalled = recall(at_2_m, T_last_current);
  EXPECT_FLOAT_EQ(recalled[static_cast<std::size_t>(spot - 5)], 3.0F);
  EXPECT_FLOAT_EQ(recalled[static_cast<std::size_t>(spot)], -1.0F);
  EXPECT_FALSE(is_known(recalled[static_cast<std::size_t>(at_2_m.shape.index(158, 60))])) << "was not in view";
}

TEST_F(SurfaceBeliefsTest, are_not_inherited_by_what_steps_in_front) {
  const DepthGrid far = wall(3.0);
  beliefs_.store(far, CellBeliefs(far.depth_m.size(), 4.0F));
  EXPECT_TRUE(is_known(recall(far)[5000]));
  EXPECT_FALSE(is_known(recall(wall(1.5))[5000]));
}

TEST_F(SurfaceBeliefsTest, are_none_before_the_first_frame_and_after_another_camera) {
  const DepthGrid now = wall(2.0);
  EXPECT_FALSE(is_known(recall(now)[0]));
  const DepthGrid small{{2, 2}, std::vector<float>(4, 2.0F), std::vector<float>(4, 2.0F), std::vector<float>(4, 2.0F)};
  beliefs_.store(small, CellBeliefs(4, 1.0F));
  EXPECT_FALSE(is_known(recall(now)[0]));
}

}  // namespace
}  // namespace rtd::filter
