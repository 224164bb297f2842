// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "common/camera/calibration.hpp"
#include "common/camera/frame_source.hpp"
#include "common/camera/lens_models.hpp"
#include "common/camera/recording/ros_images.hpp"
#include "tests/unit/camera/sequence_folder.hpp"

namespace rtd::camera {
namespace {

using Eigen::Vector2d;
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

/// 0: of no known camera.
double known_fx(const char* folder) {
  const std::optional<Calibration> known = known_calibration(folder);
  return known ? known->camera.parameters().fx : 0;
}

TEST(KnownCalibration, is_that_of_the_innermost_folder_that_names_a_family) {
  constexpr double kFr1 = 517.306408, kFr2 = 520.908620, kFr3 = 535.4;
  EXPECT_EQ(known_fx("/data/rgbd_dataset_freiburg1_xyz"), kFr1);
  EXPECT_EQ(known_fx("/data/fr2_desk"), kFr2);
  EXPECT_EQ(known_fx("/data/freiburg1/fr3_walking_xyz"), kFr3);
  EXPECT_EQ(known_fx("/data/FR3/seq"), kFr3);
  for (const char* unknown : {"/data/fr12", "/data/afr1", "/data/office"}) EXPECT_EQ(known_fx(unknown), 0) << unknown;
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

constexpr std::array<double, 5> kD455 = {-0.0553, 0.0663, -0.0006, 0.0003, -0.0215};

/// librealsense's rsutil.h, written down again.
Vector2d librealsense(const Vector2d& n, bool modified) {
  const auto& [k1, k2, p1, p2, k3] = kD455;
  const double r2 = n.squaredNorm(), f = 1 + k1 * r2 + k2 * r2 * r2 + k3 * r2 * r2 * r2;
  const double xf = n.x() * f, yf = n.y() * f, x = modified ? xf : n.x(), y = modified ? yf : n.y();
  return {xf + 2 * p1 * x * y + p2 * (r2 + 2 * x * x), yf + 2 * p2 * x * y + p1 * (r2 + 2 * y * y)};
}

msg::CameraInfo info_of(const std::string& model, const std::vector<double>& coefficients) {
  msg::CameraInfo info;
  info.width = 640;
  info.height = 480;
  info.k = {385, 0, 321, 0, 386, 243, 0, 0, 1};
  info.distortion_model = model;
  info.d = coefficients;
  return info;
}

geometry::CameraModel camera_of(const std::string& model, const std::vector<double>& coefficients) {
  return to_camera_model(info_of(model, coefficients), "/color/image_raw", "topic /info");
}

/// How far the ideal pixel is from that of `undistorted`, at the worst of many pixels of the camera's own image.
double worst_px(const geometry::CameraModel& camera, const std::function<Vector2d(const Vector2d&)>& undistorted) {
  const auto& p = camera.parameters();
  double worst = 0;
  for (double u = 0; u <= p.width; u += 20) {
    for (double v = 0; v <= p.height; v += 20) {
      const Vector2d n = undistorted({(u - p.cx) / p.fx, (v - p.cy) / p.fy});
      worst = std::max(worst, (camera.undistort({u, v}) - Vector2d(n.x() * p.fx + p.cx, n.y() * p.fy + p.cy)).norm());
    }
  }
  return worst;
}

TEST(LensModels, inverse_brown_conrady_leads_from_the_image_to_the_ideal_one) {
  const auto truth = [](const Vector2d& n) { return librealsense(n, false); };
  for (const char* name : {"Inverse Brown Conrady", "inverse_brown_conrady"}) {
    EXPECT_LT(worst_px(camera_of(name, {kD455.begin(), kD455.end()}), truth), 0.1) << name;
  }
  EXPECT_GT(worst_px(camera_of("plumb_bob", {kD455.begin(), kD455.end()}), truth), 5) << "the other way round";
}

TEST(LensModels, modified_brown_conrady_moves_the_point_before_its_tangential_part) {
  const geometry::CameraModel camera = camera_of("Modified Brown Conrady", {kD455.begin(), kD455.end()});
  const auto& p = camera.parameters();
  for (const Vector2d& n : {Vector2d(0, 0), Vector2d(0.6, -0.5), Vector2d(-0.7, 0.3)}) {
    const Vector2d raw = librealsense(n, true), ideal(n.x() * p.fx + p.cx, n.y() * p.fy + p.cy);
    EXPECT_LT((camera.distort(ideal) - Vector2d(raw.x() * p.fx + p.cx, raw.y() * p.fy + p.cy)).norm(), 0.1);
  }
}

TEST(LensModels, kannala_brandt_is_the_equidistant_model_and_none_bends_nothing) {
  for (const char* name : {"Kannala Brandt4", "KANNALA_BRANDT4", "equidistant", "fisheye"}) {
    const auto camera = camera_of(name, {0.1, -0.02, 0.003, 0.0004, 0}).parameters();
    EXPECT_EQ(camera.lens, geometry::Lens::kFisheye) << name;
    EXPECT_EQ(camera.distortion, (std::array<double, 8>{0.1, -0.02, 0.003, 0.0004})) << name;
  }
  EXPECT_FALSE(camera_of("None", {0.1, 0.2, 0, 0, 0}).distorted());
  EXPECT_EQ(camera_of("Brown Conrady", {0.1, 0.2, 0, 0, 0.3}).parameters().distortion[4], 0.3);
  EXPECT_FALSE(camera_of("whatever", {0, 0, 0, 0, 0}).distorted());
}

TEST(LensModels, every_other_name_is_refused_by_it) {
  for (const char* name : {"Ftheta", "omnidirectional", "thin_prism_fisheye"}) {
    EXPECT_THAT(
        [&] {
          camera_of(name, {0.9, 0, 0, 0, 0});
        },
        ThrowsMessage<SourceError>(AllOf(HasSubstr(name), HasSubstr("topic /info"), HasSubstr("known:"))));
  }
  EXPECT_THAT(
      [] {
        camera_of("Inverse Brown Conrady", {-1.5, 0, 0, 0, 0});
      },
      ThrowsMessage<SourceError>(HasSubstr("bends the image too much")));
}

TEST(LensModels, calibration_files_know_the_same_names) {
  const Calibration inverse = parse_calibration(
      R"({"width": 640, "height": 480, "fx": 385, "fy": 386, "ppx": 321, "ppy": 243, "model": "Inverse Brown Conrady",
          "coeffs": [-0.0553, 0.0663, -0.0006, 0.0003, -0.0215]})",
      "rs.json");
  EXPECT_LT(worst_px(inverse.camera, [](const Vector2d& n) { return librealsense(n, false); }), 0.1);
  const Calibration nerf = parse_calibration(
      R"({"camera_model": "OPENCV_FISHEYE", "fl_x": 300, "fl_y": 300, "cx": 320, "cy": 240, "w": 640, "h": 480,
          "k1": 0.1, "k2": 0.2, "k3": 0.3, "k4": 0.4})",
      "transforms.json");
  EXPECT_EQ(nerf.camera.parameters().lens, geometry::Lens::kFisheye);
  EXPECT_THAT(
      [] {
        parse_calibration(
            "image_width: 640\nimage_height: 480\ncamera_matrix:\n  data: [385, 0, 321, 0, 386, "
            "243, 0, 0, 1]\ndistortion_model: ftheta\ndistortion_coefficients:\n  data: [1]\n",
            "c.yaml");
      },
      ThrowsMessage<SourceError>(AllOf(HasSubstr("c.yaml"), HasSubstr("'ftheta'"))));
  EXPECT_EQ(parse_calibration(R"({"model": "iPhone14,3", "fx": 1, "fy": 1, "cx": 320, "cy": 240, "w": 640, "h": 480})",
                              "phone.json")
                .camera.parameters()
                .width,
            640);
}

}  // namespace
}  // namespace rtd::camera
