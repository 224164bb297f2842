// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/dense/core/static_map.hpp"

#include <gmock/gmock.h>

#include <cstring>
#include <sstream>

#include "common/geometry/ply.hpp"
#include "services/dense/dense_service.hpp"

namespace rtd::dense {
namespace {

const std::vector<CloudPoint> kPoints{{{1, 2, 3}, {10.4F, 20, 30}, 0.5F}, {{-1, 0, 2.5F}, {-4, 255.4F, 300}, 7}};

TEST(Ply, holds_every_point_as_its_header_declares) {
  std::stringstream file;
  write_ply(file, kPoints);
  const std::string text = file.str();
  EXPECT_EQ(geometry::ply_vertices(file), 2U);
  EXPECT_THAT(text, testing::StartsWith("ply\nformat binary_little_endian 1.0\n"));
  EXPECT_THAT(text, testing::HasSubstr("property float x\nproperty float y\nproperty float z\nproperty uchar red\n"));
  const std::size_t body = text.find("end_header\n") + 11;
  ASSERT_EQ(text.size() - body, 2U * 19U);
  float x = 0, weight = 0;
  std::memcpy(&x, text.data() + body, 4);
  std::memcpy(&weight, text.data() + body + 15, 4);
  EXPECT_EQ(x, 1.0F);
  EXPECT_EQ(weight, 0.5F);
  EXPECT_EQ(text.substr(body + 12, 3), std::string("\x1e\x14\x0a")) << "red green blue";
  EXPECT_EQ(text.substr(body + 19 + 12, 3), std::string("\xff\xff\x00", 3)) << "clamped";
}

TEST(Ply, header_of_something_else_announces_nothing) {
  for (const char* text : {"", "plx\nelement vertex 3\nend_header\n", "ply\nend_header\nelement vertex 3\n",
                           "ply\nelement vertex -3\nend_header\n", "ply\nelement vertex many\nend_header\n"}) {
    std::istringstream file(text);
    EXPECT_EQ(geometry::ply_vertices(file), std::nullopt) << text;
  }
}

TEST(PointCloud, merges_by_cell_with_weights) {
  const auto merged =
      merge_by_cell({{{0.01F, 0, 0}, {0, 0, 0}, 1}, {{0.05F, 0, 0}, {100, 0, 0}, 3}, {{-0.01F, 0, 0}, {}, 1}}, 0.1);
  ASSERT_EQ(merged.size(), 2U);
  EXPECT_NEAR(merged[0].p_world.x(), 0.04, 1e-6);
  EXPECT_NEAR(merged[0].bgr[0], 75, 1e-4);
  EXPECT_FLOAT_EQ(merged[0].weight, 4);
}

TEST(CloudMessage, has_the_fields_that_viewers_expect) {
  const msg::PointCloud2 cloud = make_cloud(kPoints, 1'500'000'000, "map");
  EXPECT_EQ(cloud.header.frame_id, "map");
  EXPECT_EQ(cloud.width, 2U);
  ASSERT_EQ(cloud.fields.size(), 4U);
  EXPECT_EQ(cloud.fields[3].name, "rgb");
  ASSERT_EQ(cloud.data.size(), 32U);
  EXPECT_THAT(std::vector(cloud.data.begin() + 12, cloud.data.begin() + 16), testing::ElementsAre(10, 20, 30, 0));
}

TEST(MaskMessage, becomes_cells_or_is_refused) {
  msg::Image image;
  image.encoding = "mono8";
  image.width = 2;
  image.height = 2;
  image.step = 3;
  image.data = {1, 2, 9, 3, 4, 9};
  ASSERT_TRUE(from_message(image));
  EXPECT_THAT(from_message(image)->cells, testing::ElementsAre(1, 2, 3, 4));
  const auto broken = [&image](auto change) {
    msg::Image other = image;
    change(other);
    return !from_message(other);
  };
  EXPECT_TRUE(broken([](auto& i) { i.encoding = "bgr8"; }));
  EXPECT_TRUE(broken([](auto& i) { i.data.pop_back(); }));
  EXPECT_TRUE(broken([](auto& i) { i.step = 1; }));
  EXPECT_TRUE(broken([](auto& i) { i.width = 0; }));
  EXPECT_TRUE(broken([](auto& i) { i.width = i.height = 0xffffffff; }));
}

TEST(DynamicMask, grows_and_is_unknown_outside) {
  DynamicMask mask{5, 4, std::vector<std::uint8_t>(20, 0)};
  mask.cells[0] = DynamicMask::kDynamic;
  mask.cells[19] = DynamicMask::kUnknown;
  const DynamicMask wide = grow(mask, 1);
  EXPECT_THAT(wide.cells,
              testing::ElementsAre(255, 255, 0, 0, 0, 255, 255, 0, 0, 0, 0, 0, 0, 128, 128, 0, 0, 0, 128, 128));
  EXPECT_EQ(wide.at(7, 7, 20, 16), DynamicMask::kDynamic);
  EXPECT_EQ(wide.at(8, 0, 20, 16), DynamicMask::kStatic);
  EXPECT_EQ(wide.at(-1, 0, 20, 16), DynamicMask::kUnknown);
  EXPECT_EQ(wide.at(20, 3, 20, 16), DynamicMask::kUnknown);
}

}  // namespace
}  // namespace rtd::dense
