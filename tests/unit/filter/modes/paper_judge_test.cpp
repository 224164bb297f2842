// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "services/filter/core/modes/mode_table.hpp"
#include "services/filter/core/modes/paper_judge.hpp"
#include "tests/unit/filter/grid_scenes.hpp"
#include "tests/unit/filter/moving_scene.hpp"

namespace rtd::filter {
namespace {

using test::kShape;
using test::MovingScene;
using test::removed_share;

constexpr double kDegree = 3.14159265358979 / 180;

/// A keyframe that saw keypoints on a grid over a wall at this depth.
View keyframe_of_wall(double depth_m) {
  View view;
  for (int v = 20; v < 470; v += 10) {
    for (int u = 20; u < 630; u += 10) {
      msg::Feature feature{};
      feature.u_px = static_cast<float>(u);
      feature.v_px = static_cast<float>(v);
      feature.depth_m = static_cast<float>(depth_m);
      view.features.push_back(feature);
    }
  }
  return view;
}
int moved_cells(const vision::RgbdImage& now, const View& keyframe) {
  const CellMask moved = check_keypoint_depths(now, kShape, Eigen::Isometry3d::Identity(), {&keyframe}, PaperConfig{});
  return static_cast<int>(std::count(moved.begin(), moved.end(), 1));
}

TEST(KeypointDepthCheck, finds_what_is_nearer_by_more_than_forty_centimetres) {
  EXPECT_GT(moved_cells(test::wall_image(2.5), keyframe_of_wall(3.0)), 1000);
  EXPECT_EQ(moved_cells(test::wall_image(2.65), keyframe_of_wall(3.0)), 0) << "the paper's threshold";
  EXPECT_EQ(moved_cells(test::wall_image(3.0), keyframe_of_wall(2.0)), 0) << "gone: hidden background, no mover";
}

TEST(KeypointDepthCheck, ignores_views_under_more_than_thirty_degrees) {
  for (const double degrees : {20.0, 40.0}) {
    View keyframe = keyframe_of_wall(2.0);
    std::erase_if(keyframe.features, [](const msg::Feature& f) {
      return std::abs(f.u_px - 320) > 30 || std::abs(f.v_px - 240) > 30;  // the angle is that of the centre
    });
    const Eigen::Translation3d centre(0, 0, 2.0);
    keyframe.T_world_camera =
        centre * Eigen::AngleAxisd(degrees * kDegree, Eigen::Vector3d::UnitY()) * Eigen::Translation3d(0, 0, -2.0);
    EXPECT_EQ(moved_cells(test::wall_image(1.0), keyframe) > 0, degrees < 30) << degrees << " degrees";
  }
}

TEST(KeypointDepthCheck, makes_no_statement_without_depth_or_keyframes) {
  vision::RgbdImage blind = test::wall_image();
  blind.depth.setTo(0);
  EXPECT_EQ(moved_cells(blind, keyframe_of_wall(3.0)), 0);
  EXPECT_EQ(moved_cells(test::wall_image(), View{}), 0);
  View unmeasured = keyframe_of_wall(0);
  EXPECT_EQ(moved_cells(test::wall_image(1.0), unmeasured), 0);
}

/// One frame with a box per class, whose features all lie at u = 100 (in the first box), 300 or 500.
class PaperRulesTest : public ::testing::Test {
 protected:
  PaperRulesTest() {
    for (const float u : {100.0F, 300.0F, 500.0F}) {
      msg::Feature feature{};
      feature.u_px = u;
      feature.v_px = 240;
      feature.depth_m = 2;
      features_.push_back(feature);
    }
  }
  void put(MotionLevel level, int first_column, int last_column) {
    SceneObject object{"", 0.9F, level, {}, false};
    for (int row = 0; row < 120; ++row) {
      for (int column = first_column; column < last_column; ++column) object.cells.push_back(kShape.index(column, row));
    }
    objects_.push_back(object);
  }
  std::vector<bool> removed() {
    const std::function<std::int64_t()> now_ns = [] { return std::int64_t{0}; };
    StageClock clock(now_ns);
    const test::TestScene scene(image_);
    features_ = PaperJudge(FilterConfig{}).judge(scene.with(objects_), features_, clock).features;
    return {test::removed(features_[0]), test::removed(features_[1]), test::removed(features_[2])};
  }
  vision::RgbdImage image_ = test::wall_image(2.0);
  std::vector<SceneObject> objects_;
  std::vector<msg::Feature> features_;
};

TEST_F(PaperRulesTest, remove_high_boxes_and_keep_the_others_unless_geometry_objects) {
  put(MotionLevel::kHigh, 0, 50);
  put(MotionLevel::kMedium, 50, 100);
  put(MotionLevel::kLow, 100, 160);
  EXPECT_EQ(removed(), (std::vector<bool>{true, false, false}));
  EXPECT_EQ(features_[0].static_probability, 0.02F);
  EXPECT_EQ(features_[1].static_probability, 1.0F) << "no weights in the paper";
  EXPECT_NE(features_[1].flags & msg::kFeatureInMediumMask, 0);
}

TEST_F(PaperRulesTest, leave_a_screen_behind_a_person_to_geometry) {
  put(MotionLevel::kHigh, 0, 100);
  put(MotionLevel::kLow, 50, 160);
  EXPECT_EQ(removed(), (std::vector<bool>{true, false, false}));
}

DynamicFilter make_filter() {
  FilterConfig config;
  config.mode = FilterMode::kRtdPaper;
  return DynamicFilter(config, [] { return std::int64_t{0}; });
}
/// Share of a block's features removed after the first frame was made a keyframe and the block has come.
double removed_of_block(const std::string& class_name) {
  const MovingScene scene;
  DynamicFilter filter = make_filter();
  const cv::Rect block = MovingScene::block(0, 0);
  std::vector<vision::Detection> boxes;
  if (!class_name.empty())
    boxes = {{class_name, 0.9F, static_cast<float>(block.x - 20), static_cast<float>(block.y - 20), 180, 260}};
  FilterResult result;
  for (std::uint64_t i = 0; i < 6; ++i) {
    result = filter.apply(scene.render(i, 0, i < 3 ? 100.0 : 0.0), i < 3 ? std::vector<vision::Detection>{} : boxes);
    if (i == 0) filter.on_keyframe({.seq = 0, .T_world_camera = result.T_world_camera});
  }
  return removed_share(result, block, true);
}

TEST(PaperJudge, removes_part_of_a_chair_that_was_pushed_and_of_a_box_without_class) {
  EXPECT_GT(removed_of_block("chair"), 0.15);
  EXPECT_GT(removed_of_block(""), 0.15);
  EXPECT_LT(removed_of_block("chair"), 1.0) << "only where the keyframe had keypoints";
}

TEST(PaperJudge, trusts_a_screen_even_when_it_was_moved) {
  EXPECT_EQ(removed_of_block("tv"), 0.0);
}

TEST(PaperJudge, takes_the_whole_box_of_a_person_background_included) {
  const MovingScene scene;
  DynamicFilter filter = make_filter();
  const FilterResult result =
      filter.apply(scene.render(0, 0, 0), std::vector<vision::Detection>{{"person", 0.9F, 100, 50, 440, 380}});
  EXPECT_EQ(removed_share(result, {88, 38, 464, 404}, true), 1.0);
  EXPECT_EQ(removed_share(result, {100, 50, 440, 380}, false), 0.0);
}

TEST(PaperJudge, remembers_nothing) {
  const MovingScene scene;
  DynamicFilter filter = make_filter();
  filter.apply(scene.render(0, 0, 0), std::vector<vision::Detection>{{"person", 0.9F, 240, 110, 160, 240}});
  EXPECT_EQ(filter.apply(scene.render(1, 0, 0.05), std::vector<vision::Detection>{}).removed, 0U);
}

TEST(ModeTable, names_every_technique) {
  std::set<std::string> names;
  for (const NamedTechnique& technique : kTechniques) names.insert(technique.name);
  EXPECT_EQ(names.size(), sizeof(Techniques)) << "one switch, one name";
}

TEST(ModeTable, gives_every_mode_a_name_and_rtd_everything) {
  std::set<std::string> names;
  for (const ModeEntry& entry : all_modes()) {
    names.insert(msg::name_of(entry.mode));
    EXPECT_EQ(&entry_of(entry.mode), &entry);
  }
  EXPECT_EQ(names.size(), all_modes().size());
  for (const NamedTechnique& technique : kTechniques) {
    EXPECT_TRUE(entry_of(FilterMode::kRtd).techniques.*technique.on) << technique.name;
    EXPECT_FALSE(entry_of(FilterMode::kOff).techniques.*technique.on) << technique.name;
  }
}

TEST(ModeTable, knows_which_modes_need_the_detector) {
  for (const ModeEntry& entry : all_modes()) {
    const bool blind = entry.mode == FilterMode::kOff || entry.mode == FilterMode::kGeometry;
    EXPECT_NE(looks_at_boxes(entry.mode), blind) << msg::name_of(entry.mode);
  }
}

TEST(ModeTable, lets_a_mode_use_only_what_is_its_own_and_not_switched_off) {
  FilterConfig chosen;
  chosen.mode = FilterMode::kGeometry;
  chosen.techniques.feature_votes = false;
  const FilterConfig config = effective_config(chosen);
  EXPECT_FALSE(config.techniques.motion_levels) << "not part of the mode";
  EXPECT_FALSE(config.techniques.feature_votes) << "switched off";
  EXPECT_TRUE(config.techniques.depth_check);
}

}  // namespace
}  // namespace rtd::filter
