// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "services/filter/core/surfaces/cell_masks.hpp"
#include "services/filter/core/surfaces/object_masks.hpp"
#include "tests/unit/filter/grid_scenes.hpp"

namespace rtd::filter {
namespace {

using test::cells_in;
using test::count_in;
using test::kShape;
using test::put_block;
using test::wall_image;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInf = std::numeric_limits<float>::infinity();

std::vector<SceneObject> find(const vision::RgbdImage& image, const std::vector<vision::Detection>& detections) {
  const DepthGrid grid = test::make_sampler().sample(image);
  std::vector<ObjectBox> boxes;
  for (const vision::Detection& d : usable_detections(detections, MotionLevels{}))
    boxes.push_back({d, -1, 0, false, 0});
  return find_objects(boxes, MotionLevels{}, image.camera, grid, find_depth_clusters(grid, ClusterConfig{}),
                      MaskConfig{});
}
const cv::Rect kPersonPx(240, 120, 120, 280);

/// The one object of that box, whose mask covers an area of the image.
SceneObject find_masked(const vision::RgbdImage& image, const cv::Rect& mask_px, const char* class_name = "person") {
  vision::PersonMasks masks{160, 120, std::vector<std::uint8_t>(160 * 120, 0)};
  for (int row = mask_px.y / 4; row < (mask_px.y + mask_px.height) / 4; ++row) {
    for (int column = mask_px.x / 4; column < (mask_px.x + mask_px.width) / 4; ++column)
      masks.labels[static_cast<std::size_t>(row * 160 + column)] = 1;
  }
  ObjectBox box;
  box.detection = {class_name, 0.9F, 200, 100, 200, 320};
  box.mask = BoxMask(masks, 1, box.detection);
  const DepthGrid grid = test::make_sampler().sample(image);
  const auto found =
      find_objects({box}, MotionLevels{}, image.camera, grid, find_depth_clusters(grid, ClusterConfig{}), MaskConfig{});
  return found.at(0);
}
std::vector<std::uint8_t> mask_of(const std::vector<int>& cells) {
  std::vector<std::uint8_t> mask(160 * 120, 0);
  for (const int cell : cells) mask[static_cast<std::size_t>(cell)] = 1;
  return mask;
}
std::vector<std::uint8_t> mask_of(const SceneObject& object) {
  return mask_of(object.cells);
}

TEST(ObjectMasks, take_the_near_cluster_and_leave_the_background_seen_through_the_box) {
  vision::RgbdImage image = wall_image(3.0);
  put_block(image, {240, 120, 120, 280}, 1.5);
  const auto objects = find(image, {{"person", 0.9F, 200, 100, 200, 320}});
  ASSERT_EQ(objects.size(), 1U);
  EXPECT_FALSE(objects[0].flat);
  EXPECT_EQ(count_in(kShape, mask_of(objects[0]), {240, 120, 120, 280}), cells_in({240, 120, 120, 280}));
  EXPECT_EQ(objects[0].cells.size(), static_cast<std::size_t>(cells_in({240, 120, 120, 280})));
}

TEST(ObjectMasks, holes_near_the_object_are_its_own_within_the_box) {
  vision::RgbdImage image = wall_image(3.0);
  put_block(image, {240, 120, 120, 280}, 1.5);
  put_block(image, {240, 200, 120, 16}, 0);  // a dark belt
  put_block(image, {360, 300, 120, 20}, 0);  // a hole of the wall that begins at the object
  put_block(image, {204, 104, 20, 20}, 0);   // a hole that touches nothing
  const auto objects = find(image, {{"person", 0.9F, 200, 100, 200, 320}});
  ASSERT_EQ(objects.size(), 1U);
  const std::vector<int>& holes = objects[0].holes;
  EXPECT_EQ(count_in(kShape, mask_of(holes), {240, 200, 120, 16}), cells_in({240, 200, 120, 16}));
  EXPECT_EQ(count_in(kShape, mask_of(holes), {360, 300, 8, 20}), cells_in({360, 300, 8, 20}));
  EXPECT_EQ(count_in(kShape, mask_of(holes), {368, 300, 112, 20}), 0);
  EXPECT_EQ(count_in(kShape, mask_of(holes), {204, 104, 20, 20}), 0);
}

TEST(ObjectMasks, holes_in_the_pixels_of_a_person_are_the_person_and_others_are_not) {
  vision::RgbdImage image = wall_image(3.0);
  put_block(image, kPersonPx, 1.5);
  put_block(image, {240, 200, 120, 80}, 0);  // a dark coat, wider than holes_beside() reaches
  put_block(image, {360, 120, 40, 280}, 0);  // the infrared shadow beside the person
  const SceneObject object = find_masked(image, kPersonPx);
  EXPECT_EQ(count_in(kShape, mask_of(object.holes), {240, 200, 120, 80}), cells_in({240, 200, 120, 80}));
  EXPECT_EQ(count_in(kShape, mask_of(object.holes), {368, 120, 32, 280}), 0);
  EXPECT_EQ(count_in(kShape, mask_of(object.around), {368, 120, 32, 280}), cells_in({368, 120, 32, 280}));
  EXPECT_EQ(count_in(kShape, mask_of(object.around), {360, 120, 4, 280}), 0) << "within a cell of the mask";
}

TEST(ObjectMasks, what_a_person_has_grown_together_with_is_cut_by_the_pixels) {
  vision::RgbdImage image = wall_image(3.0);
  put_block(image, {240, 120, 400, 280}, 1.5);  // the person and a cupboard, one cluster
  const SceneObject object = find_masked(image, kPersonPx);
  EXPECT_EQ(count_in(kShape, mask_of(object), kPersonPx), cells_in(kPersonPx));
  EXPECT_EQ(count_in(kShape, mask_of(object), {364, 120, 36, 280}), 0);
  EXPECT_FALSE(object.flat);
}

TEST(ObjectMasks, a_cluster_that_lies_in_the_box_is_the_object_whatever_the_network_missed) {
  vision::RgbdImage image = wall_image(3.0);
  put_block(image, kPersonPx, 1.5);
  const SceneObject object = find_masked(image, {240, 120, 120, 160});  // without the legs
  EXPECT_EQ(object.cells.size(), static_cast<std::size_t>(cells_in(kPersonPx)));
  EXPECT_EQ(count_in(kShape, mask_of(object.around), kPersonPx), 0);
}

TEST(ObjectMasks, the_pixels_choose_between_two_surfaces_in_a_box) {
  vision::RgbdImage image = wall_image(3.0);
  put_block(image, {200, 300, 200, 120}, 1.0);  // a chair in front of the person
  put_block(image, {240, 120, 120, 180}, 1.8);
  const SceneObject object = find_masked(image, {240, 120, 120, 180});
  EXPECT_EQ(count_in(kShape, mask_of(object), {240, 120, 120, 180}), cells_in({240, 120, 120, 180}));
  EXPECT_EQ(count_in(kShape, mask_of(object), {200, 304, 200, 116}), 0);
}

TEST(ObjectMasks, the_pixels_cut_a_box_in_which_nothing_was_measured) {
  vision::RgbdImage image = wall_image(3.0);
  image.depth.setTo(0);
  const SceneObject object = find_masked(image, kPersonPx);
  EXPECT_EQ(count_in(kShape, mask_of(object), kPersonPx), cells_in(kPersonPx));
  EXPECT_EQ(count_in(kShape, mask_of(object), {364, 100, 36, 320}), 0);
}

TEST(ObjectMasks, pixels_count_for_people_only) {
  vision::RgbdImage image = wall_image(3.0);
  put_block(image, kPersonPx, 1.5);
  const SceneObject chair = find_masked(image, {240, 120, 60, 280}, "chair");
  EXPECT_EQ(chair.cells.size(), static_cast<std::size_t>(cells_in(kPersonPx)));
  EXPECT_TRUE(chair.around.empty());
}

TEST(ObjectMasks, pixels_lie_where_the_lens_shows_them) {
  vision::RgbdImage image = wall_image(3.0);
  auto parameters = image.camera.parameters();
  parameters.distortion = {0.26, -0.95, -0.005, 0.003, 1.16};  // fr1
  image.camera = geometry::CameraModel(parameters);
  put_block(image, kPersonPx, 1.5);
  const SceneObject object = find_masked(image, kPersonPx);
  for (const int cell : object.cells) {
    const Eigen::Vector2d raw_px = image.camera.distort({4 * (cell % 160) + 1.5, 4 * (cell / 160) + 1.5});
    EXPECT_GE(raw_px.x(), kPersonPx.x - 8);
    EXPECT_LE(raw_px.x(), kPersonPx.x + kPersonPx.width + 8);
  }
  EXPECT_GE(object.cells.size() + object.holes.size(), 0.9 * cells_in(kPersonPx));
}

TEST(ObjectMasks, include_what_the_box_cut_off) {
  vision::RgbdImage image = wall_image(3.0);
  put_block(image, {240, 100, 120, 380}, 1.5);
  const auto objects = find(image, {{"person", 0.9F, 230, 100, 140, 240}});  // ends above the feet
  ASSERT_EQ(objects.size(), 1U);
  EXPECT_EQ(count_in(kShape, mask_of(objects[0]), {240, 100, 120, 380}), cells_in({240, 100, 120, 380}));
}

TEST(ObjectMasks, add_an_arm_that_a_depth_step_cut_off) {
  vision::RgbdImage image = wall_image(3.0);
  put_block(image, {240, 100, 120, 360}, 1.5);
  put_block(image, {360, 200, 60, 40}, 1.2);
  const auto objects = find(image, {{"person", 0.9F, 230, 90, 200, 380}});
  ASSERT_EQ(objects.size(), 1U);
  EXPECT_EQ(count_in(kShape, mask_of(objects[0]), {364, 204, 52, 32}), cells_in({364, 204, 52, 32}));
}

TEST(ObjectMasks, call_a_person_on_a_poster_flat) {
  const auto objects = find(wall_image(2.0), {{"person", 0.8F, 200, 100, 100, 200}});
  ASSERT_EQ(objects.size(), 1U);
  EXPECT_TRUE(objects[0].flat);
}

TEST(ObjectMasks, cover_the_whole_box_where_nothing_was_measured) {
  vision::RgbdImage image = wall_image();
  image.depth.setTo(0);
  const auto objects = find(image, {{"person", 0.8F, 200, 100, 100, 200}});
  ASSERT_EQ(objects.size(), 1U);
  EXPECT_EQ(count_in(kShape, mask_of(objects[0]), {200, 100, 100, 200}), cells_in({200, 100, 100, 200}));
}

TEST(ObjectMasks, separate_an_object_from_what_it_touches) {
  DepthClusters clusters{kShape, std::vector<std::int32_t>(160 * 120, 0), {160 * 120}};
  SceneObject object{"person", 0.9F, MotionLevel::kHigh, {10, 11, 12}, false};
  SceneObject poster{"person", 0.9F, MotionLevel::kHigh, {50, 51}, true};
  const DepthClusters parted = separate_objects(clusters, {object, poster});
  EXPECT_EQ(parted.count(), 2);
  EXPECT_EQ(parted.cells[0], 160 * 120 - 3);
  EXPECT_EQ(parted.label[11], 1);
  EXPECT_EQ(parted.label[50], 0) << "a picture belongs to its wall";
}

TEST(ObjectMasks, ignore_classes_without_motion_level) {
  EXPECT_TRUE(find(wall_image(), {{"traffic light", 0.9F, 100, 100, 50, 50}}).empty());
}

TEST(ObjectMasks, reject_invalid_boxes) {
  const vision::RgbdImage image = wall_image();
  EXPECT_TRUE(find(image, {{"person", 0.9F, kNan, 0, 100, 100}}).empty());
  EXPECT_TRUE(find(image, {{"person", 0.9F, 0, 0, kInf, 100}}).empty());
  EXPECT_TRUE(find(image, {{"person", kNan, 0, 0, 100, 100}}).empty());
  EXPECT_TRUE(find(image, {{"person", 0.9F, 100, 100, -50, 100}}).empty());
  EXPECT_TRUE(find(image, {{"person", 0.9F, 100, 100, 0, 0}}).empty());
  EXPECT_TRUE(find(image, {{"person", 0.9F, 5000, 5000, 100, 100}}).empty());
  EXPECT_TRUE(find(image, {{"person", 0.9F, -3e38F, 0, 3e38F, 100}}).empty());
}

TEST(ObjectMasks, cut_a_box_at_the_image_border) {
  const auto objects = find(wall_image(), {{"person", 0.9F, -100, -100, 1000, 1000}});
  ASSERT_EQ(objects.size(), 1U);
  for (const int cell : objects[0].cells) EXPECT_LT(cell, kShape.size());
}

TEST(ObjectMasks, keep_the_best_of_ten_thousand_boxes) {
  std::vector<vision::Detection> many(10'000, {"person", 0.3F, 100, 100, 50, 50});
  many[7'000].score = 0.99F;
  const auto objects = find(wall_image(), many);
  ASSERT_EQ(objects.size(), kMaxObjects);
  EXPECT_FLOAT_EQ(objects[0].score, 0.99F);
}

const vision::Detection kBox{"person", 0.9F, 100, 100, 80, 200};

/// Labels of a 640x480 image: label 2 on the pixels 120..159 x 140..259, label 1 below them.
vision::PersonMasks labels() {
  vision::PersonMasks masks{160, 120, std::vector<std::uint8_t>(160 * 120, 0)};
  for (int row = 35; row < 100; ++row) {
    for (int column = 30; column < 40; ++column)
      masks.labels[static_cast<std::size_t>(row * 160 + column)] = row < 65 ? 2 : 1;
  }
  return masks;
}

TEST(BoxMask, covers_the_pixels_of_its_label) {
  const BoxMask mask(labels(), 2, kBox);
  EXPECT_FALSE(mask.empty());
  EXPECT_TRUE(mask.covers({120, 140}, kBox));
  EXPECT_TRUE(mask.covers({159, 259}, kBox));
  EXPECT_FALSE(mask.covers({119, 140}, kBox));
  EXPECT_FALSE(mask.covers({160, 140}, kBox));
  EXPECT_FALSE(mask.covers({140, 260}, kBox)) << "another label";
}

TEST(BoxMask, moves_and_grows_with_its_box) {
  const BoxMask mask(labels(), 2, kBox);
  const vision::Detection now{"person", 0.9F, 200, 50, 160, 400};  // twice as large
  EXPECT_TRUE(mask.covers({200 + 2 * 21, 50 + 2 * 41}, now));
  EXPECT_TRUE(mask.covers({200 + 2 * 59, 50 + 2 * 159}, now));
  EXPECT_FALSE(mask.covers({200 + 2 * 18, 50 + 2 * 41}, now));
  EXPECT_FALSE(mask.covers({200 + 2 * 62, 50 + 2 * 41}, now));
}

TEST(BoxMask, is_empty_where_no_place_has_its_label) {
  EXPECT_TRUE(BoxMask(labels(), 3, kBox).empty());
  EXPECT_TRUE(BoxMask(labels(), 0, kBox).empty()) << "the label of no detection";
  EXPECT_TRUE(BoxMask({}, 1, kBox).empty());
  EXPECT_FALSE(BoxMask().covers({120, 140}, kBox));
}

TEST(BoxMask, is_empty_when_labels_are_missing) {
  vision::PersonMasks cut = labels();
  cut.labels.pop_back();
  EXPECT_TRUE(BoxMask(cut, 2, kBox).empty());
  cut.columns = -160;
  EXPECT_TRUE(BoxMask(cut, 2, kBox).empty());
}

const GridShape kSmallShape{10, 8};

CellMask rectangle(int left, int top, int width, int height, std::uint8_t value = 1) {
  CellMask mask(static_cast<std::size_t>(kSmallShape.size()), 0);
  for (int y = top; y < top + height; ++y) {
    for (int x = left; x < left + width; ++x) mask[static_cast<std::size_t>(kSmallShape.index(x, y))] = value;
  }
  return mask;
}
auto set_cells(const CellMask& mask) {
  return std::count_if(mask.begin(), mask.end(), [](int v) { return v > 0; });
}

TEST(CellMasks, dilate_grows_by_the_radius_and_stops_at_the_border) {
  EXPECT_EQ(dilate(kSmallShape, rectangle(3, 3, 2, 2, 7), 1), rectangle(2, 2, 4, 4, 7));
  EXPECT_EQ(dilate(kSmallShape, rectangle(0, 0, 1, 1), 2), rectangle(0, 0, 3, 3));
  EXPECT_EQ(dilate(kSmallShape, rectangle(3, 3, 2, 2), 0), rectangle(3, 3, 2, 2));
}

TEST(CellMasks, compact_clears_lines_and_keeps_areas) {
  EXPECT_EQ(set_cells(compact(kSmallShape, rectangle(0, 3, 10, 1))), 0) << "a line one cell wide";
  EXPECT_EQ(set_cells(compact(kSmallShape, rectangle(2, 2, 5, 4))), 5 * 4 - 4) << "an area loses its corners";
}

TEST(CellMasks, keep_regions_asks_for_each_connected_region) {
  CellMask mask = rectangle(0, 0, 2, 2);
  const CellMask large = rectangle(5, 2, 4, 4);
  for (std::size_t i = 0; i < mask.size(); ++i) mask[i] = std::max(mask[i], large[i]);
  std::vector<std::size_t> sizes;
  const CellMask kept = keep_regions(kSmallShape, mask, [&](const std::vector<int>& region) {
    sizes.push_back(region.size());
    return region.size() > 10;
  });
  EXPECT_EQ(sizes, (std::vector<std::size_t>{4, 16}));
  EXPECT_EQ(kept, large);
}

}  // namespace
}  // namespace rtd::filter
