// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/plot/chart.hpp"

#include <gmock/gmock.h>

#include <limits>

namespace rtd::plot {
namespace {

using namespace ::testing;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(NiceTicks, are_round_and_inside_the_range) {
  EXPECT_THAT(nice_ticks({0, 10}, 5), ElementsAre(0, 2, 4, 6, 8, 10));
  EXPECT_THAT(nice_ticks({-0.31, 0.72}, 5), Pointwise(DoubleNear(1e-12), {-0.2, 0.0, 0.2, 0.4, 0.6}));
  EXPECT_THAT(nice_ticks({0.0012, 0.0049}, 4), Pointwise(DoubleNear(1e-12), {0.002, 0.003, 0.004}));
  EXPECT_THAT(nice_ticks({1, 1}, 5), IsEmpty());
  EXPECT_THAT(nice_ticks({0, kNan}, 5), IsEmpty());
}

TEST(TickLabel, has_the_decimals_of_its_step) {
  EXPECT_EQ(tick_label(0.5, 0.5), "0.5");
  EXPECT_EQ(tick_label(20, 10), "20");
  EXPECT_EQ(tick_label(0.002, 0.001), "0.002");
  EXPECT_EQ(tick_label(2, 2), "2");
}

TEST(RangeOf, ignores_values_that_are_not_finite) {
  const Range range = range_of({3, kNan, -1, std::numeric_limits<double>::infinity(), 2});
  EXPECT_EQ(range.min, -1);
  EXPECT_EQ(range.max, 3);
}

TEST(RangeOf, is_never_empty) {
  EXPECT_GT(range_of({}).span(), 0);
  EXPECT_GT(range_of({5, 5, 5}).span(), 0);
  EXPECT_GT(range_of({1e12, 1e12}).span(), 0);
}

TEST(Chart, maps_data_with_y_upwards) {
  Svg svg(100, 100, "test");
  const Chart chart(svg, {10, 20, 80, 60}, {0, 4}, {-1, 1});
  EXPECT_EQ(chart.at(0, -1).x, 10);
  EXPECT_EQ(chart.at(0, -1).y, 80);
  EXPECT_EQ(chart.at(4, 1).x, 90);
  EXPECT_EQ(chart.at(4, 1).y, 20);
}

TEST(Chart, equal_aspect_shows_a_square_as_a_square) {
  Svg svg(400, 100, "test");
  const Chart chart = Chart::equal_aspect(svg, {0, 0, 400, 100}, {2, 3}, {-1, 0});
  const Point low = chart.at(2, -1), high = chart.at(3, 0);
  EXPECT_NEAR(high.x - low.x, low.y - high.y, 1e-9);
  EXPECT_NEAR((high.x + low.x) / 2, 200, 1e-9);
}

TEST(Chart, curve_is_interrupted_at_gaps_and_at_missing_values) {
  Svg svg(100, 100, "test");
  Chart chart(svg, {0, 0, 100, 100}, {0, 10}, {0, 1});
  const auto lines = [](const std::string& text) {
    std::size_t count = 0;
    for (std::size_t at = text.find("<polyline"); at != std::string::npos; at = text.find("<polyline", at + 1)) ++count;
    return count;
  };
  chart.curve({0, 1, 2, 6, 7}, {0, 0, 0, 1, 1}, {"#000000"}, 2);
  EXPECT_EQ(lines(svg.document()), 2U);
  Svg other(100, 100, "test");
  Chart(other, {0, 0, 100, 100}, {0, 10}, {0, 1}).curve({0, 1, 2, 3, 4}, {0, 0, kNan, 1, 1}, {"#000000"}, 2);
  EXPECT_EQ(lines(other.document()), 2U);
}

TEST(Svg, leaves_out_what_is_not_finite) {
  Svg svg(100, 100, "test");
  svg.line({0, kNan}, {1, 1}, {"#000000"});
  svg.circle({kNan, 0}, 3, "#000000");
  svg.text({0, kNan}, "lost");
  svg.rect({0, 0, kNan, 1}, "#000000");
  svg.polyline({{0, 0}, {kNan, 1}, {2, 2}}, {"#000000"});
  svg.dots({{kNan, 1}}, 3, "#000000");
  EXPECT_THAT(svg.document(), Not(HasSubstr("nan")));
  EXPECT_THAT(svg.document(), HasSubstr("points=\"0,0 2,2\""));
  EXPECT_THAT(svg.document(), Not(HasSubstr("lost")));
}

TEST(Svg, escapes_text) {
  Svg svg(100, 100, "a<b");
  svg.text({0, 0}, "<script>\"&'");
  EXPECT_THAT(svg.document(), HasSubstr("&lt;script&gt;&quot;&amp;&#39;"));
  EXPECT_THAT(svg.document(), HasSubstr("aria-label=\"a&lt;b\""));
}

}  // namespace
}  // namespace rtd::plot
