// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/vision/image_codecs.hpp"

#include <gmock/gmock.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>

namespace rtd::vision {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

TEST(ImageCodecs, write_and_read_depth_without_loss) {
  const cv::Mat depth = (cv::Mat_<std::uint16_t>(2, 3) << 0, 1, 255, 256, 5000, 65535);
  std::vector<std::uint8_t> bytes;
  ASSERT_TRUE(image_codecs().encode(".png", depth, bytes, {}));
  const cv::Mat back = image_codecs().decode(bytes, cv::IMREAD_UNCHANGED);
  ASSERT_EQ(back.type(), CV_16UC1);
  EXPECT_EQ(cv::norm(back, depth, cv::NORM_INF), 0);
  EXPECT_TRUE(image_codecs().decode(std::vector<std::uint8_t>(10, 7), cv::IMREAD_COLOR).empty());
  EXPECT_TRUE(image_codecs().read("/nowhere.png", cv::IMREAD_COLOR).empty());
}

/// In a copy of this program in a folder of its own.
TEST(ImageCodecs, DISABLED_say_that_their_library_is_missing) {
  const auto again = [] { image_codecs(); };
  EXPECT_THAT(again, ThrowsMessage<std::runtime_error>(HasSubstr("librtd_image_codecs.so is neither in ")));
  EXPECT_THAT(again, ThrowsMessage<std::runtime_error>(HasSubstr("install RTD-SLAM again"))) << "tried again";
}

TEST(ImageCodecs, say_so_where_their_library_is_missing_or_of_another_version) {
  const fs::path folder = fs::path(testing::TempDir()) / ("rtd_image_codecs_" + std::to_string(getpid()));
  const fs::path program = folder / "program";
  fs::create_directories(folder);
  fs::copy_file(fs::read_symlink("/proc/self/exe"), program);
  const std::string run =
      program.string() + " --gtest_also_run_disabled_tests --gtest_filter=*DISABLED_say* > /dev/null";
  EXPECT_EQ(std::system(run.c_str()), 0);
  fs::copy_file("/proc/self/exe", folder / "librtd_image_codecs.so");  // no library at all
  EXPECT_NE(std::system(run.c_str()), 0) << "another message";
  fs::remove_all(folder);
}

}  // namespace
}  // namespace rtd::vision
