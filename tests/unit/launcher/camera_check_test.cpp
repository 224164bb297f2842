// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "services/launcher/doctor/doctor_command.hpp"

namespace rtd::launcher {
namespace {

using camera::DeviceMode;
using camera::Stream;
using ::testing::HasSubstr;

TEST(CameraCheckTest, lists_cameras_with_their_modes_and_what_keeps_them_from_being_used) {
  const std::vector<DeviceMode> modes = {{Stream::kColor, {640, 480}, 30, "RGB8"},
                                         {Stream::kDepth, {640, 480}, 30, "Z16"}};
  Findings findings;
  describe_cameras({{"openni2:1d27/0609@1/5", "PrimeSense", modes, ""},
                    {"realsense-dds:1234", "RealSense", {modes[0]}, "it streams no depth"},
                    {"openni2:2bc5/0401@1/6", "Astra", {}, "no permission"}},
                   findings);
  ASSERT_EQ(findings.size(), 3U);
  EXPECT_EQ(findings[0].verdict, Verdict::kOk);
  EXPECT_EQ(
      findings[0].text,
      "camera: --source openni2:1d27/0609@1/5 (PrimeSense): colour 640 x 480 RGB8 30 Hz; depth 640 x 480 Z16 30 Hz");
  EXPECT_EQ(findings[1].verdict, Verdict::kOk) << "a camera of another program is no fault";
  EXPECT_THAT(findings[1].text, HasSubstr("it streams no depth"));
  EXPECT_EQ(findings[2].verdict, Verdict::kWarn);
}

TEST(CameraCheckTest, says_what_the_build_supports_when_there_is_none) {
  Findings findings;
  describe_cameras({}, findings);
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_THAT(findings[0].text, HasSubstr("openni2"));
}

TEST(CameraCheckTest, a_run_without_its_camera_gets_the_answer_of_the_doctor) {
  EXPECT_THAT(why_no_camera("openni2", "", {}), HasSubstr("'rtd doctor' says:\n  cameras: none is plugged in"));
  const std::vector<camera::FoundCamera> cameras = {{"openni2:1d27/0609@1/5", "PrimeSense", {}, ""},
                                                    {"openni2:2bc5/0401@1/6", "Astra", {}, "no permission"}};
  EXPECT_EQ(why_no_camera("openni2", "", cameras), "");
  EXPECT_EQ(why_no_camera("openni2", "1d27/0609@1/5", cameras), "");
  EXPECT_THAT(why_no_camera("openni2", "2bc5/0401@1/6", cameras), HasSubstr("(Astra): no permission"));
  EXPECT_THAT(why_no_camera("openni2", "1d27/0609@1/9", cameras),
              HasSubstr("camera: --source openni2:1d27/0609@1/5 (PrimeSense)"));
  const std::vector<camera::FoundCamera> on_dds = {{"realsense-dds:1234", "RealSense", {}, ""}};
  EXPECT_EQ(why_no_camera("realsense-dds", "1234", on_dds), "");
  EXPECT_THAT(why_no_camera("realsense-dds", "99", on_dds), HasSubstr("--source 'realsense-dds:99': the camera"));
}

}  // namespace
}  // namespace rtd::launcher
