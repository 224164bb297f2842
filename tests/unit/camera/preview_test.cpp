// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/core/preview.hpp"

#include <gmock/gmock.h>

#include <opencv2/imgproc.hpp>

#include "common/camera/source_factory.hpp"

namespace rtd::camera {
namespace {

using ::testing::HasSubstr;

Preview preview_of(const std::string& uri) {
  const auto source = make_source(uri);
  Preview preview;
  while (const auto frame = source->next()) preview.add(*frame);
  return preview;
}

/// A grey box in front of a wall; its depth lies `shift` beside its colour.
SourceFrame box(cv::Point shift, double stamp_s = 1, double offset_s = 0) {
  SourceFrame frame;
  frame.image.stamp_ns = static_cast<std::int64_t>(stamp_s * 1e9);
  frame.image.depth_offset_s = offset_s;
  frame.image.color_bgr = cv::Mat(120, 160, CV_8UC3, cv::Scalar::all(60));
  frame.image.depth = cv::Mat(120, 160, CV_16UC1, cv::Scalar(3000));
  const cv::Rect place(50, 40, 60, 45);
  cv::rectangle(frame.image.color_bgr, place, cv::Scalar::all(180), cv::FILLED);
  cv::rectangle(frame.image.depth, place + shift, cv::Scalar(1500), cv::FILLED);
  return frame;
}

TEST(PreviewTest, measures_rate_holes_and_time_between_the_images) {
  Preview preview;
  for (int i = 0; i < 16; ++i) {
    SourceFrame frame = box({}, 1 + i / 15.0, 0.009);
    frame.image.depth.rowRange(0, 30) = 0;
    preview.add(frame);
  }
  EXPECT_NEAR(preview.rate_hz(), 15, 1e-6);
  EXPECT_NEAR(preview.hole_share(), 0.25, 1e-9);
  EXPECT_NEAR(preview.depth_offset_s(), 0.009, 1e-9);
  EXPECT_EQ(preview.picture().size(), cv::Size(320, 120));
  EXPECT_THAT(preview.text({}, {}), HasSubstr("25.0 % of the depth image"));
}

TEST(PreviewTest, says_how_far_away_depth_is_and_doubts_its_unit) {
  Preview preview;
  SourceFrame frame = box({});
  frame.image.depth_scale_m = 1.0 / 5000;
  preview.add(frame);
  const std::string text = preview.text({.depth_scale_m = 1.0 / 5000, .depth_unit_given = false}, {});
  EXPECT_THAT(text, HasSubstr("median 0.6"));
  EXPECT_THAT(text, testing::Not(HasSubstr("WARNING"))) << "a shelf in front of the camera, or 3 m";
  Preview near;
  frame.image.depth /= 2;
  near.add(frame);
  EXPECT_THAT(near.text({.depth_scale_m = 1.0 / 5000, .depth_unit_given = false}, {}),
              testing::AllOf(HasSubstr("WARNING"), HasSubstr("millimetres"), HasSubstr("?depth_factor=1000")));
}

TEST(PreviewTest, measures_how_far_depth_lies_beside_colour) {
  for (const cv::Point shift : {cv::Point(0, 0), cv::Point(7, -3), cv::Point(-9, 4)}) {
    Preview preview;
    for (int i = 0; i < 16; ++i) preview.add(box(shift, 1 + i / 15.0));
    const std::optional<cv::Point2d> measured = preview.registration_px();
    ASSERT_TRUE(measured) << shift;
    EXPECT_NEAR(measured->x, shift.x, 0.7);
    EXPECT_NEAR(measured->y, shift.y, 0.7);
  }
}

TEST(PreviewTest, a_rendered_room_shows_the_shift_of_its_depth) {
  const auto aligned = preview_of("synthetic:office?frames=30&width=320&height=240").registration_px();
  const auto shifted =
      preview_of("synthetic:office?frames=30&width=320&height=240&registration_px=5").registration_px();
  ASSERT_TRUE(aligned && shifted);
  EXPECT_LT(std::hypot(aligned->x, aligned->y), 1.5);
  EXPECT_NEAR(std::hypot(shifted->x - aligned->x, shifted->y - aligned->y), 5, 1);
}

TEST(PreviewTest, a_bare_wall_gives_no_shift) {
  Preview preview;
  SourceFrame frame = box({});
  frame.image.depth = 2000;
  preview.add(frame);
  EXPECT_FALSE(preview.registration_px());
  EXPECT_THAT(preview.text({}, {}), HasSubstr("not measured in px"));
}

}  // namespace
}  // namespace rtd::camera
