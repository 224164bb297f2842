// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/belief/static_probability.hpp"

#include <gtest/gtest.h>

namespace rtd::filter {
namespace {

constexpr std::size_t kImageCells = 160 * 120;

/// One object on the left third of the image, features on a grid over all of it.
class StaticProbabilityTest : public ::testing::Test {
 protected:
  StaticProbabilityTest() {
    for (int v = 10; v < 480; v += 20) {
      for (int u = 10; u < 640; u += 20) {
        msg::Feature feature{};
        feature.u_px = static_cast<float>(u);
        feature.v_px = static_cast<float>(v);
        features_.push_back(feature);
      }
    }
    SceneObject object{"person", 0.9F, MotionLevel::kHigh, {}, false};
    for (int cell = 0; cell < static_cast<int>(kImageCells); ++cell) {
      if (cell % 160 < 53) object.cells.push_back(cell);
    }
    objects_.push_back(object);
    config_.fusion.min_static_features = 0;
  }
  void weigh(FilterMode mode = FilterMode::kRtd) {
    config_.mode = mode;
    const FeatureVotes no_votes;
    const MotionEvidence evidence{regions_, evidence_, no_votes};
    const auto object_on = objects_on_cells({160, 120}, objects_);
    const CellBeliefs beliefs =
        update_beliefs(recalled_, {objects_, motions_, object_on, evidence, 0.033}, config_.belief, config_.techniques);
    features_ = weigh_static_probability(
        features_, {{160, 120}, objects_, object_on, beliefs, regions_, evidence_, in_question_}, config_);
  }
  const msg::Feature& on_object() const { return features_[2]; }
  const msg::Feature& background() const { return features_[25]; }
  static bool removed(const msg::Feature& feature) { return (feature.flags & msg::kFeatureRemoved) != 0; }

  std::vector<msg::Feature> features_;
  std::vector<SceneObject> objects_;
  std::vector<ObjectMotion> motions_{ObjectMotion::kUnknown};
  DynamicRegions regions_{true, CellMask(kImageCells, 0), 0};
  DepthEvidence evidence_ = DepthEvidence::none(kImageCells);
  CellBeliefs recalled_ = CellBeliefs(kImageCells, kNoBelief);
  CellMask in_question_ = CellMask(kImageCells, 0);
  FilterConfig config_;
};

TEST_F(StaticProbabilityTest, removes_a_person_seen_for_the_first_time) {
  weigh();
  EXPECT_TRUE(removed(on_object()));
  EXPECT_EQ(on_object().object_id, 0);
  EXPECT_NE(on_object().flags & msg::kFeatureInHighMask, 0);
  EXPECT_FALSE(removed(background()));
  EXPECT_EQ(background().object_id, -1);
}

TEST_F(StaticProbabilityTest, flags_what_is_in_question_and_removes_what_moves_all_the_same) {
  in_question_.assign(kImageCells, 1);
  weigh();
  EXPECT_NE(background().flags & msg::kFeatureInQuestion, 0);
  EXPECT_FALSE(removed(background()));
  EXPECT_NEAR(background().static_probability, 0.9, 0.05) << "its probability is for later";
  EXPECT_TRUE(removed(on_object())) << "a person";
  EXPECT_EQ(on_object().flags & msg::kFeatureInQuestion, 0);
}

TEST_F(StaticProbabilityTest, gives_a_person_who_sits_for_long_a_low_weight) {
  motions_[0] = ObjectMotion::kResting;
  recalled_.assign(kImageCells, log_odds(0.4));
  weigh();
  EXPECT_FALSE(removed(on_object()));
  EXPECT_NEAR(on_object().static_probability, 0.42, 0.01);
}

TEST_F(StaticProbabilityTest, weighs_all_equally_when_weights_are_off) {
  config_.techniques.feature_weights = false;
  recalled_.assign(kImageCells, log_odds(0.4));
  weigh();
  EXPECT_EQ(on_object().static_probability, 1.0F);
}

TEST_F(StaticProbabilityTest, lets_geometry_decide_on_a_chair) {
  objects_[0].level = MotionLevel::kMedium;
  weigh();
  EXPECT_FALSE(removed(on_object()));
  EXPECT_NEAR(on_object().static_probability, config_.belief.medium_prior, 1e-3);
  motions_[0] = ObjectMotion::kResting;
  weigh();
  EXPECT_GT(on_object().static_probability, config_.belief.medium_prior);
  motions_[0] = ObjectMotion::kMoving;
  weigh();
  EXPECT_TRUE(removed(on_object()));
}

TEST_F(StaticProbabilityTest, trusts_a_screen_unless_it_moves) {
  objects_[0].level = MotionLevel::kLow;
  weigh();
  EXPECT_FALSE(removed(on_object()));
  regions_.hold_cs.assign(kImageCells, 10);
  weigh();
  EXPECT_TRUE(removed(on_object()));
}

TEST_F(StaticProbabilityTest, leaves_a_person_on_a_poster_to_geometry) {
  objects_[0].flat = true;
  weigh();
  EXPECT_FALSE(removed(on_object()));
}

TEST_F(StaticProbabilityTest, prefers_the_person_where_masks_overlap) {
  SceneObject screen = objects_[0];
  screen.level = MotionLevel::kLow;
  objects_.push_back(screen);
  motions_.push_back(ObjectMotion::kUnknown);
  weigh();
  EXPECT_EQ(on_object().object_id, 0);
  EXPECT_TRUE(removed(on_object()));
}

TEST_F(StaticProbabilityTest, removes_what_moves_without_a_class) {
  objects_.clear();
  regions_.hold_cs.assign(kImageCells, 10);
  weigh();
  EXPECT_TRUE(removed(background()));
  EXPECT_NE(background().flags & msg::kFeatureGeometryMoving, 0);
}

TEST_F(StaticProbabilityTest, removes_people_and_nothing_else_in_semantic_mode) {
  recalled_.assign(kImageCells, log_odds(0.9));
  weigh(FilterMode::kSemantic);
  EXPECT_TRUE(removed(on_object()));
  EXPECT_FALSE(removed(background()));
}

TEST_F(StaticProbabilityTest, a_mask_of_pixels_grows_no_further_than_its_surroundings) {
  const auto at_border = [this] { return features_[10]; };  // u = 210: cell 52 is the last of the object, this is next
  features_[10].u_px = 213;
  regions_.hold_cs.assign(kImageCells, 0);
  for (const int cell : objects_[0].cells) regions_.hold_cs[static_cast<std::size_t>(cell)] = 10;
  weigh();
  EXPECT_TRUE(removed(at_border())) << "masks grow by a cell";
  for (int cell = 0; cell < static_cast<int>(kImageCells); ++cell)
    if (cell % 160 >= 53) objects_[0].around.push_back(cell);
  weigh();
  EXPECT_FALSE(removed(at_border()));
  EXPECT_EQ(at_border().object_id, -1);
  EXPECT_TRUE(removed(on_object()));
}

TEST_F(StaticProbabilityTest, the_surroundings_of_one_person_may_be_another_person) {
  SceneObject other{"person", 0.8F, MotionLevel::kHigh, {}, false};
  for (int cell = 0; cell < static_cast<int>(kImageCells); ++cell) {
    if (cell % 160 >= 53) objects_[0].around.push_back(cell);
    if (cell % 160 >= 53 && cell % 160 < 80) other.cells.push_back(cell);
  }
  objects_.push_back(other);
  motions_.push_back(ObjectMotion::kUnknown);
  features_[10].u_px = 322;  // the first cell beside the other
  weigh();
  EXPECT_TRUE(removed(features_[10])) << "it grows as every mask";
}

TEST_F(StaticProbabilityTest, keeps_the_best_of_the_doubtful_when_too_few_remain) {
  for (int cell = 0; cell < static_cast<int>(kImageCells); ++cell)
    objects_[0].cells.push_back(cell);  // a person everywhere
  config_.fusion.min_static_features = 100;
  weigh();
  EXPECT_EQ(std::count_if(features_.begin(), features_.end(), [](const auto& f) { return !removed(f); }), 100);
}

TEST_F(StaticProbabilityTest, never_takes_back_what_geometry_saw_moving) {
  regions_.hold_cs.assign(kImageCells, 10);
  config_.fusion.min_static_features = 100;
  weigh();
  EXPECT_EQ(std::count_if(features_.begin(), features_.end(), [](const auto& f) { return !removed(f); }), 0);
}

}  // namespace
}  // namespace rtd::filter
