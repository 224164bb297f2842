// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/belief/static_probability.hpp"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace rtd::filter
