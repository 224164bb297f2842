// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <opencv2/imgcodecs.hpp>

#include "services/detector/detector_service.hpp"
#include "services/detector/image_table.hpp"
#include "tests/support/detector/tiny_network.hpp"
#include "tests/support/temporary_folder.hpp"

namespace rtd::detector {
namespace {

using ::testing::HasSubstr;

class ImageTable : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_.write("tiny.onnx", test::tiny_network_onnx({.metadata = {{"rtd.class_names", "person\nbox"}}}));
    cv::Mat image = cv::Mat::zeros(64, 64, CV_8UC3);
    image(cv::Rect(40, 24, 8, 8)).setTo(cv::Scalar::all(255));
    cv::imwrite(path("white.png"), image);
  }
  std::string path(const std::string& name) const { return folder_.file(name); }

  int run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "rtd-detector");
    std::vector<const char*> argv;
    for (const std::string& argument : arguments) argv.push_back(argument.c_str());
    ::testing::internal::CaptureStdout();
    ::testing::internal::CaptureStderr();
    const int code = print_image_table(static_cast<int>(argv.size()), argv.data());
    out_ = ::testing::internal::GetCapturedStdout();
    errors_ = ::testing::internal::GetCapturedStderr();
    return code;
  }
  const rtd::test::TemporaryFolder folder_;
  std::string out_, errors_;
};

TEST_F(ImageTable, prints_a_row_per_object) {
  EXPECT_EQ(run({"--image", path("white.png"), "--model", path("tiny.onnx")}), 0);
  EXPECT_THAT(out_, ::testing::ContainsRegex("white.png +person +1.00 +39 +22 +10 +13\n"));
}

TEST_F(ImageTable, continues_after_a_file_that_is_no_image) {
  EXPECT_EQ(run({"--image", path("tiny.onnx"), path("white.png"), "--model", path("tiny.onnx")}), 1);
  EXPECT_THAT(errors_, HasSubstr("tiny.onnx is missing or not an image"));
  EXPECT_THAT(out_, HasSubstr("person"));
}

TEST_F(ImageTable, names_the_command_to_run_without_weights) {
  EXPECT_EQ(run({"--image", path("white.png"), "--model", "/nowhere/model.onnx"}), 2);
  EXPECT_THAT(errors_, HasSubstr("deploy/setup.sh --models"));
}

TEST_F(ImageTable, refuses_wrong_arguments) {
  EXPECT_EQ(run({"--image", path("white.png"), "--confidence", "7"}), 2);
  EXPECT_EQ(run({"--image"}), 2);
}

TEST(DetectionsMessage, carries_the_stamp_and_frame_of_the_image) {
  const msg::Detection2DArray message = to_message({}, 1'341'846'313'654'184'001);
  EXPECT_EQ(msg::to_ns(message.header.stamp), 1'341'846'313'654'184'001);
  EXPECT_EQ(message.header.frame_id, "camera_color_optical_frame");
  EXPECT_TRUE(message.detections.empty());
}

TEST(DetectionsMessage, gives_boxes_by_centre_and_size) {
  const msg::Detection2DArray message = to_message({{"person", 0.5F, 10, 20, 30, 50}}, 7);
  ASSERT_EQ(message.detections.size(), 1U);
  const msg::Detection2D& box = message.detections[0];
  EXPECT_EQ(msg::to_ns(box.header.stamp), 7);
  EXPECT_DOUBLE_EQ(box.bbox.center.position.x, 25.0);
  EXPECT_DOUBLE_EQ(box.bbox.center.position.y, 45.0);
  EXPECT_DOUBLE_EQ(box.bbox.size_x, 30.0);
  EXPECT_DOUBLE_EQ(box.bbox.size_y, 50.0);
  ASSERT_EQ(box.results.size(), 1U);
  EXPECT_EQ(box.results[0].hypothesis.class_id, "person");
  EXPECT_DOUBLE_EQ(box.results[0].hypothesis.score, 0.5);
}

TEST(MasksMessage, is_a_grey_image_of_the_labels) {
  const msg::Header header{msg::to_time(7), "camera_color_optical_frame"};
  const msg::Image message = to_message({3, 2, {0, 1, 2, 0, 0, 1}}, {9, 8}, header);
  EXPECT_EQ(msg::to_ns(message.header.stamp), 7);
  EXPECT_EQ(message.header.frame_id, "camera_color_optical_frame");
  EXPECT_EQ(message.width, 3U);
  EXPECT_EQ(message.height, 2U);
  EXPECT_EQ(message.encoding, "mono8");
  EXPECT_EQ(message.step, 3U);
  EXPECT_EQ(message.data, (std::vector<std::uint8_t>{0, 1, 2, 0, 0, 1}));
}

TEST(MasksMessage, has_its_size_also_without_people) {
  const msg::Image message = to_message({}, {640, 481}, {});
  EXPECT_EQ(message.width, 160U);
  EXPECT_EQ(message.height, 121U);
  EXPECT_EQ(message.data, std::vector<std::uint8_t>(160U * 121U, 0));
}

constexpr int kAll = 4;

/// A camera of 33 ms, boxes of `boxes_ms`, 8 ms a mask.
MaskBudget budget_with(double boxes_ms) {
  MaskBudget budget;
  for (int frame = 0; frame < 50; ++frame) {
    budget.saw_image(std::int64_t{frame} * 33'000'000);
    budget.took(boxes_ms, 16, 2);
  }
  return budget;
}

TEST(MaskBudget, gives_masks_the_time_that_the_boxes_leave) {
  EXPECT_EQ(MaskBudget().fresh_at_most(kAll), kAll) << "nothing is known yet";
  EXPECT_EQ(budget_with(0.1).fresh_at_most(kAll), kAll);
  EXPECT_EQ(budget_with(12).fresh_at_most(kAll), 2);
  EXPECT_EQ(budget_with(28).fresh_at_most(kAll), 1);
  EXPECT_EQ(budget_with(60).fresh_at_most(kAll), 1) << "never none";
}

TEST(MaskBudget, takes_no_pause_for_the_rate_of_the_camera) {
  MaskBudget budget = budget_with(28);
  budget.saw_image(3'600'000'000'000);
  budget.saw_image(3'600'033'000'000);
  budget.saw_image(0);  // a recording that begins again
  budget.saw_image(33'000'000);
  EXPECT_EQ(budget.fresh_at_most(kAll), 1);
}

}  // namespace
}  // namespace rtd::detector
