// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// Every switch changes what the filter finds, and only its part of it.
#include <gtest/gtest.h>

#include <random>
#include <set>

#include "services/filter/core/belief/static_probability.hpp"
#include "services/filter/core/modes/mode_table.hpp"
#include "services/filter/core/motion/static_consensus.hpp"
#include "tests/unit/filter/grid_scenes.hpp"
#include "tests/unit/filter/moving_scene.hpp"

namespace rtd::filter {
namespace {

using test::MovingScene;
using test::removed_share;

FilterConfig config_of(FilterMode mode, std::initializer_list<bool Techniques::*> off) {
  FilterConfig config;
  config.mode = mode;
  for (bool Techniques::*const technique : off) config.techniques.*technique = false;
  return config;
}
DynamicFilter make_filter(FilterMode mode, std::initializer_list<bool Techniques::*> off) {
  return DynamicFilter(config_of(mode, off), [] { return std::int64_t{0}; });
}

/// Share of a mover's features that geometry removes after half a second.
double removed_of_mover(std::initializer_list<bool Techniques::*> off) {
  const MovingScene scene;
  DynamicFilter filter = make_filter(FilterMode::kGeometry, off);
  FilterResult result;
  double block_x = 0;
  for (std::uint64_t i = 0; i < 15; ++i) {
    block_x = -0.25 + 0.03 * static_cast<double>(i);
    result = filter.apply(scene.render(i, 0, block_x), std::nullopt);
  }
  return removed_share(result, MovingScene::block(0, block_x), true);
}

std::vector<SceneObject> objects_in(const vision::RgbdImage& image, const FilterConfig& config) {
  const DepthGrid grid = test::make_sampler().sample(image);
  const std::vector<ObjectBox> person{{{"person", 0.9F, 200, 100, 200, 320}}};
  return find_objects(person, MotionLevels{}, image.camera, grid, find_depth_clusters(grid, ClusterConfig{}),
                      effective_config(config).masks);
}

TEST(Techniques, motion_levels_off_treats_a_chair_like_a_person) {
  const MovingScene scene;
  const cv::Rect block = MovingScene::block(0, 0);
  const std::vector<vision::Detection> chair{{"chair", 0.9F, static_cast<float>(block.x - 10), 110, 160, 240}};
  EXPECT_EQ(removed_share(make_filter(FilterMode::kRtd, {}).apply(scene.render(0, 0, 0), chair), block, true), 0.0);
  EXPECT_EQ(
      removed_share(make_filter(FilterMode::kRtd, {&Techniques::motion_levels}).apply(scene.render(0, 0, 0), chair),
                    block, true),
      1.0);
}

TEST(Techniques, depth_masks_off_takes_the_whole_box) {
  vision::RgbdImage image = test::wall_image(3.0);
  test::put_block(image, {240, 120, 120, 280}, 1.5);
  const auto masked = objects_in(image, config_of(FilterMode::kRtd, {}));
  const auto boxed = objects_in(image, config_of(FilterMode::kRtd, {&Techniques::depth_masks}));
  EXPECT_EQ(masked.at(0).cells.size(), static_cast<std::size_t>(test::cells_in({240, 120, 120, 280})));
  EXPECT_GE(boxed.at(0).cells.size(), static_cast<std::size_t>(test::cells_in({200, 100, 200, 320})));
}

TEST(Techniques, flat_objects_off_takes_a_poster_for_a_person) {
  EXPECT_TRUE(objects_in(test::wall_image(2.0), config_of(FilterMode::kRtd, {})).at(0).flat);
  EXPECT_FALSE(objects_in(test::wall_image(2.0), config_of(FilterMode::kRtd, {&Techniques::flat_objects})).at(0).flat);
}

TEST(Techniques, object_holes_off_leaves_dark_clothes_to_the_background) {
  vision::RgbdImage image = test::wall_image(3.0);
  test::put_block(image, {240, 120, 120, 280}, 1.5);
  test::put_block(image, {240, 200, 120, 80}, 0);
  EXPECT_GE(objects_in(image, config_of(FilterMode::kRtd, {})).at(0).holes.size(), 100U);
  EXPECT_TRUE(objects_in(image, config_of(FilterMode::kRtd, {&Techniques::object_holes})).at(0).holes.empty());
}

/// Cells that a person covers whose coat has no depth, and whose mask covers it.
std::size_t cells_with_dark_coat(bool with_mask) {
  vision::RgbdImage image = test::wall_image(3.0);
  test::put_block(image, {240, 120, 120, 280}, 1.5);
  test::put_block(image, {240, 200, 120, 120}, 0);
  vision::PersonMasks masks{160, 120, std::vector<std::uint8_t>(160 * 120, 0)};
  for (int row = 30; row < 100; ++row)
    for (int column = 60; column < 90; ++column) masks.labels[static_cast<std::size_t>(row * 160 + column)] = 2;
  const std::vector<vision::Detection> boxes{{"of no level", 0.99F, 0, 0, 50, 50},
                                             {"person", 0.9F, 200, 100, 200, 320}};
  if (!with_mask) masks = {};
  DynamicFilter filter = make_filter(FilterMode::kSemantic, {});
  const FilterResult result = filter.apply(image, DetectorUpdate{true, {{image.stamp_ns, boxes, masks}}});
  return result.objects.at(0).cells.size() + result.objects.at(0).holes.size();
}

TEST(Techniques, a_person_mask_covers_what_depth_alone_leaves_out) {
  const auto person = static_cast<std::size_t>(test::cells_in({240, 120, 120, 280}));
  EXPECT_EQ(cells_with_dark_coat(true), person);
  EXPECT_LT(cells_with_dark_coat(false), person);
}

TEST(Techniques, depth_check_and_feature_votes_each_find_a_mover_alone) {
  EXPECT_GE(removed_of_mover({&Techniques::feature_votes}), 0.9) << "by depth";
  EXPECT_GE(removed_of_mover({&Techniques::depth_check}), 0.9) << "by displaced features";
  EXPECT_EQ(removed_of_mover({&Techniques::depth_check, &Techniques::feature_votes}), 0.0);
}

/// Frames for which geometry still removes features after a mover has stopped.
int frames_masked_after_stop(std::initializer_list<bool Techniques::*> off) {
  constexpr std::uint64_t kMoving = 15, kAfter = 60;
  const MovingScene scene;
  DynamicFilter filter = make_filter(FilterMode::kGeometry, off);
  int masked = 0;
  for (std::uint64_t i = 0; i < kMoving + kAfter; ++i) {
    const double block_x = -0.25 + 0.03 * static_cast<double>(std::min(i, kMoving));
    const FilterResult result = filter.apply(scene.render(i, 0, block_x), std::nullopt);
    if (i >= kMoving && result.removed > 0) ++masked;
  }
  return masked;
}
int frames_masked_with_all_techniques() {
  static const int frames = frames_masked_after_stop({});  // once for all tests
  return frames;
}

TEST(Techniques, mover_memory_off_uses_what_has_stopped_sooner) {
  EXPECT_LT(frames_masked_after_stop({&Techniques::mover_memory}), frames_masked_with_all_techniques());
}

TEST(Techniques, arrivals_off_uses_what_has_stopped_later) {
  EXPECT_GT(frames_masked_after_stop({&Techniques::arrivals}), frames_masked_with_all_techniques());
}

TEST(Techniques, look_back_off_leaves_what_creeps) {
  const FeatureVotes votes{{}, {0}, {60}, {}};  // all features of the one cluster have moved
  EXPECT_TRUE(votes.cluster_creeps(0, effective_config(config_of(FilterMode::kRtd, {})).geometry));
  const FilterConfig without = config_of(FilterMode::kRtd, {&Techniques::look_back});
  EXPECT_FALSE(votes.cluster_creeps(0, effective_config(without).geometry));
}

TEST(Techniques, object_drift_off_leaves_a_common_shift) {
  ObjectDrift drift;
  drift.features = 60;
  drift.shift_px = 20;
  drift.sigma_px = 0.2F;
  EXPECT_TRUE(drifts(drift, effective_config(config_of(FilterMode::kRtd, {})).belief));
  const FilterConfig without = config_of(FilterMode::kRtd, {&Techniques::object_drift});
  EXPECT_FALSE(drifts(drift, effective_config(without).belief));
}

TEST(Techniques, mover_tracks_give_a_mover_an_identity) {
  const MovingScene scene;
  FilterConfig config = config_of(FilterMode::kGeometry, {});
  for (const bool on : {false, true}) {
    config.techniques.mover_tracks = on;
    DynamicFilter filter(config, [] { return std::int64_t{0}; });
    std::set<int> ids;
    for (std::uint64_t i = 0; i < 20; ++i) {
      const double block_x = -0.25 + 0.03 * static_cast<double>(i);
      for (const TrackedMover& mover : filter.apply(scene.render(i, 0, block_x), std::nullopt).movers)
        ids.insert(mover.id);
    }
    EXPECT_EQ(ids.size(), on ? 1U : 0U);
  }
}

TEST(Techniques, noise_aware_tau_off_misses_a_person_one_step_in_front_of_the_wall) {
  const cv::Rect block(240, 160, 120, 160);
  vision::RgbdImage now = test::wall_image(3.0);
  test::put_block(now, block, 2.65);
  DepthGridSampler sampler = test::make_sampler();
  View before;
  before.stamp_ns = -500'000'000;
  before.grid = sampler.sample(test::wall_image(3.0));
  before.dynamic.assign(before.grid.depth_m.size(), 0);
  const DepthGrid grid = sampler.sample(now);
  const auto violated = [&](const FilterConfig& config) {
    const auto evidence = check_depth(grid, sampler.rays(), {0, Eigen::Isometry3d::Identity()}, {&before}, now.camera,
                                      effective_config(config).geometry);
    return test::count_in(grid.shape, evidence.violated, block);
  };
  EXPECT_EQ(violated(config_of(FilterMode::kRtd, {})), test::cells_in(block));
  EXPECT_EQ(violated(config_of(FilterMode::kRtd, {&Techniques::noise_aware_tau})), 0);
}

TEST(Techniques, surface_poses_off_leaves_the_camera_to_the_majority) {
  std::mt19937_64 random(5);
  const geometry::CameraModel camera = test::pinhole();
  std::vector<PointSighting> sightings;
  const auto add = [&](int count, const cv::Rect& area, double depth_m, int cluster, double moved_m) {
    std::uniform_real_distribution<double> u(area.x, area.x + area.width), v(area.y, area.y + area.height);
    for (int i = 0; i < count; ++i) {
      const Eigen::Vector2d pixel{u(random), v(random)};
      sightings.push_back(
          {camera.unproject(pixel, depth_m) - Eigen::Vector3d(moved_m, 0, 0), pixel, depth_m, 1.0, cluster});
    }
  };
  add(60, {0, 0, 640, 160}, 3.5, 0, 0);
  add(60, {0, 400, 640, 80}, 2.5, 1, 0);
  add(400, {220, 160, 160, 240}, 1.2, 2, 0.05);  // most features, least of the image
  Eigen::Isometry3d T_world_predicted = Eigen::Isometry3d::Identity();
  T_world_predicted.translation().x() = -0.03;
  const auto error_m = [&](const FilterConfig& config) {
    return find_static_consensus(sightings, camera, T_world_predicted, effective_config(config).ego_motion)
        .T_world_camera.translation()
        .norm();
  };
  EXPECT_LT(error_m(config_of(FilterMode::kRtd, {})), 0.005) << "m";
  EXPECT_GT(error_m(config_of(FilterMode::kRtd, {&Techniques::surface_poses})), 0.02) << "m";
}

TEST(Techniques, more_features_off_extracts_the_usual_number) {
  const MovingScene scene;
  const std::vector<vision::Detection> person{{"person", 0.9F, 240, 110, 160, 240}};
  const auto extracted = [&](std::initializer_list<bool Techniques::*> off) {
    DynamicFilter filter = make_filter(FilterMode::kRtd, off);
    filter.apply(scene.render(0, 0, 0), person);
    return static_cast<double>(filter.apply(scene.render(1, 0, 0), person).features.size());
  };
  EXPECT_NEAR(extracted({}) / extracted({&Techniques::more_features}), 1.5, 0.05);
}

TEST(Techniques, keep_doubtful_off_may_leave_a_frame_without_features) {
  const MovingScene scene;
  const std::vector<vision::Detection> everywhere{{"person", 0.9F, 0, 0, 640, 480}};
  const auto kept = [&](std::initializer_list<bool Techniques::*> off) {
    vision::RgbdImage image = scene.render(0, 0, 0);
    image.depth.setTo(0);  // the whole box is the person
    const FilterResult result = make_filter(FilterMode::kRtd, off).apply(image, everywhere);
    return result.features.size() - result.removed;
  };
  EXPECT_GE(kept({}), static_cast<std::size_t>(FusionConfig{}.min_static_features));
  EXPECT_EQ(kept({&Techniques::keep_doubtful}), 0U);
}

}  // namespace
}  // namespace rtd::filter
