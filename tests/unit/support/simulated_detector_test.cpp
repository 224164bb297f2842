// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/simulated_detector.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "tests/support/detector_pace.hpp"

namespace rtd::test_support {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr std::int64_t kPeriodNs = 100'000'000, kFirstNs = 5'000'000'000;

/// A frame of a 10 Hz source with one person and one box.
camera::SourceFrame frame(std::uint64_t seq) {
  camera::SourceFrame frame;
  frame.image.seq = seq;
  frame.image.stamp_ns = kFirstNs + static_cast<std::int64_t>(seq) * kPeriodNs;
  frame.image.color_bgr = cv::Mat(480, 640, CV_8UC3);
  frame.T_world_camera = Eigen::Isometry3d::Identity();
  frame.objects = {{0, "person", {100, 100, 100, 300}, 20000, true}, {1, "box", {300, 100, 100, 100}, 9000, true}};
  return frame;
}

/// For each frame, the frames whose boxes the filter receives at it.
std::vector<std::vector<int>> received(const DetectorOptions& options, int frames) {
  DetectorPace pace([](const camera::SourceFrame&) { return std::vector<vision::Detection>{}; }, options);
  std::vector<std::vector<int>> all;
  for (int i = 0; i < frames; ++i) {
    std::vector<int> now;
    for (const filter::DetectionBatch& batch : pace.advance_to(frame(static_cast<std::uint64_t>(i))).batches) {
      now.push_back(static_cast<int>((batch.stamp_ns - kFirstNs) / kPeriodNs));
    }
    all.push_back(now);
  }
  return all;
}

using Seqs = std::vector<int>;

TEST(DetectorPace, answers_every_frame_at_once_when_nothing_slows_it) {
  EXPECT_THAT(received({}, 3), ElementsAre(Seqs{0}, Seqs{1}, Seqs{2}));
}

TEST(DetectorPace, takes_as_many_images_as_its_rate_allows) {
  DetectorOptions options;
  options.rate_hz = 5;
  EXPECT_THAT(received(options, 5), ElementsAre(Seqs{0}, Seqs{}, Seqs{2}, Seqs{}, Seqs{4}));
}

TEST(DetectorPace, answers_late_and_then_takes_the_newest_image) {
  DetectorOptions options;
  options.delay_ms = 250;  // busy until 250: takes image 2 (of 200 ms) then, answers at 500, takes image 5
  EXPECT_THAT(received(options, 9),
              ElementsAre(Seqs{}, Seqs{}, Seqs{}, Seqs{0}, Seqs{}, Seqs{2}, Seqs{}, Seqs{}, Seqs{5}));
}

TEST(DetectorPace, is_silent_in_an_outage_which_the_filter_notices_later) {
  DetectorOptions options;
  options.outages = {{0.2, 0.9}};
  EXPECT_THAT(received(options, 11),
              ElementsAre(Seqs{0}, Seqs{1}, Seqs{}, Seqs{}, Seqs{}, Seqs{}, Seqs{}, Seqs{}, Seqs{}, Seqs{9}, Seqs{10}));
  DetectorPace pace([](const camera::SourceFrame&) { return std::vector<vision::Detection>{}; }, options);
  std::vector<bool> active;
  for (std::uint64_t i = 0; i < 10; ++i) active.push_back(pace.advance_to(frame(i)).active);
  EXPECT_THAT(active, ElementsAre(true, true, true, true, true, true, true, false, false, true));
}

TEST(SimulatedDetector, distinguishes_people_from_boxes_and_is_a_little_wrong) {
  DetectorOptions options;
  options.kind = "truth";
  const Look look = make_look(options);
  int found = 0;
  double worst_px = 0;
  for (std::uint64_t i = 0; i < 200; ++i) {
    const auto boxes = look(frame(i));
    if (boxes.empty()) continue;
    ASSERT_THAT(boxes, SizeIs(1));
    EXPECT_EQ(boxes[0].class_name, "person");
    worst_px = std::max(worst_px, std::abs(static_cast<double>(boxes[0].x_px) - 100));
    ++found;
  }
  EXPECT_NEAR(found, 192, 7) << "one in 25 is missed";
  EXPECT_GT(worst_px, 3);
  EXPECT_LT(worst_px, 15) << "3 % of 100 px, five sigma";
}

TEST(SimulatedDetector, does_not_find_what_is_hardly_seen) {
  DetectorOptions options;
  options.kind = "truth";
  options.missed_share = 0;
  camera::SourceFrame hidden = frame(0);
  hidden.objects[0].visible_px = 100;
  EXPECT_THAT(make_look(options)(hidden), IsEmpty());
}

/// For each of 2000 frames at 10 Hz, whether the person is found.
std::vector<bool> found_with_recall(double recall) {
  DetectorOptions options;
  options.kind = "truth";
  options.missed_share = 0;
  options.recall = recall;
  const Look look = make_look(options);
  std::vector<bool> found;
  for (std::uint64_t i = 0; i < 2000; ++i) found.push_back(!look(frame(i)).empty());
  return found;
}

TEST(SimulatedDetector, misses_in_bursts_of_the_stated_recall) {
  const std::vector<bool> found = found_with_recall(0.78);
  EXPECT_NEAR(static_cast<double>(std::count(found.begin(), found.end(), true)) / 2000, 0.78, 0.03);
  std::vector<int> bursts;
  for (std::size_t i = 1; i < found.size(); ++i) {
    if (found[i]) continue;
    if (found[i - 1]) bursts.push_back(0);
    if (!bursts.empty()) ++bursts.back();
  }
  ASSERT_GT(bursts.size(), 20U);
  std::sort(bursts.begin(), bursts.end());
  EXPECT_GE(bursts.front(), 2) << "0.3 s are 3 frames, or 2 between two";
  EXPECT_LE(bursts[bursts.size() * 9 / 10], 21) << "2 s; two bursts may touch";
  EXPECT_GT(bursts.back(), 14);
  const std::vector<bool> all = found_with_recall(1);
  EXPECT_EQ(std::count(all.begin(), all.end(), false), 0);
}

TEST(SimulatedDetector, cuts_boxes_at_one_side) {
  DetectorOptions options;
  options.kind = "truth";
  options.missed_share = 0;
  options.jitter_share = 0;
  options.cut_share = 0.5;
  const Look look = make_look(options);
  int cut = 0;
  for (std::uint64_t i = 0; i < 400; ++i) {
    const vision::Detection box = look(frame(i)).at(0);
    const double left = static_cast<double>(box.width_px * box.height_px) / (100.0 * 300.0);
    EXPECT_TRUE(left == 1 || (left >= 0.499 && left <= 0.801)) << left;
    EXPECT_GE(box.x_px, 100);
    EXPECT_LE(box.x_px + box.width_px, 200.01);
    if (left < 1) ++cut;
  }
  EXPECT_NEAR(cut, 200, 40);
}

TEST(SimulatedDetector, says_the_same_to_the_same_frame_and_seed) {
  for (const char* kind : {"truth", "lying"}) {
    DetectorOptions options;
    options.kind = kind;
    const auto score_of = [&](std::uint64_t seed) {
      options.seed = seed;
      float sum = 0;
      for (std::uint64_t i = 0; i < 20; ++i) {
        for (const vision::Detection& box : make_look(options)(frame(i))) sum += box.score + box.x_px;
      }
      return sum;
    };
    EXPECT_EQ(score_of(1), score_of(1)) << kind;
    EXPECT_NE(score_of(1), score_of(2)) << kind;
  }
}

TEST(SimulatedDetector, refuses_what_it_cannot_do) {
  DetectorOptions options;
  options.kind = "guess";
  EXPECT_THROW(make_look(options), std::invalid_argument);
  options.kind = "truth";
  options.recall = 0.2;
  EXPECT_THROW(make_look(options), std::invalid_argument);
  options.recall = 1;
  camera::SourceFrame recorded = frame(0);
  recorded.T_world_camera.reset();
  EXPECT_THROW(make_look(options)(recorded), std::invalid_argument);
}

}  // namespace
}  // namespace rtd::test_support
