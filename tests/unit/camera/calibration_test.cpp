// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/calibration.hpp"

#include <gmock/gmock.h>

#include "common/camera/frame_source.hpp"
#include "tests/unit/camera/sequence_folder.hpp"

namespace rtd::camera {
namespace {

using test::SequenceFolder;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr const char* kMinimal = "width: 320\nheight: 240\nfx: 262\nfy: 261\ncx: 160\ncy: 120\n";

auto refuses(const std::string& text, const std::string& part) {
  return [text, part] {
    EXPECT_THAT([&] { parse_calibration(text, "cal.yaml"); }, ThrowsMessage<SourceError>(HasSubstr(part))) << text;
  };
}

TEST(Calibration, has_defaults_for_what_is_optional) {
  const Calibration calibration = parse_calibration(kMinimal, "x");
  EXPECT_DOUBLE_EQ(calibration.depth_scale_m, 1.0 / 5000);
  EXPECT_DOUBLE_EQ(calibration.fps, 30);
  EXPECT_EQ(calibration.readout_s, 0);
  EXPECT_EQ(calibration.depth_offset_s, 0);
  EXPECT_FALSE(calibration.camera.distorted());
  EXPECT_EQ(calibration.camera.parameters().width, 320);
}

TEST(Calibration, survives_writing_and_reading) {
  const Calibration before =
      parse_calibration(std::string(kMinimal) +
                            "k1: 0.2624\nk2: -0.95\np1: -0.005\np2: 0.0026\nk3: 1.16\ndepth_factor: 1000\nfps: 15\n"
                            "readout_s: 0.021\ndepth_offset_s: -0.009\n",
                        "x");
  const Calibration after = parse_calibration(to_yaml(before), "y");
  EXPECT_EQ(after.camera.parameters().distortion, before.camera.parameters().distortion);
  EXPECT_DOUBLE_EQ(after.camera.parameters().fx, 262);
  EXPECT_DOUBLE_EQ(after.depth_scale_m, 0.001);
  EXPECT_DOUBLE_EQ(after.fps, 15);
  EXPECT_DOUBLE_EQ(after.readout_s, 0.021);
  EXPECT_DOUBLE_EQ(after.depth_offset_s, -0.009);
}

TEST(Calibration, does_not_write_times_that_are_not_known) {
  EXPECT_THAT(to_yaml(parse_calibration(kMinimal, "x")), testing::Not(HasSubstr("_s:")));
}

TEST(Calibration, refuses_with_key_line_and_fix) {
  refuses("width: 320\nfocal: 3\n", "cal.yaml:2: unknown key 'focal'")();
  refuses("width: 320\n", "is missing")();
  refuses(std::string(kMinimal) + "fx: 262\n", "occurs twice")();
  refuses("width 320\n", "expected 'key: value'")();
  refuses("fx: nan\n", "cal.yaml:1: fx is 'nan'")();
  refuses("fx: inf\n", "fx is 'inf'")();
  refuses("fx: 0\n", "allowed is a number in [1")();
  refuses("depth_factor: -5000\n", "depth_factor")();
  refuses("fx: 5x\n", "fx is '5x'")();
  refuses("readout_s: 21\n", "cal.yaml:1: readout_s is '21', allowed is a number in [-0.1, 0.1]")();
  refuses("depth_offset_s: -0.2\n", "depth_offset_s is '-0.2', allowed is a number in [-0.1, 0.1]")();
  refuses("depth_offset_s: nan\n", "depth_offset_s is 'nan'")();
}

TEST(Calibration, refuses_sizes_that_no_frame_type_carries) {
  SourceInfo info;
  EXPECT_THAT([&] { apply(parse_calibration(SequenceFolder::calibration(1920, 1440), "cal.yaml"), info); },
              ThrowsMessage<SourceError>(
                  AllOf(HasSubstr("1920 x 1440"), HasSubstr("at most 1920 x 1200"), HasSubstr("scale"))));
}

TEST(Calibration, reads_rational_and_fisheye_lenses_and_writes_them_again) {
  const std::string image = SequenceFolder::calibration(640, 576);
  const Calibration rational = parse_calibration(image + "k1: 0.5\nk4: 0.8\nk6: -0.1\n", "cal.yaml");
  EXPECT_EQ(rational.camera.parameters().distortion, (std::array<double, 8>{0.5, 0, 0, 0, 0, 0.8, 0, -0.1}));
  EXPECT_EQ(parse_calibration(to_yaml(rational), "again").camera.parameters(), rational.camera.parameters());
  const Calibration fisheye = parse_calibration(image + "fisheye: 1\nk1: 0.1\nk4: -0.02\n", "cal.yaml");
  EXPECT_EQ(fisheye.camera.parameters().lens, geometry::Lens::kFisheye);
  EXPECT_EQ(fisheye.camera.parameters().distortion, (std::array<double, 8>{0.1, 0, 0, -0.02}));
  EXPECT_EQ(parse_calibration(to_yaml(fisheye), "again").camera.parameters(), fisheye.camera.parameters());
  EXPECT_THAT([&] { parse_calibration(image + "fisheye: 1\np1: 0.1\n", "cal.yaml"); },
              ThrowsMessage<SourceError>(HasSubstr("remove p1")));
}

TEST(TumFamily, is_read_from_the_innermost_folder_that_names_one) {
  EXPECT_EQ(tum_family("/data/rgbd_dataset_freiburg1_xyz"), 1);
  EXPECT_EQ(tum_family("/data/fr2_desk"), 2);
  EXPECT_EQ(tum_family("/data/freiburg1/fr3_walking_xyz"), 3);
  EXPECT_EQ(tum_family("/data/FR3/seq"), 3);
  EXPECT_EQ(tum_family("/data/fr12"), std::nullopt);
  EXPECT_EQ(tum_family("/data/afr1"), std::nullopt);
  EXPECT_EQ(tum_family("/data/office"), std::nullopt);
}

TEST(LoadCalibration, takes_the_file_first_then_the_family) {
  const SequenceFolder folder("freiburg2_desk");
  EXPECT_DOUBLE_EQ(load_calibration(folder.path()).camera.parameters().fx, 520.908620);
  folder.write("calibration.yaml", SequenceFolder::calibration());
  EXPECT_DOUBLE_EQ(load_calibration(folder.path()).camera.parameters().fx, 52);
}

TEST(LoadCalibration, knows_all_three_families) {
  const SequenceFolder fr1("fr1_a"), fr3("fr3_a");
  EXPECT_DOUBLE_EQ(load_calibration(fr1.path()).camera.parameters().distortion[4], 1.163314);
  EXPECT_DOUBLE_EQ(load_calibration(fr3.path()).camera.parameters().fy, 539.2);
  EXPECT_FALSE(load_calibration(fr3.path()).camera.distorted());
}

TEST(LoadCalibration, knows_the_camera_of_a_bonn_sequence_by_its_name) {
  const SequenceFolder folder("rgbd_bonn_balloon");
  const Calibration bonn = load_calibration(folder.path());
  EXPECT_DOUBLE_EQ(bonn.camera.parameters().fx, 542.822841);
  EXPECT_DOUBLE_EQ(bonn.camera.parameters().cy, 237.756098);
  EXPECT_EQ(bonn.camera.parameters().distortion, (std::array<double, 8>{0.039903, -0.099343, -0.000730, -0.000144, 0}));
  EXPECT_DOUBLE_EQ(bonn.depth_scale_m, 1.0 / 5000);
}

TEST(LoadCalibration, the_innermost_folder_that_names_a_camera_decides) {
  const SequenceFolder folder("rgbd_bonn_crowd/fr2_desk");
  EXPECT_DOUBLE_EQ(load_calibration(folder.path()).camera.parameters().fx, 520.908620);
}

TEST(LoadCalibration, names_what_to_write_when_there_is_none) {
  const SequenceFolder folder("kitchen");
  EXPECT_THAT([&] { load_calibration(folder.path()); },
              ThrowsMessage<SourceError>(AllOf(HasSubstr("calibration.yaml"), HasSubstr("width height fx fy"))));
}

}  // namespace
}  // namespace rtd::camera
