// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// What a broken or hostile detector may send over the bus: every frame is answered, the next good boxes are used.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "common/service/monotonic_clock.hpp"
#include "tests/component/filter/filter_service_fixture.hpp"

namespace rtd::filter {
namespace {

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
