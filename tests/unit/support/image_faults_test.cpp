// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/image_faults.hpp"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

namespace rtd::test_support {
namespace {

using Kind = ImageFault::Kind;

/// Grey, 2 m away, nothing moves.
camera::SourceFrame frame_at(double t_s) {
  camera::SourceFrame frame;
  frame.image.stamp_ns = std::llround((100 + t_s) * 1e9);
  frame.image.color_bgr = cv::Mat(480, 640, CV_8UC3, cv::Scalar(100, 100, 100));
  frame.image.color_bgr.colRange(0, 320).setTo(cv::Scalar(200, 200, 200));
  frame.image.depth = cv::Mat(480, 640, CV_16UC1, cv::Scalar(10000));
  frame.image.depth_scale_m = 1 / 5000.0;
  frame.dynamic_mask = cv::Mat::zeros(480, 640, CV_8UC1);
  return frame;
}

/// The frame at `t_s` of a source whose first one is at 0.
camera::SourceFrame with_fault(const ImageFault& fault, double t_s) {
  ImageFaults faults({fault});
  camera::SourceFrame first = frame_at(0), frame = frame_at(t_s);
  faults.apply(first);
  faults.apply(frame);
  return frame;
}

double covered(const camera::SourceFrame& frame) {
  return cv::countNonZero(frame.dynamic_mask) / static_cast<double>(frame.dynamic_mask.total());
}

TEST(ImageFaults, occluder_covers_the_share_with_near_depth) {
  for (const double share : {0.1, 0.4, 0.8}) {
    const camera::SourceFrame frame = with_fault({Kind::kOcclude, share, 1, 5}, 2.6);
    EXPECT_NEAR(covered(frame), share, 0.06) << share;
    EXPECT_EQ(cv::countNonZero(frame.image.depth == 4000), cv::countNonZero(frame.dynamic_mask)) << share;
  }
}

TEST(ImageFaults, occluder_moves) {
  const auto left_edge = [](double t_s) {
    return cv::boundingRect(with_fault({Kind::kOcclude, 0.3, 1, 5}, t_s).dynamic_mask).x;
  };
  EXPECT_NE(left_edge(2.6), left_edge(2.8));
}

TEST(ImageFaults, end_where_they_end_and_leave_the_source_as_it_was) {
  EXPECT_EQ(covered(with_fault({Kind::kOcclude, 0.5, 1, 2}, 0.9)), 0);
  EXPECT_EQ(covered(with_fault({Kind::kOcclude, 0.5, 1, 2}, 2)), 0);
  ImageFaults faults({{Kind::kOcclude, 0.5, 0, 4}});
  camera::SourceFrame frame = frame_at(0);
  faults.apply(frame);
  frame = frame_at(2);
  const cv::Mat colour = frame.image.color_bgr, depth = frame.image.depth;
  faults.apply(frame);
  EXPECT_EQ(cv::countNonZero(depth != 10000), 0);
  EXPECT_EQ(cv::countNonZero(colour.reshape(1) != frame_at(2).image.color_bgr.reshape(1)), 0);
}

TEST(ImageFaults, darkness_takes_colour_but_no_depth) {
  const camera::SourceFrame frame = with_fault({Kind::kDark, 0, 1, 2}, 1.5);
  EXPECT_EQ(frame.image.color_bgr.at<cv::Vec3b>(0, 639), cv::Vec3b(2, 2, 2));
  EXPECT_EQ(frame.image.depth.at<std::uint16_t>(0, 0), 10000);
}

TEST(ImageFaults, blur_smears_along_the_rows) {
  const camera::SourceFrame frame = with_fault({Kind::kBlur, 21, 1, 2}, 1.5);
  EXPECT_EQ(frame.image.color_bgr.at<cv::Vec3b>(0, 300)[0], 200);
  EXPECT_NEAR(frame.image.color_bgr.at<cv::Vec3b>(0, 320)[0], 150, 5);
  EXPECT_EQ(frame.image.color_bgr.at<cv::Vec3b>(0, 340)[0], 100);
}

TEST(ImageFaults, a_detector_sees_the_person_but_not_what_is_hidden_or_dark) {
  const std::vector<vision::Detection> boxes{{"chair", 0.9F, 300, 300, 40, 100}, {"tv", 0.9F, 0, 0, 40, 30}};
  const auto classes = [&](const ImageFault& fault) {
    ImageFaults faults({fault});
    faults.seen(frame_at(0), {});
    std::vector<std::string> names;
    for (const vision::Detection& box : faults.seen(frame_at(2.6), boxes)) names.push_back(box.class_name);
    return names;
  };
  EXPECT_EQ(classes({Kind::kPerson, 0.5, 1, 5}), (std::vector<std::string>{"tv", "person"}));
  EXPECT_EQ(classes({Kind::kOcclude, 0.5, 1, 5}), (std::vector<std::string>{"tv"}));
  EXPECT_TRUE(classes({Kind::kDark, 0, 1, 5}).empty());
  EXPECT_EQ(classes({Kind::kBlur, 9, 1, 5}).size(), 2U);
}

}  // namespace
}  // namespace rtd::test_support
