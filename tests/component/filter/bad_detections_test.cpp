// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// Whatever a broken or hostile detector sends must not harm what the filter does without it.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "common/service/monotonic_clock.hpp"
#include "tests/unit/filter/moving_scene.hpp"

namespace rtd::filter {
namespace {

using test::MovingScene;

constexpr float kFloatNan = std::numeric_limits<float>::quiet_NaN(), kFloatInf = std::numeric_limits<float>::infinity();
constexpr std::int64_t kSecondNs = 1'000'000'000;
using Updates = std::function<DetectorUpdate(std::int64_t stamp_ns)>;

/// Ten frames of a block that passes; rendered once for all tests.
const std::vector<vision::RgbdImage>& frames() {
  static const std::vector<vision::RgbdImage> rendered = [] {
    const MovingScene scene;
    std::vector<vision::RgbdImage> images;
    for (std::uint64_t i = 0; i < 10; ++i) {
      images.push_back(scene.render(i, 0.008 * static_cast<double>(i), -0.25 + 0.03 * static_cast<double>(i)));
      images.back().stamp_ns += 100 * kSecondNs;
    }
    return images;
  }();
  return rendered;
}

/// The results of the ten frames with the detector's update for each.
std::vector<FilterResult> run(const Updates& updates) {
  DynamicFilter filter(FilterConfig{}, service::monotonic_ns);
  std::vector<FilterResult> results;
  for (const vision::RgbdImage& image : frames()) results.push_back(filter.apply(image, updates(image.stamp_ns)));
  return results;
}

/// A detector that finds nothing in any frame.
const std::vector<FilterResult>& without_boxes() {
  static const std::vector<FilterResult> results = run([](std::int64_t stamp_ns) {
    return DetectorUpdate{true, {{stamp_ns, {}}}};
  });
  return results;
}

/// A detector that is running but publishes nothing.
const std::vector<FilterResult>& without_batches() {
  static const std::vector<FilterResult> results = run([](std::int64_t) { return DetectorUpdate{true, {}}; });
  return results;
}

void expect_same(const Updates& updates, const std::vector<FilterResult>& expected) {
  const std::vector<FilterResult> results = run(updates);
  for (std::size_t i = 0; i < results.size(); ++i) {
    ASSERT_EQ(results[i].features.size(), expected[i].features.size()) << "frame " << i;
    EXPECT_EQ(results[i].removed, expected[i].removed) << "frame " << i;
    EXPECT_EQ(std::memcmp(results[i].features.data(), expected[i].features.data(),
                          expected[i].features.size() * sizeof(msg::Feature)),
              0)
        << "frame " << i;
  }
}

/// The same boxes with every frame.
Updates always(const std::vector<vision::Detection>& boxes) {
  return [boxes](std::int64_t stamp_ns) { return DetectorUpdate{true, {{stamp_ns, boxes}}}; };
}

vision::Detection person(float x_px, float y_px, float width_px, float height_px, float score = 0.9F) {
  return {"person", score, x_px, y_px, width_px, height_px};
}

TEST(BadDetections, outside_the_image_count_as_none) {
  expect_same(always({person(-400, 10, 200, 200), person(700, 10, 200, 200), person(10, -300, 50, 200),
                      person(10, 500, 50, 200), person(1e4F, 1e4F, 10, 10)}),
              without_boxes());
}

TEST(BadDetections, of_impossible_size_count_as_none) {
  expect_same(always({person(10, 10, 0, 100), person(10, 10, -100, 100), person(10, 10, 100, -1),
                      person(300, 100, 1e-6F, 1e-6F), person(-1e30F, -1e30F, 2e30F, 2e30F)}),
              without_boxes());
}

TEST(BadDetections, with_numbers_that_are_not_finite_count_as_none) {
  std::vector<vision::Detection> boxes;
  for (const float bad : {kFloatNan, kFloatInf, -kFloatInf}) {
    boxes.insert(boxes.end(), {person(bad, 10, 100, 100), person(10, bad, 100, 100), person(10, 10, bad, 100),
                               person(10, 10, 100, bad)});
  }
  expect_same(always(boxes), without_boxes());
}

TEST(BadDetections, with_a_score_that_is_not_finite_count_as_none) {
  for (const float score : {kFloatNan, kFloatInf, -kFloatInf}) {
    SCOPED_TRACE(score);
    expect_same(always({person(200, 100, 200, 250, score)}), without_boxes());
  }
}

TEST(BadDetections, of_unknown_classes_count_as_none) {
  std::vector<vision::Detection> boxes;
  for (const char* name : {"", "unicorn", "Person", "person ", "\xff\xfe"})
    boxes.push_back({name, 0.9F, 100, 100, 200, 200});
  boxes.push_back({std::string(100'000, 'x'), 0.9F, 100, 100, 200, 200});
  expect_same(always(boxes), without_boxes());
}

TEST(BadDetections, as_large_as_the_image_leave_features_to_slam) {
  const std::vector<FilterResult> results = run(always({person(0, 0, 640, 480)}));
  const FilterResult& last = results.back();
  EXPECT_GT(last.features.size() - last.removed, 100U);
}

TEST(BadDetections, ten_thousand_of_them_take_less_than_half_a_second_per_frame) {
  std::vector<vision::Detection> boxes;
  for (int i = 0; i < 10'000; ++i) {
    const auto n = static_cast<float>(i);
    boxes.push_back(person(std::fmod(n * 37, 600), std::fmod(n * 53, 440), 10 + std::fmod(n * 7, 300),
                           10 + std::fmod(n * 11, 300), 0.3F + std::fmod(n * 0.013F, 0.6F)));
  }
  const std::int64_t started_ns = service::monotonic_ns();
  const std::vector<FilterResult> results = run(always(boxes));
  const double bounded_s = 10 * 0.5;  // on a busy host; 0.02 s a frame on a quiet one
  EXPECT_LT(static_cast<double>(service::monotonic_ns() - started_ns) * 1e-9, bounded_s);
  for (const FilterResult& result : results) {
    EXPECT_LE(result.objects.size(), 64U);
    for (const msg::Feature& feature : result.features) ASSERT_TRUE(std::isfinite(feature.static_probability));
  }
}

TEST(BadDetections, of_the_future_count_as_none) {
  const std::vector<vision::Detection> boxes{person(200, 100, 200, 250)};
  for (const std::int64_t ahead_ns : {kSecondNs, 3600 * kSecondNs, std::numeric_limits<std::int64_t>::max() / 2}) {
    SCOPED_TRACE(ahead_ns);
    expect_same(
        [&](std::int64_t stamp_ns) {
          return DetectorUpdate{true, {{stamp_ns + ahead_ns, boxes}}};
        },
        without_batches());
  }
}

TEST(BadDetections, of_long_ago_count_as_none) {
  const std::vector<vision::Detection> boxes{person(200, 100, 200, 250)};
  for (const std::int64_t old_ns :
       {std::int64_t{0}, 60 * kSecondNs, std::numeric_limits<std::int64_t>::min(), std::int64_t{-1}}) {
    SCOPED_TRACE(old_ns);
    expect_same([&](std::int64_t) { return DetectorUpdate{true, {{old_ns, boxes}}}; }, without_batches());
  }
}

TEST(BadDetections, in_any_order_and_duplicated_do_no_harm) {
  const std::vector<vision::Detection> boxes{person(200, 100, 200, 250)};
  const std::vector<FilterResult> results = run([&](std::int64_t stamp_ns) {
    DetectorUpdate update{true, {}};
    for (const std::int64_t offset_ns :
         std::vector<std::int64_t>{33'333'333, -66'666'666, 0, 0, -33'333'333, -kSecondNs}) {
      update.batches.push_back({stamp_ns + offset_ns, boxes});
    }
    return update;
  });
  for (const FilterResult& result : results) {
    EXPECT_GT(result.features.size(), 500U);
    for (const msg::Feature& feature : result.features) ASSERT_TRUE(std::isfinite(feature.static_probability));
  }
}

}  // namespace
}  // namespace rtd::filter
