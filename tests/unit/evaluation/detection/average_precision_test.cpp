// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/detection/average_precision.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <random>

namespace rtd::eval {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

const ClassFilter kAll = [](const std::string&) { return true; };

LabelledBox truth(double x_px, double y_px, double width_px, double height_px, const std::string& name = "person") {
  return {name, x_px, y_px, width_px, height_px};
}

vision::Detection found(float score, float x_px, float y_px, float width_px, float height_px,
                        const std::string& name = "person") {
  return {name, score, x_px, y_px, width_px, height_px};
}

/// COCO's definition written down without any thought for speed.
class SlowEvaluation {
 public:
  static double ap(const std::vector<EvaluatedImage>& images, double min_iou) {
    std::size_t truths = 0;
    std::vector<std::pair<float, bool>> claims;
    for (const EvaluatedImage& image : images) {
      truths += image.truths.size();
      std::vector<vision::Detection> detections = image.detections;
      std::stable_sort(detections.begin(), detections.end(), [](auto& a, auto& b) { return a.score > b.score; });
      std::vector<bool> used(image.truths.size());
      for (const vision::Detection& detection : detections) {
        double best = 0;
        std::size_t index = image.truths.size();
        for (std::size_t i = 0; i < image.truths.size(); ++i) {
          if (used[i] || iou(detection, image.truths[i]) < std::max(best, min_iou)) continue;
          best = iou(detection, image.truths[i]);
          index = i;
        }
        if (index < used.size()) used[index] = true;
        claims.emplace_back(detection.score, index < used.size());
      }
    }
    std::stable_sort(claims.begin(), claims.end(), [](auto& a, auto& b) { return a.first > b.first; });
    double sum = 0;
    for (int step = 0; step <= 100; ++step) sum += best_precision_at(claims, truths, step);
    return sum / 101;
  }

 private:
  /// The share of the image's grid points in both boxes over those in either: boxes have whole corners.
  static double iou(const vision::Detection& a, const LabelledBox& b) {
    int both = 0, either = 0;
    for (int y = 0; y < 50; ++y)
      for (int x = 0; x < 50; ++x) {
        const bool in_a = x >= a.x_px && x < a.x_px + a.width_px && y >= a.y_px && y < a.y_px + a.height_px;
        const bool in_b = x >= b.x_px && x < b.x_px + b.width_px && y >= b.y_px && y < b.y_px + b.height_px;
        both += in_a && in_b ? 1 : 0;
        either += in_a || in_b ? 1 : 0;
      }
    return both / static_cast<double>(either);
  }
  static double best_precision_at(const std::vector<std::pair<float, bool>>& claims, std::size_t truths, int step) {
    double best = 0;
    std::size_t correct = 0;
    for (std::size_t i = 0; i < claims.size(); ++i) {
      correct += claims[i].second ? 1 : 0;
      if (100 * correct < static_cast<std::size_t>(step) * truths) continue;
      best = std::max(best, static_cast<double>(correct) / static_cast<double>(i + 1));
    }
    return best;
  }
};

std::vector<EvaluatedImage> random_images(std::mt19937& random) {
  const auto pick = [&random](int from, int to) { return std::uniform_int_distribution<int>(from, to)(random); };
  std::vector<EvaluatedImage> images(static_cast<std::size_t>(pick(1, 6)));
  for (EvaluatedImage& image : images) {
    for (int i = pick(0, 5); i > 0; --i)
      image.truths.push_back(truth(pick(0, 20), pick(0, 20), pick(4, 20), pick(4, 20)));
    for (const LabelledBox& box : image.truths) {
      if (pick(0, 3) == 0) continue;
      image.detections.push_back(found(static_cast<float>(pick(1, 20)) / 20, static_cast<float>(box.x_px + pick(0, 3)),
                                       static_cast<float>(box.y_px + pick(0, 3)), static_cast<float>(box.width_px),
                                       static_cast<float>(box.height_px)));
    }
    for (int i = pick(0, 4); i > 0; --i) {
      image.detections.push_back(found(static_cast<float>(pick(1, 20)) / 20, static_cast<float>(pick(0, 20)),
                                       static_cast<float>(pick(0, 20)), 9, 9));
    }
  }
  return images;
}

TEST(BoxAccuracy, is_as_computed_by_hand) {
  // Two people; by falling score: right, wrong, right. Precision 1 up to recall 0.5 (51 of 101 points), then 2/3.
  const std::vector<EvaluatedImage> images = {
      {{truth(0, 0, 10, 10)}, {found(0.9F, 0, 0, 10, 10), found(0.8F, 20, 20, 10, 10)}},
      {{truth(5, 5, 10, 20)}, {found(0.7F, 5, 5, 10, 12)}}};  // IoU 0.6: right up to that threshold

  const BoxAccuracy accuracy = evaluate_boxes(images, kAll);

  EXPECT_EQ(accuracy.truths, 2U);
  EXPECT_EQ(accuracy.detections, 3U);
  EXPECT_NEAR(accuracy.ap50(), (51 + 50 * 2.0 / 3) / 101, 1e-12);
  EXPECT_NEAR(accuracy.ap[1], accuracy.ap50(), 1e-12);
  EXPECT_NEAR(accuracy.ap[9], 51.0 / 101, 1e-12);  // the third is wrong now
  EXPECT_NEAR(accuracy.ap50_95(), (3 * accuracy.ap50() + 7 * accuracy.ap[9]) / 10, 1e-12);
}

TEST(BoxAccuracy, equals_a_slow_implementation_on_random_boxes) {
  std::mt19937 random(3);
  int compared = 0;
  for (int round = 0; round < 150; ++round) {
    const std::vector<EvaluatedImage> images = random_images(random);
    const BoxAccuracy accuracy = evaluate_boxes(images, kAll);
    if (accuracy.truths == 0) continue;
    for (std::size_t t = 0; t < kIouThresholds.size(); ++t, ++compared) {
      ASSERT_NEAR(accuracy.ap[t], SlowEvaluation::ap(images, kIouThresholds[t]), 1e-9) << "round " << round;
    }
  }
  EXPECT_GT(compared, 1000);
}

TEST(BoxAccuracy, counts_the_second_box_on_an_object_as_wrong) {
  const std::vector<EvaluatedImage> images = {
      {{truth(0, 0, 10, 10)}, {found(0.9F, 0, 0, 10, 10), found(0.8F, 0, 0, 10, 10)}}};
  const BoxAccuracy accuracy = evaluate_boxes(images, kAll);
  EXPECT_DOUBLE_EQ(accuracy.ap50(), 1);
  EXPECT_DOUBLE_EQ(accuracy.curve.back().precision, 0.5);
}

TEST(BoxAccuracy, leaves_difficult_objects_out) {
  LabelledBox difficult = truth(0, 0, 10, 10);
  difficult.difficult = true;
  const std::vector<EvaluatedImage> images = {
      {{difficult, truth(20, 20, 10, 10)},
       {found(0.9F, 0, 0, 10, 10), found(0.8F, 0, 0, 10, 10), found(0.7F, 20, 20, 10, 10)}}};
  const BoxAccuracy accuracy = evaluate_boxes(images, kAll);
  EXPECT_EQ(accuracy.truths, 1U);
  EXPECT_EQ(accuracy.detections, 1U);
  EXPECT_DOUBLE_EQ(accuracy.ap50_95(), 1);
}

TEST(BoxAccuracy, is_zero_without_detections_and_without_objects) {
  EXPECT_DOUBLE_EQ(evaluate_boxes({{{truth(0, 0, 10, 10)}, {}}}, kAll).ap50(), 0);
  const BoxAccuracy nothing = evaluate_boxes({{{}, {found(0.9F, 0, 0, 10, 10)}}}, kAll);
  EXPECT_DOUBLE_EQ(nothing.ap50(), 0);
  EXPECT_THAT(nothing.curve, IsEmpty());
  EXPECT_EQ(evaluate_boxes({}, kAll).truths, 0U);
}

TEST(BoxAccuracy, leaves_out_scores_and_boxes_that_are_not_a_number) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const BoxAccuracy accuracy = evaluate_boxes(
      {{{truth(0, 0, 10, 10)}, {found(kNan, 0, 0, 10, 10), found(0.9F, kNan, 0, 10, 10), found(0.8F, 0, 0, 10, 10)}}},
      kAll);
  EXPECT_EQ(accuracy.detections, 2U);
  EXPECT_NEAR(accuracy.ap50(), 0.5, 1e-12);
}

TEST(OperatingPoints, give_the_best_threshold_and_the_one_that_finds_enough) {
  const std::vector<EvaluatedImage> images = {
      {{truth(0, 0, 10, 10), truth(20, 0, 10, 10), truth(0, 20, 10, 10)},
       {found(0.9F, 0, 0, 10, 10), found(0.6F, 20, 0, 10, 10), found(0.3F, 30, 30, 9, 9), found(0.2F, 0, 20, 10, 10)}}};
  const std::vector<OperatingPoint> curve = evaluate_boxes(images, kAll).curve;

  ASSERT_THAT(curve, SizeIs(4));
  EXPECT_NEAR(best_f1(curve)->threshold, 0.2, 1e-6);  // P 3/4, R 1: F1 0.857 against 0.8 at 0.6
  EXPECT_NEAR(best_f1(curve)->f1, 6.0 / 7, 1e-9);
  EXPECT_NEAR(highest_threshold_with_recall(curve, 0.5)->threshold, 0.6, 1e-6);
  EXPECT_NEAR(highest_threshold_with_recall(curve, 0.99)->threshold, 0.2, 1e-6);
  EXPECT_FALSE(highest_threshold_with_recall({curve[0]}, 0.99));
  EXPECT_NEAR(at_threshold(curve, 0.4).recall, 2.0 / 3, 1e-9);
  EXPECT_DOUBLE_EQ(at_threshold(curve, 0.95).recall, 0);
  EXPECT_FALSE(best_f1({}));
}

TEST(AccuracyReport, averages_over_the_classes_that_occur_and_pools_groups) {
  const std::vector<EvaluatedImage> images = {
      {{truth(0, 0, 10, 10), truth(20, 20, 10, 10, "dog")},
       {found(0.9F, 0, 0, 10, 10), found(0.8F, 20, 20, 10, 10, "cat"), found(0.7F, 0, 0, 9, 9, "chair")}}};

  const AccuracyReport report =
      evaluate_detector(images, [](const std::string& name) { return name == "chair" ? "medium" : "high"; });

  EXPECT_THAT(report.classes, SizeIs(2));
  EXPECT_DOUBLE_EQ(report.ap50, 0.5);  // person 1, dog 0
  EXPECT_THAT(report.groups, SizeIs(1));
  EXPECT_DOUBLE_EQ(report.groups.at("high").ap50(), 1);  // the filter does not care that the dog is called a cat
  EXPECT_DOUBLE_EQ(report.person.ap50(), 1);
}

}  // namespace
}  // namespace rtd::eval
