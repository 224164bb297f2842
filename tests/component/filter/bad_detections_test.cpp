// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
/// Whatever a broken or hostile detector sends must not harm what the filter does without it.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "common/service/monotonic_clock.hpp"
#include "tests/component/filter/filter_service_fixture.hpp"
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

/// What a broken or hostile detector may send over the bus: every frame is answered, the next good boxes are used.

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

class BadDetectionsService : public FilterServiceTest {
 protected:
  static msg::Detection2D box(const std::string& class_name, double score, double x_px, double y_px, double side_px) {
    msg::Detection2D box;
    msg::ObjectHypothesisWithPose result;
    result.hypothesis = {class_name, score};
    box.results = {result};
    box.bbox.center.position = {x_px, y_px};
    box.bbox.size_x = box.bbox.size_y = side_px;
    return box;
  }
  void send(std::int64_t stamp_ns, std::vector<msg::Detection2D> boxes) {
    msg::Detection2DArray message;
    message.header.stamp = msg::to_time(stamp_ns);
    message.detections = std::move(boxes);
    boxes_.write(message);
  }
  /// Frame `seq` has an answer and the frame after it, with good boxes, one with its person.
  void expect_recovery(std::uint64_t seq) {
    send_frame(seq);
    ASSERT_TRUE(answers_.wait_count(seq + 1));
    EXPECT_GT(answers_.at(seq)->count, 500U);
    send_boxes(seq + 1, true);
    send_frame(seq + 1);
    ASSERT_TRUE(answers_.wait_count(seq + 2));
    EXPECT_EQ(answers_.at(seq + 1)->detection_use, msg::DetectionUse::kExact);
    EXPECT_EQ(answers_.at(seq + 1)->objects, 1U);
  }
};

TEST_F(BadDetectionsService, leaves_out_invalid_boxes) {
  start(service::Pace::kAsap, true);
  send(stamp(0),
       {box("person", 0.9, -900, 200, 100), box("person", 0.9, 300, 5000, 100), box("person", 0.9, 300, 200, -100),
        box("unicorn", 0.9, 300, 200, 100), box("", 0.9, 300, 200, 100), msg::Detection2D{}});
  expect_recovery(0);
  EXPECT_EQ(answers_.at(0)->objects, 0U);
  EXPECT_EQ(answers_.at(0)->detection_use, msg::DetectionUse::kExact);
}

TEST_F(BadDetectionsService, never_gets_boxes_of_no_size_and_place) {
  start(service::Pace::kAsap, true);
  const double infinity = std::numeric_limits<double>::infinity();
  for (const auto& hostile : {box("person", kNan, 300, 200, 100), box("person", 0.9, kNan, 200, 100),
                              box("person", 0.9, 300, 200, infinity), box("person", 0.9, 1e300, 0, 1e300)}) {
    send(stamp(0), {hostile});
  }
  EXPECT_TRUE(wait_metric("topic.rt/detector/detections.implausible", 4));
  send_boxes(0, false);
  expect_recovery(0);
}

TEST_F(BadDetectionsService, takes_ten_thousand_boxes_within_a_second) {
  config_.detections_timeout_ms = 2000;  // of the frame that has none
  start(service::Pace::kAsap, true);
  std::vector<msg::Detection2D> boxes;
  for (int i = 0; i < 10'000; ++i) {
    boxes.push_back(box("person", 0.3 + 1e-5 * i, std::fmod(i * 37.0, 640), std::fmod(i * 53.0, 480), 10 + i % 300));
  }
  send(stamp(0), boxes);
  const std::int64_t sent_ns = service::monotonic_ns();
  send_frame(0);
  ASSERT_TRUE(answers_.wait_count(1));
  EXPECT_LT(service::monotonic_ns() - sent_ns, 1'000'000'000);
  expect_recovery(1);
}

TEST_F(BadDetectionsService, does_not_take_boxes_of_another_time_for_its_own_in_asap) {
  config_.detections_timeout_ms = 400;
  start(service::Pace::kAsap, true);
  const std::int64_t day_ns = 86'400'000'000'000;
  for (const std::int64_t stamp_ns : {stamp(0) + day_ns, stamp(0) + 1, std::int64_t{1}}) {
    send(stamp_ns, {box("person", 0.9, 300, 230, 200)});
  }
  send_frame(0);
  ASSERT_TRUE(answers_.wait_count(1)) << "the wait for the boxes of this frame ends";
  EXPECT_NE(answers_.at(0)->detection_use, msg::DetectionUse::kExact);
  EXPECT_EQ(answers_.at(0)->objects, 0U);
  expect_recovery(1);
}

TEST_F(BadDetectionsService, uses_neither_future_nor_ancient_boxes_in_realtime) {
  start(service::Pace::kRealtime, true);
  const std::int64_t day_ns = 86'400'000'000'000;
  for (const std::int64_t stamp_ns : {std::int64_t{0}, std::int64_t{1}, stamp(0) + day_ns, stamp(100)}) {
    send(stamp_ns, {box("person", 0.9, 300, 230, 200)});
  }
  send_frame(0);
  ASSERT_TRUE(answers_.wait_count(1));
  EXPECT_EQ(answers_.at(0)->objects, 0U);
  expect_recovery(1);
}

TEST_F(BadDetectionsService, is_not_pushed_out_of_step_by_a_flood_of_future_stamps) {
  start(service::Pace::kAsap, true);
  for (int i = 0; i < 200; ++i) send(stamp(1'000'000) + i, {box("person", 0.9, 300, 230, 200)});
  send_boxes(0, true);
  expect_recovery(0);
  EXPECT_EQ(answers_.at(0)->detection_use, msg::DetectionUse::kExact) << "old stamps make room for the present one";
}

}  // namespace
}  // namespace rtd::filter
