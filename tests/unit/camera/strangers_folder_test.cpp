// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// What a folder of another person may hold in place of lists, images, calibrations and true poses.
#include <gmock/gmock.h>
#include <sys/stat.h>

#include <cstdlib>
#include <filesystem>
#include <functional>

#include "common/camera/frame_source.hpp"
#include "common/camera/open/source_factory.hpp"
#include "tests/unit/camera/played_frames.hpp"
#include "tests/unit/camera/sequence_folder.hpp"

namespace rtd::camera {
namespace {

namespace fs = std::filesystem;
using namespace ::testing;
using SequenceFolder = test::SequenceFolder;

/// Something in place of a file, and the cause that is named.
struct Odd {
  std::string name, cause;
  std::function<void(const fs::path&)> make;
};

class StrangersSequence : public ::testing::TestWithParam<Odd> {
 protected:
  StrangersSequence() { folder_.three_frames(); }

  void replace(const std::string& file) const {
    fs::remove(folder_.path() / file);
    GetParam().make(folder_.path() / file);
  }
  void refuses(const std::string& file) const { EXPECT_TRUE(test::refuses(folder_.uri(), {file, GetParam().cause})); }

  const SequenceFolder folder_;
};

TEST_P(StrangersSequence, is_refused_with_the_cause_for_its_lists) {
  replace("depth.txt");
  refuses("depth.txt");
}

TEST_P(StrangersSequence, is_refused_with_the_cause_for_its_calibration) {
  replace("calibration.yaml");
  refuses("calibration.yaml");
}

TEST_P(StrangersSequence, plays_without_its_true_poses_and_says_why) {
  replace("groundtruth.txt");
  const auto source = make_source(folder_.uri());
  EXPECT_THAT(source->info().remarks, Contains(AllOf(HasSubstr("ground truth not used"), HasSubstr(GetParam().cause))));
}

TEST_P(StrangersSequence, plays_without_an_image_and_says_why) {
  replace("rgb/1.1.png");
  replace("depth/1.2.png");
  const auto played = test::play_all(folder_.uri());
  EXPECT_THAT(played.frames, SizeIs(1));
  ASSERT_THAT(played.skipped, SizeIs(2));
  EXPECT_THAT(played.skipped[0].detail, AllOf(HasSubstr("1.1.png"), HasSubstr(GetParam().cause)));
  EXPECT_THAT(played.skipped[1].detail, AllOf(HasSubstr("1.2.png"), HasSubstr(GetParam().cause)));
}

INSTANTIATE_TEST_SUITE_P(Files, StrangersSequence,
                         testing::Values(Odd{"pipe", "is a pipe, not a regular file",
                                             [](const fs::path& file) { ASSERT_EQ(mkfifo(file.c_str(), 0600), 0); }},
                                         Odd{"device", "leads out of the folder",
                                             [](const fs::path& file) { fs::create_symlink("/dev/zero", file); }},
                                         Odd{"folder", "this is a folder",
                                             [](const fs::path& file) { fs::create_directory(file); }},
                                         Odd{"sparse", "has 30 GB",
                                             [](const fs::path& file) {
                                               std::ofstream{file};
                                               fs::resize_file(file, 30'000'000'000);
                                             }}),
                         [](const testing::TestParamInfo<Odd>& odd) { return odd.param.name; });

class OutsideTheFolder : public ::testing::Test {
 protected:
  OutsideTheFolder() { folder_.three_frames(); }

  std::string problem(const std::string& parameters = "") const {
    try {
      make_source(folder_.uri() + parameters);
    } catch (const SourceError& error) {
      return error.what();
    }
    return "";
  }

  const SequenceFolder folder_, other_;
};

TEST_F(OutsideTheFolder, no_image_of_a_list_may_lie_and_whether_it_is_there_is_not_said) {
  other_.three_frames();
  const std::string there = (other_.path() / "rgb/1.0.png").string(), missing = (other_.path() / "none.png").string();
  for (const std::string& image : {there, missing, std::string("/etc/passwd"), std::string("../../../etc/passwd"),
                                   std::string("rgb/../../none.png")}) {
    folder_.write("rgb.txt", "1.0 rgb/1.0.png\n1.1 " + image + "\n");
    EXPECT_EQ(problem(), folder_.path().string() + "/rgb.txt:2: '" + image +
                             "' does not lie below the folder of the list; add ?outside=1 to the source to use it all "
                             "the same");
    folder_.write("associations.txt", "1.0 rgb/1.0.png 1.0 depth/1.0.png\n1.1 rgb/1.1.png 1.1 " + image + "\n");
    EXPECT_THAT(problem(), HasSubstr("associations.txt:2: '" + image + "' does not lie below"));
    fs::remove(folder_.path() / "associations.txt");
  }
  folder_.write("rgb.txt", "1.0 rgb/1.0.png\n1.1 " + there + "\n");
  EXPECT_THAT(test::play(folder_.uri() + "?outside=1"), SizeIs(2));
}

TEST_F(OutsideTheFolder, no_link_is_followed_unless_the_user_says_so) {
  other_.three_frames();
  for (const std::string& image : {std::string("1.0.png"), std::string("none.png")}) {
    fs::remove(folder_.path() / "rgb/1.1.png");
    fs::create_symlink(other_.path() / "rgb" / image, folder_.path() / "rgb/1.1.png");
    const auto played = test::play_all(folder_.uri());
    EXPECT_THAT(played.frames, SizeIs(2));
    ASSERT_THAT(played.skipped, SizeIs(1));
    EXPECT_THAT(played.skipped[0].detail, AllOf(HasSubstr("leads out of the folder"), HasSubstr("?outside=1")));
  }
  fs::remove_all(folder_.path() / "rgb");
  fs::create_symlink(other_.path() / "rgb", folder_.path() / "rgb");
  EXPECT_THAT(problem(), AllOf(HasSubstr("no usable frame"), HasSubstr("?outside=1")));
  for (const char* list : {"rgb.txt", "depth.txt"}) fs::remove(folder_.path() / list);
  EXPECT_THAT(problem(), AllOf(HasSubstr("rgb is a link that leads out of it"), HasSubstr("?outside=1")));
  EXPECT_THAT(test::play(folder_.uri() + "?outside=1"), SizeIs(3));
}

TEST(ManyFolders, links_in_a_circle_end_at_once) {
  const SequenceFolder folder;
  fs::remove_all(folder.path() / "rgb");
  fs::remove_all(folder.path() / "depth");
  for (int i = 0; i < 64; ++i) fs::create_symlink(".", folder.path() / ("d" + std::to_string(i)));
  EXPECT_TRUE(test::refuses(folder.uri(), {"has no colour and depth"}));
}

TEST(ManyFolders, are_looked_at_up_to_a_bound) {
  const SequenceFolder folder;
  for (int i = 0; i < 1100; ++i)
    fs::create_directories(folder.path() / ("a" + std::to_string(i % 50)) / std::to_string(i));
  EXPECT_TRUE(test::refuses(folder.uri(), {"more than 1000", "name the one with the sequence"}));
}

// Inputs in the forms that other people have them, where RTD_DATA_DIR has them.

/// Frames are played, or words are in the refusal.
struct FieldInput {
  std::string path, parameters;
  std::size_t frames = 0;
  std::vector<std::string> words = {};
};

class FieldInputs : public testing::TestWithParam<FieldInput> {};

TEST_P(FieldInputs, are_played_or_refused_with_help) {
  const auto& [path, parameters, frames, words] = GetParam();
  const char* const data = std::getenv("RTD_DATA_DIR");
  const std::string input = std::string(data == nullptr ? "" : data) + "/field2/" + path;
  if (!std::filesystem::exists(input)) GTEST_SKIP() << "RTD_DATA_DIR has no field2/" << path;
  try {
    EXPECT_EQ(test::play_all(complete_uri(input) + parameters).frames.size(), frames);
  } catch (const SourceError& error) {
    EXPECT_EQ(frames, 0U) << error.what();
    for (const std::string& word : words) EXPECT_THAT(error.what(), testing::HasSubstr(word));
  }
}

INSTANTIATE_TEST_SUITE_P(
    OfOthers, FieldInputs,
    testing::Values(FieldInput{"message_mode_without_metadata/bag_0.db3", "", 6},
                    FieldInput{"message_mode_without_metadata/bag_0.mcap", "", 6},
                    FieldInput{"realsense_sdk_db3_compressed/rec.db3", "", 6},
                    FieldInput{"every_image_twice/a.mcap", "", 6}, FieldInput{"two_cameras_one_topic/a.mcap", "", 10},
                    FieldInput{"backslash_list/seq", "", 6}, FieldInput{"binning_and_roi/binning.mcap", "", 6},
                    FieldInput{"binning_and_roi/roi.mcap", "", 6}, FieldInput{"infrared_only/a.mcap", "", 6},
                    FieldInput{"nv12_nv21/nv12.mcap", "", 6}, FieldInput{"nv12_nv21/nv21.mcap", "", 6},
                    FieldInput{"tartanair_v2/seq", "?intrinsics=262,262,159.5,119.5", 6},
                    FieldInput{"zstd_image_transport/a.mcap", "", 6},
                    FieldInput{"orbbec_viewer_bag/orbbec.bag", "", 0, {"/cam/sensor_3/frameType_3", "?registered=1"}},
                    FieldInput{"orbbec_viewer_bag/orbbec.bag", "?registered=1", 4},
                    FieldInput{"portrait_images/seq", "", 0, {"turned by 90 degrees", "119.5,159.5&depth_factor=1000"}},
                    FieldInput{"rs_convert_coloured_depth/clip",
                               "?intrinsics=262,262,159.5,119.5",
                               0,
                               {"colours are for people", "rs-convert -r"}},
                    FieldInput{"stray_scanner/recorded", "", 0, {"Stray Scanner", "ffmpeg -i", "-start_number 0"}},
                    FieldInput{"stray_scanner/frames", "", 6},
                    FieldInput{"video_in_recording/ffmpeg.mcap", "", 0, {"FFMPEGPacket", "republish"}},
                    FieldInput{"video_in_recording/video.mcap", "", 0, {"CompressedVideo", "republish"}}));

}  // namespace
}  // namespace rtd::camera
