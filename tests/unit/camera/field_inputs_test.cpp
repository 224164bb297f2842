// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
// Inputs in the forms that other people have them, where RTD_DATA_DIR has them.
#include <gmock/gmock.h>

#include <cstdlib>
#include <filesystem>

#include "common/camera/frame_source.hpp"
#include "common/camera/source_factory.hpp"
#include "tests/unit/camera/played_frames.hpp"

namespace rtd::camera {
namespace {

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
                    FieldInput{"portrait_images/seq", "", 0, {"turned by 90 degrees", "262,262,119.5,159.5"}},
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
