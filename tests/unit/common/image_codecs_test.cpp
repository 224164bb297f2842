// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/vision/image_codecs.hpp"

#include <dlfcn.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
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

/// In a copy of this program in a folder of its own, which the next test makes.
TEST(ImageCodecs, DISABLED_say_what_is_wrong_with_their_library) {
  const char* const cause = std::getenv("RTD_EXPECTED_CAUSE");
  ASSERT_NE(cause, nullptr);
  for (int i = 0; i < 2; ++i)
    EXPECT_THAT([] { image_codecs(); }, ThrowsMessage<std::runtime_error>(HasSubstr(cause))) << "call " << i;
}

TEST(ImageCodecs, say_so_where_their_library_is_missing_or_broken_or_of_another_version) {
  const fs::path folder = fs::path(testing::TempDir()) / ("rtd_image_codecs_" + std::to_string(getpid()));
  const fs::path program = folder / "program", library = folder / "librtd_image_codecs.so";
  fs::create_directories(folder);
  fs::copy_file("/proc/self/exe", program);
  const auto says = [&](const std::string& cause) {
    const std::string run = "RTD_EXPECTED_CAUSE='" + cause + "' " + program.string() +
                            " --gtest_also_run_disabled_tests --gtest_filter=*DISABLED_say* > /dev/null";
    return std::system(run.c_str()) == 0;
  };
  EXPECT_TRUE(says("librtd_image_codecs.so is neither beside this program"));
  std::ofstream(library) << "no library";
  EXPECT_TRUE(says("cannot be loaded: "));
  Dl_info opencv{};
  ASSERT_NE(dladdr(reinterpret_cast<void*>(&cv::getTickCount), &opencv), 0);
  fs::copy_file(opencv.dli_fname, library, fs::copy_options::overwrite_existing);
  EXPECT_TRUE(says("is of another version: install RTD-SLAM again"));
  EXPECT_FALSE(says("cannot be loaded: ")) << "the causes are told apart";
  fs::remove_all(folder);
}

}  // namespace
}  // namespace rtd::vision
