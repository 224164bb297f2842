// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/map_page/map_page.hpp"

#include <gmock/gmock.h>

#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>

#include "common/run_record/run_record.hpp"

namespace rtd::map_page {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

/// What the page's script reads.
json scene_of(const std::string& html) {
  const std::string begin = "id=\"scene\">";
  const std::size_t at = html.find(begin) + begin.size();
  return json::parse(html.substr(at, html.find("</script>", at) - at));
}

Eigen::Vector3d point_of(const json& layer, std::size_t place) {
  const auto bytes = run_record::from_base64(layer["points"].get<std::string>());
  Eigen::Vector3d point;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::int16_t step = 0;
    std::memcpy(&step, bytes.data() + 2 * (3 * place + axis), 2);
    point[static_cast<int>(axis)] = layer["origin"][axis].get<double>() + layer["scale"].get<double>() * step;
  }
  return point;
}

Layer cloud(std::size_t points) {
  Layer layer{.name = "Room"};
  for (std::size_t place = 0; place < points; ++place) {
    layer.points_m.emplace_back(0.001F * static_cast<float>(place), 1, -2);
    layer.colors.push_back({1, 2, static_cast<std::uint8_t>(place % 256)});
  }
  return layer;
}

TEST(MapPage, holds_everything_and_names_no_other_file) {
  const std::string page = html({.title = "walk", .facts = {{"ATE", "1 cm"}}, .layers = {cloud(3)}});
  EXPECT_THAT(page, testing::EndsWith("</html>\n"));
  for (const char* outside : {"http:", "https:", "src=", "@import", "<link", "@SCENE@"})
    EXPECT_THAT(page, Not(HasSubstr(outside)));
  const json scene = scene_of(page);
  EXPECT_EQ(scene["title"], "walk");
  EXPECT_EQ(scene["facts"][0], json({"ATE", "1 cm"}));
  EXPECT_LT((point_of(scene["layers"][0], 2) - Eigen::Vector3d(0.002, 1, -2)).norm(), 1e-4);
  EXPECT_EQ(run_record::from_base64(scene["layers"][0]["colors"].get<std::string>()),
            (std::vector<std::uint8_t>{1, 2, 0, 1, 2, 1, 1, 2, 2}));
}

TEST(MapPage, points_are_thinned_to_the_size_asked_and_lines_are_not) {
  Layer path = cloud(2000);
  path.line = true;
  path.colors.clear();
  const std::string page = html({.layers = {cloud(200'000), path}}, 1'000'000);
  EXPECT_LE(page.size(), 1'000'000U);
  EXPECT_GE(page.size(), 900'000U);
  const json layers = scene_of(page)["layers"];
  EXPECT_EQ(layers[1]["points"].get<std::string>().size(), 2000U * 8);
  EXPECT_GT(point_of(layers[0], 0.99 * layers[0]["colors"].get<std::string>().size() / 4).x(), 195)
      << "over the whole length";
}

TEST(MapPage, points_that_are_not_finite_are_left_out) {
  Layer layer = cloud(2);
  layer.points_m[0].x() = std::numeric_limits<float>::quiet_NaN();
  const json scene = scene_of(html({.layers = {layer, Layer{.name = "none"}}}));
  EXPECT_EQ(run_record::from_base64(scene["layers"][0]["points"].get<std::string>()).size(), 6U);
  EXPECT_EQ(scene["layers"][1]["points"], "");
}

TEST(MapPage, knows_the_other_pages_of_its_run) {
  EXPECT_EQ(scene_of(html({.links = {{"Report", "report.html"}}}))["links"],
            json::parse(R"([["Report", "report.html"]])"));
}

TEST(MapPage, a_title_cannot_end_the_script) {
  const std::string page = html({.title = "</script><script>alert(1)</script>"});
  EXPECT_THAT(page, Not(HasSubstr("<script>alert")));
  EXPECT_EQ(scene_of(page)["title"], "</script><script>alert(1)</script>");
}

}  // namespace
}  // namespace rtd::map_page
