// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "services/detector/core/network_input.hpp"

namespace rtd::detector {
namespace {

TEST(Letterbox, leaves_a_frame_of_the_inputs_size_alone) {
  const Letterbox letterbox = fit_letterbox({640, 480}, {640, 480});
  EXPECT_DOUBLE_EQ(letterbox.scale_x, 1.0);
  EXPECT_DOUBLE_EQ(letterbox.scale_y, 1.0);
  EXPECT_EQ(letterbox.pad_left_px, 0);
  EXPECT_EQ(letterbox.pad_top_px, 0);
}

TEST(Letterbox, centres_a_wide_frame_between_grey_bars) {
  const Letterbox letterbox = fit_letterbox({640, 320}, {320, 320});
  EXPECT_EQ(letterbox.width_px, 320);
  EXPECT_EQ(letterbox.height_px, 160);
  EXPECT_EQ(letterbox.pad_left_px, 0);
  EXPECT_EQ(letterbox.pad_top_px, 80);
  EXPECT_DOUBLE_EQ(letterbox.scale_x, 0.5);
}

TEST(Letterbox, never_shrinks_a_sliver_to_nothing) {
  const Letterbox letterbox = fit_letterbox({10000, 1}, {320, 320});
  EXPECT_EQ(letterbox.width_px, 320);
  EXPECT_EQ(letterbox.height_px, 1);
}

TEST(FillBlob, writes_rgb_planes_scaled_to_one) {
  cv::Mat image(2, 2, CV_8UC3, cv::Scalar(0, 51, 255));  // blue, green, red
  cv::Mat blob;
  fill_blob(image, fit_letterbox(image.size(), {2, 2}), {2, 2}, PixelFormat(), blob);
  ASSERT_EQ(blob.total(), 12U);
  const float* const values = blob.ptr<float>();
  EXPECT_FLOAT_EQ(values[0], 1.0F);
  EXPECT_FLOAT_EQ(values[4], 0.2F);
  EXPECT_FLOAT_EQ(values[8], 0.0F);
}

TEST(FillBlob, fills_the_bars_with_grey_and_the_middle_with_the_frame) {
  const cv::Mat image(2, 4, CV_8UC3, cv::Scalar::all(255));
  cv::Mat blob;
  fill_blob(image, fit_letterbox(image.size(), {4, 4}), {4, 4}, PixelFormat(), blob);
  const float* const red = blob.ptr<float>();
  EXPECT_FLOAT_EQ(red[0], 114.0F / 255.0F);
  EXPECT_FLOAT_EQ(red[4], 1.0F);
  EXPECT_FLOAT_EQ(red[11], 1.0F);
  EXPECT_FLOAT_EQ(red[12], 114.0F / 255.0F);
}

TEST(FillBlob, writes_the_format_that_the_network_wants) {
  const cv::Mat image(1, 2, CV_8UC3, cv::Scalar(10, 20, 30));  // blue, green, red
  const PixelFormat pixels{.rgb = false, .offset = {4, 10, 0}, .scale = {0.5F, 2, 1}};
  cv::Mat blob;
  fill_blob(image, fit_letterbox(image.size(), {2, 3}), {2, 3}, pixels, blob);  // grey above and below
  const float* const values = blob.ptr<float>();
  EXPECT_FLOAT_EQ(values[2], 3.0F);
  EXPECT_FLOAT_EQ(values[6 + 2], 20.0F);
  EXPECT_FLOAT_EQ(values[12 + 2], 30.0F);
  EXPECT_FLOAT_EQ(values[0], 55.0F);
  EXPECT_FLOAT_EQ(values[6], 208.0F);
  EXPECT_FLOAT_EQ(values[12 + 5], 114.0F);
}

}  // namespace
}  // namespace rtd::detector
