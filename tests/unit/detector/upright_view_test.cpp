// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/network_input.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

namespace rtd::detector {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr InputSize kInput{640, 480};
const cv::Size kFrame(640, 480);

/// A point of the frame in the network's input: the formula of the header, written down again.
cv::Point2d to_input(cv::Point2d p, const UprightView& view) {
  const double x = p.x - view.frame.width / 2.0, y = p.y - view.frame.height / 2.0;
  return {view.input.width_px / 2.0 + view.scale * (view.cos * x - view.sin * y),
          view.input.height_px / 2.0 + view.scale * (view.sin * x + view.cos * y)};
}

/// The box in the input around an ellipse that stands upright there.
Candidate upright_box(cv::Point2d centre_in_frame, double width_px, double height_px, const UprightView& view) {
  const cv::Point2d centre = to_input(centre_in_frame, view);
  const auto at = [](double value) { return static_cast<float>(value); };
  const double half_width = view.scale * width_px / 2, half_height = view.scale * height_px / 2;
  return {0,
          0.9F,
          at(centre.x - half_width),
          at(centre.y - half_height),
          at(centre.x + half_width),
          at(centre.y + half_height)};
}

class EveryRoll : public ::testing::TestWithParam<int> {
 protected:
  double roll_rad() const { return GetParam() * kDegree; }
};

TEST_P(EveryRoll, loses_no_corner_of_the_image) {
  for (const InputSize input : {kInput, InputSize{320, 320}, InputSize{416, 320}}) {
    const UprightView view = fit_upright(kFrame, input, roll_rad());
    double nearest_edge_px = 1e9;
    for (const cv::Point2d corner :
         {cv::Point2d(0, 0), cv::Point2d(640, 0), cv::Point2d(0, 480), cv::Point2d(640, 480)}) {
      const cv::Point2d p = to_input(corner, view);
      nearest_edge_px = std::min({nearest_edge_px, p.x, p.y, input.width_px - p.x, input.height_px - p.y});
    }
    EXPECT_NEAR(nearest_edge_px, 0, 1e-6);  // inside, and no smaller than needed
  }
}

TEST_P(EveryRoll, puts_pixels_where_the_boxes_are_taken_from) {
  cv::Mat image = cv::Mat::zeros(kFrame, CV_8UC3);
  cv::circle(image, {400, 200}, 12, cv::Scalar::all(255), cv::FILLED);
  const UprightView view = fit_upright(kFrame, kInput, roll_rad());
  cv::Mat blob;
  fill_upright_blob(image, view, PixelFormat(), blob);

  const cv::Mat red(kInput.height_px, kInput.width_px, CV_32F, blob.ptr<float>());
  const cv::Rect bright = cv::boundingRect(red > 0.75F);
  const cv::Rect2f box = box_in_frame({0, 1, static_cast<float>(bright.x), static_cast<float>(bright.y),
                                       static_cast<float>(bright.br().x), static_cast<float>(bright.br().y)},
                                      view);
  EXPECT_NEAR(box.x + box.width / 2, 400.5, 1.0);
  EXPECT_NEAR(box.y + box.height / 2, 200.5, 1.0);
  EXPECT_NEAR(box.width, 25, 2.5);
  EXPECT_NEAR(box.height, 25, 2.5);
}

TEST_P(EveryRoll, boxes_the_turned_ellipse_exactly) {
  const UprightView view = fit_upright(kFrame, kInput, roll_rad());
  const cv::Rect2f box = box_in_frame(upright_box({330, 230}, 60, 160, view), view);

  double left = 1e9, right = -1e9, top = 1e9, bottom = -1e9;  // the ellipse's own outline, turned back
  for (int i = 0; i < 3600; ++i) {
    const double x = 30 * std::cos(i * kDegree / 10), y = 80 * std::sin(i * kDegree / 10);
    const double u = 330 + view.cos * x + view.sin * y, v = 230 - view.sin * x + view.cos * y;
    left = std::min(left, u);
    right = std::max(right, u);
    top = std::min(top, v);
    bottom = std::max(bottom, v);
  }
  EXPECT_NEAR(box.x, left, 0.05);
  EXPECT_NEAR(box.x + box.width, right, 0.05);
  EXPECT_NEAR(box.y, top, 0.05);
  EXPECT_NEAR(box.y + box.height, bottom, 0.05);
}

TEST_P(EveryRoll, keeps_boxes_inside_the_image) {
  const UprightView view = fit_upright(kFrame, kInput, roll_rad());
  for (const Candidate& candidate : {Candidate{0, 1, -500, -500, 1500, 1500}, Candidate{0, 1, -90, -90, -50, -50},
                                     Candidate{0, 1, 600, 400, 700, 600}}) {
    const cv::Rect2f box = box_in_frame(candidate, view);
    EXPECT_GE(box.x, 0);
    EXPECT_GE(box.y, 0);
    EXPECT_LE(box.x + box.width, 640);
    EXPECT_LE(box.y + box.height, 480);
  }
}

INSTANTIATE_TEST_SUITE_P(Degrees, EveryRoll, ::testing::Values(0, 15, 37, 45, 90, 135, 180, -30, -90, -179));

TEST(UprightView, turns_a_quarter_without_loss_of_the_box) {
  const UprightView view = fit_upright(kFrame, kInput, 90 * kDegree);
  EXPECT_NEAR(view.scale, 0.75, 1e-9);
  const cv::Rect2f box = box_in_frame(upright_box({320, 240}, 40, 100, view), view);
  EXPECT_NEAR(box.width, 100, 1e-3);
  EXPECT_NEAR(box.height, 40, 1e-3);
}

TEST(UprightView, is_tighter_than_the_turned_corners) {
  const UprightView view = fit_upright(kFrame, kInput, 45 * kDegree);
  const cv::Rect2f box = box_in_frame(upright_box({320, 240}, 100, 100, view), view);
  EXPECT_NEAR(box.area(), 100 * 100, 1);  // the turned corners would need 141 x 141
}

}  // namespace
}  // namespace rtd::detector
