// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/image_table.hpp"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>

#include "tests/support/detector/tiny_network.hpp"

namespace rtd::detector {
namespace {

using ::testing::HasSubstr;

class ImageTable : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* const info = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::temp_directory_path() / (std::string("rtd_image_table_") + info->name());
    std::filesystem::create_directories(folder_);
    std::ofstream(path("tiny.onnx"), std::ios::binary)
        << test::tiny_network_onnx({.metadata = {{"rtd.class_names", "person\nbox"}}});
    cv::Mat image = cv::Mat::zeros(64, 64, CV_8UC3);
    image(cv::Rect(40, 24, 8, 8)).setTo(cv::Scalar::all(255));
    cv::imwrite(path("white.png"), image);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

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
  std::filesystem::path folder_;
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

}  // namespace
}  // namespace rtd::detector
