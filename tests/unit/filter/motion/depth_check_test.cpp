// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/motion/depth_check.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "tests/unit/filter/grid_scenes.hpp"

namespace rtd::filter {
namespace {

using test::cells_in;
using test::count_in;
using test::kBlock;
using test::kShape;
using test::put_block;
using test::wall_image;

View view_of(const vision::RgbdImage& image, double age_s = 0.5) {
  View view;
  view.stamp_ns = -static_cast<std::int64_t>(age_s * 1e9);
  view.grid = test::make_sampler().sample(image);
  view.dynamic.assign(view.grid.depth_m.size(), 0);
  return view;
}
/// What the references say of `now`, seen by a camera at stamp 0.
DepthEvidence check(const vision::RgbdImage& now, const std::vector<View>& references,
                    const Eigen::Isometry3d& T_world_camera = Eigen::Isometry3d::Identity()) {
  DepthGridSampler sampler = test::make_sampler();
  const DepthGrid grid = sampler.sample(now);
  std::vector<const View*> pointers;
  for (const View& view : references) pointers.push_back(&view);
  return check_depth(grid, sampler.rays(), {0, T_world_camera}, pointers, now.camera, GeometryConfig{});
}
vision::RgbdImage with_block(const cv::Rect& area, double block_m = 1.5) {
  vision::RgbdImage image = wall_image(3.0);
  put_block(image, area, block_m);
  return image;
}
int count(const std::vector<std::uint8_t>& cells) {
  return static_cast<int>(std::count_if(cells.begin(), cells.end(), [](int v) { return v > 0; }));
}

TEST(DepthCheck, finds_a_block_that_stands_where_the_view_saw_the_wall) {
  const DepthEvidence evidence = check(with_block(kBlock), {view_of(wall_image(3.0))});
  EXPECT_EQ(count_in(kShape, evidence.violated, kBlock), cells_in(kBlock));
  EXPECT_EQ(count(evidence.violated), cells_in(kBlock)) << "and nothing else";
}

TEST(DepthCheck, finds_a_resting_block_and_wall_at_their_place) {
  const DepthEvidence evidence = check(with_block(kBlock), {view_of(with_block(kBlock))});
  EXPECT_EQ(count(evidence.violated), 0);
  EXPECT_GT(count_in(kShape, evidence.consistent, kBlock), cells_in(kBlock) * 9 / 10);
  EXPECT_GT(count_in(kShape, evidence.lasting, kBlock), cells_in(kBlock) * 9 / 10);
}

TEST(DepthCheck, makes_no_statement_about_background_that_was_hidden) {
  const DepthEvidence evidence = check(wall_image(3.0), {view_of(with_block(kBlock))});
  EXPECT_EQ(count(evidence.violated), 0) << "the mover has gone: what it hid is not dynamic";
  const cv::Rect inside(260, 180, 80, 120);
  EXPECT_EQ(count_in(kShape, evidence.consistent, inside), 0);
}

TEST(DepthCheck, does_not_take_the_motion_of_the_camera_for_motion) {
  // The camera moves 0.1 m to the right: the wall stays, the block shifts by f x / z.
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
  T_world_camera.translation().x() = 0.1;
  const int shift_px = static_cast<int>(525 * 0.1 / 1.5);
  const vision::RgbdImage now = with_block(kBlock - cv::Point(shift_px, 0));
  EXPECT_EQ(count(check(now, {view_of(with_block(kBlock))}, T_world_camera).violated), 0);
  EXPECT_GT(count(check(now, {view_of(with_block(kBlock))}).violated), 0) << "with a wrong pose it would";
}

TEST(DepthCheck, needs_a_difference_beyond_the_noise) {
  const double tau_m = 0.08 + 5 * std::numbers::sqrt2 * (0.001 + 0.0015 * 9);  // at 3 m, Eq. (4)
  const std::vector<View> reference{view_of(wall_image(3.0))};
  EXPECT_EQ(count(check(with_block(kBlock, 3.0 - 0.8 * tau_m), reference).violated), 0);
  EXPECT_GT(count(check(with_block(kBlock, 3.0 - 1.2 * tau_m), reference).violated), 0);
}

TEST(DepthCheck, makes_no_statement_when_the_rays_differ_by_more_than_thirty_degrees) {
  for (const double degrees : {20.0, 40.0}) {
    // The reference camera has gone around the block and looks at it under an angle.
    const double angle = degrees * std::numbers::pi / 180;
    const Eigen::Vector3d centre(0, 0, 1.5);
    View reference = view_of(wall_image(3.0));
    reference.T_world_camera = Eigen::Translation3d(centre) * Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()) *
                               Eigen::Translation3d(-centre);
    const DepthEvidence evidence = check(with_block({300, 220, 40, 40}), {reference});
    EXPECT_EQ(count_in(kShape, evidence.violated, {304, 224, 32, 32}) > 0, degrees < 30) << degrees << " degrees";
  }
}

TEST(DepthCheck, needs_two_of_four_views_to_agree) {
  std::vector<View> references(4, view_of(with_block(kBlock)));
  references[3] = view_of(wall_image(3.0), 1.0);
  EXPECT_EQ(count(check(with_block(kBlock), references).violated), 0);
  references[2] = view_of(wall_image(3.0), 0.8);
  EXPECT_EQ(count(check(with_block(kBlock), references).violated), cells_in(kBlock));
}

TEST(DepthCheck, distinguishes_what_has_arrived_and_stayed_from_what_arrives) {
  std::vector<View> references{view_of(with_block(kBlock), 0.1), view_of(with_block(kBlock), 0.5),
                               view_of(wall_image(3.0), 1.0), view_of(wall_image(3.0), 30.0)};
  EXPECT_EQ(count(check(with_block(kBlock), references).settled),
            count(check(with_block(kBlock), references).violated));
  EXPECT_EQ(count(check(with_block(kBlock), references).violated), cells_in(kBlock));
  references[0] = view_of(wall_image(3.0), 0.1);
  EXPECT_EQ(count(check(with_block(kBlock), references).settled), 0) << "it was not there just now";
  references[0] = references[1] = view_of(with_block(kBlock), 0.1);
  EXPECT_EQ(count(check(with_block(kBlock), references).settled), 0) << "it has not been there for long";
}

TEST(DepthCheck, does_not_take_dynamic_cells_as_evidence_of_rest) {
  View reference = view_of(with_block(kBlock));
  reference.dynamic.assign(reference.dynamic.size(), 1);
  EXPECT_EQ(count(check(with_block(kBlock), {reference}).consistent), 0);
}

TEST(DepthCheck, says_nothing_without_depth) {
  vision::RgbdImage blind = wall_image();
  blind.depth.setTo(0);
  for (const DepthEvidence& evidence :
       {check(blind, {view_of(wall_image())}), check(wall_image(), {view_of(blind)}), check(wall_image(), {})}) {
    EXPECT_EQ(count(evidence.violated) + count(evidence.consistent), 0);
  }
}

}  // namespace
}  // namespace rtd::filter
