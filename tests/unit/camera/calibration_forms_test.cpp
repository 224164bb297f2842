// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/calibration_forms.hpp"

#include <gmock/gmock.h>

#include "common/camera/calibration.hpp"
#include "common/camera/frame_source.hpp"

namespace rtd::camera {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;
using Parameters = geometry::CameraModel::Parameters;

/// fx fy cx cy, size.
void expect_camera(const Calibration& read, std::array<double, 4> intrinsics, cv::Size size_px) {
  const Parameters& p = read.camera.parameters();
  EXPECT_EQ((std::array<double, 4>{p.fx, p.fy, p.cx, p.cy}), intrinsics) << read.origin;
  EXPECT_EQ(cv::Size(p.width, p.height), size_px) << read.origin;
}

constexpr const char* kOrb2 = R"(%YAML:1.0

#--------------------------------------------------------------------------------------------
# Camera Parameters. Adjust them!
#--------------------------------------------------------------------------------------------

Camera.fx: 517.306408
Camera.fy: 516.469215
Camera.cx: 318.643040
Camera.cy: 255.313989

Camera.k1: 0.262383
Camera.k2: -0.953104
Camera.p1: -0.005358
Camera.p2: 0.002628
Camera.k3: 1.163314

Camera.width: 640
Camera.height: 480

# Camera frames per second
Camera.fps: 30.0
Camera.bf: 40.0
Camera.RGB: 1
ThDepth: 40.0
# Deptmap values factor
DepthMapFactor: 5000.0
ORBextractor.nFeatures: 1000
Viewer.PointSize:2
)";

TEST(CalibrationForms, keys_that_are_too_long_are_passed_over) {
  const std::string above = std::string(100'000, 'k') + ":\n";
  std::string below;
  for (int i = 0; i < 100'000; ++i) below += " a" + std::to_string(i) + ": 1\n";
  const Calibration read = parse_calibration(above + below + kOrb2, "input");
  expect_camera(read, {517.306408, 516.469215, 318.64304, 255.313989}, {640, 480});
}

TEST(CalibrationForms, a_list_may_be_spread_over_many_lines) {
  const std::string lines(200'000, '\n');
  const Calibration read = parse_calibration(
      "image_width: 640\nimage_height: 480\ncamera_matrix:\n  data: [500, 0, 320," + lines + "0, 510, 240, 0, 0, 1]\n",
      "input");
  expect_camera(read, {500, 510, 320, 240}, {640, 480});
}

TEST(CalibrationForms, reads_settings_of_orb_slam2) {
  const Calibration read = parse_calibration(kOrb2, "TUM1.yaml");
  expect_camera(read, {517.306408, 516.469215, 318.64304, 255.313989}, {640, 480});
  EXPECT_EQ(read.camera.parameters().distortion,
            (std::array<double, 8>{0.262383, -0.953104, -0.005358, 0.002628, 1.163314}));
  EXPECT_DOUBLE_EQ(read.depth_scale_m, 1.0 / 5000);
  EXPECT_TRUE(read.depth_factor_given);
  EXPECT_EQ(read.origin, "TUM1.yaml (ORB-SLAM2 settings)");
}

TEST(CalibrationForms, reads_settings_of_orb_slam3_with_their_other_keys) {
  const Calibration read = parse_calibration(
      "%YAML:1.0\nFile.version: \"1.0\"\nCamera.type: \"PinHole\"\nCamera1.fx: 382.613\nCamera1.fy: 382.613\n"
      "Camera1.cx: 320.183\nCamera1.cy: 236.455\nCamera.width: 640\nCamera.height: 480\nCamera.fps: 15\n"
      "Stereo.b: 0.0499585\nRGBD.DepthMapFactor: 1000.0\n"
      "IMU.T_b_c1: !!opencv-matrix\n   rows: 4\n   cols: 4\n   dt: f\n   data: [1,0,0,-0.005,\n      0,1,0,-0.0018,\n"
      "      0,0,1,0.0118, 0,0,0,1]\nORBextractor.nFeatures: 1250\n",
      "RealSense_D435i.yaml");
  expect_camera(read, {382.613, 382.613, 320.183, 236.455}, {640, 480});
  EXPECT_DOUBLE_EQ(read.depth_scale_m, 0.001);
  EXPECT_DOUBLE_EQ(read.fps, 15);
  EXPECT_THAT(read.origin, HasSubstr("ORB-SLAM3"));
}

TEST(CalibrationForms, reads_orb_slam_settings_without_blanks_and_with_windows_line_ends) {
  const Calibration read = parse_calibration(
      "%YAML:1.0\r\nCamera.fx:500\r\nCamera.fy:501\r\nCamera.cx:320\r\nCamera.cy:240\r\nDepthMapFactor:1000\r\n",
      "s.yaml", cv::Size(640, 480));
  expect_camera(read, {500, 501, 320, 240}, {640, 480});
}

TEST(CalibrationForms, reads_a_fisheye_lens_of_orb_slam) {
  const Calibration read = parse_calibration(
      "%YAML:1.0\nCamera.type: \"KannalaBrandt8\"\nCamera.fx: 190\nCamera.fy: 190\nCamera.cx: 254\nCamera.cy: 256\n"
      "Camera.k1: 0.003\nCamera.k2: 0.0007\nCamera.k3: -0.002\nCamera.k4: 0.0002\nCamera.width: 512\n"
      "Camera.height: 512\n",
      "s.yaml");
  EXPECT_EQ(read.camera.parameters().lens, geometry::Lens::kFisheye);
  EXPECT_EQ(read.camera.parameters().distortion, (std::array<double, 8>{0.003, 0.0007, -0.002, 0.0002}));
}

TEST(CalibrationForms, reads_stella_vslam) {
  const Calibration read = parse_calibration(
      "Camera:\n  name: \"TUM RGBD 1\"\n  setup: \"RGBD\"\n  model: \"perspective\"\n\n  fx: 517.3\n  fy: 516.5\n"
      "  cx: 318.6\n  cy: 255.3\n\n  k1: 0.26\n  k2: -0.95\n  p1: -0.005\n  p2: 0.002\n  k3: 1.16\n\n  fps: 30.0\n"
      "  cols: 640\n  rows: 480\n  color_order: \"RGB\"\n\nPreprocessing:\n  depthmap_factor: 5000.0\n",
      "tum.yaml");
  expect_camera(read, {517.3, 516.5, 318.6, 255.3}, {640, 480});
  EXPECT_EQ(read.camera.parameters().distortion[4], 1.16);
  EXPECT_TRUE(read.depth_factor_given);
}

TEST(CalibrationForms, reads_a_camera_info_file) {
  const std::string head = "image_width: 640\nimage_height: 480\ncamera_name: rgb_PS1080\ncamera_matrix:\n  rows: 3\n";
  const Calibration flow = parse_calibration(
      head +
          "  cols: 3\n  data: [525.1, 0, 319.5, 0, 525.2, 239.5, 0, 0, 1]\ndistortion_model: plumb_bob\n"
          "distortion_coefficients:\n  rows: 1\n  cols: 5\n  data: [0.1, -0.2, 0.001, -0.001, 0]\n"
          "rectification_matrix:\n  rows: 3\n  cols: 3\n  data: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n",
      "rgb.yaml");
  expect_camera(flow, {525.1, 525.2, 319.5, 239.5}, {640, 480});
  EXPECT_EQ(flow.camera.parameters().distortion, (std::array<double, 8>{0.1, -0.2, 0.001, -0.001}));
  EXPECT_FALSE(flow.depth_factor_given);
  const Calibration block = parse_calibration(
      head + "  cols: 3\n  data:\n  - 525.1\n  - 0\n  - 319.5\n  - 0\n  - 525.2\n  - 239.5\n  - 0\n  - 0\n  - 1\n",
      "b.yaml");
  expect_camera(block, {525.1, 525.2, 319.5, 239.5}, {640, 480});
}

TEST(CalibrationForms, reads_a_printed_camera_info_message) {
  const Calibration read = parse_calibration(
      "header:\n  stamp:\n    sec: 1\n    nanosec: 0\n  frame_id: camera_color_optical_frame\nheight: 480\nwidth: 640\n"
      "distortion_model: equidistant\nd:\n- 0.1\n- 0.2\n- 0.3\n- 0.4\nk:\n- 606.0\n- 0.0\n- 321.0\n- 0.0\n- 605.0\n"
      "- 244.0\n- 0.0\n- 0.0\n- 1.0\nr:\n- 1.0\n---\n",
      "info.txt");
  expect_camera(read, {606, 605, 321, 244}, {640, 480});
  EXPECT_EQ(read.camera.parameters().lens, geometry::Lens::kFisheye);
}

TEST(CalibrationForms, reads_camchain_of_kalibr_and_sensor_of_euroc) {
  const Calibration chain = parse_calibration(
      "cam0:\n  cam_overlaps: [1]\n  camera_model: pinhole\n  distortion_coeffs: [-0.28, 0.07, 0.0002,\n    1.7e-05]\n"
      "  distortion_model: radtan\n  intrinsics: [458.6, 457.3, 367.2, 248.4]\n  resolution: [752, 480]\n"
      "  rostopic: /cam0/image_raw\ncam1:\n  intrinsics: [1, 1, 1, 1]\n  resolution: [752, 480]\n",
      "camchain.yaml");
  expect_camera(chain, {458.6, 457.3, 367.2, 248.4}, {752, 480});
  EXPECT_EQ(chain.camera.parameters().distortion, (std::array<double, 8>{-0.28, 0.07, 0.0002, 1.7e-05}));
  const Calibration sensor = parse_calibration(
      "%YAML:1.0\nsensor_type: camera\nrate_hz: 20\nresolution: [752, 480]\ncamera_model: pinhole\n"
      "intrinsics: [458.6, 457.3, 367.2, 248.4] #fu, fv, cu, cv\ndistortion_model: radial-tangential\n"
      "distortion_coefficients: [-0.28, 0.07, 0.0002, 1.7e-05]\n",
      "sensor.yaml");
  expect_camera(sensor, {458.6, 457.3, 367.2, 248.4}, {752, 480});
  EXPECT_DOUBLE_EQ(sensor.fps, 20);
}

TEST(CalibrationForms, reads_sensors_of_openloris_whose_order_is_fx_cx_fy_cy) {
  const Calibration read = parse_calibration(
      "%YAML:1.0\nd400_color_optical_frame:\n   sensor_type: camera\n   fps: 30\n   width: 848\n   height: 480\n"
      "   intrinsics: !!opencv-matrix\n      rows: 1\n      cols: 4\n      dt: d\n      data: [ 611.45, 433.20,\n"
      "          611.49, 249.47 ]\nd400_depth_optical_frame:\n   width: 848\n",
      "sensors.yaml");
  expect_camera(read, {611.45, 611.49, 433.2, 249.47}, {848, 480});
  EXPECT_DOUBLE_EQ(read.depth_scale_m, 0.001);
}

TEST(CalibrationForms, reads_json_of_open3d_and_others) {
  expect_camera(parse_calibration(R"({"width": 96, "height": 72, "intrinsic_matrix": [78.75, 0, 0, 0, 78.5, 0, 47.5,
                35.5, 1]})",
                                  "camera_intrinsic.json"),
                {78.75, 78.5, 47.5, 35.5}, {96, 72});
  expect_camera(parse_calibration(R"({"class_name" : "PinholeCameraTrajectory", "parameters" : [ {"extrinsic" : [ 1.0 ],
                "intrinsic" : {"height" : 480, "intrinsic_matrix" : [525.0, 0, 0, 0, 525.0, 0, 319.5, 239.5, 1],
                "width" : 640}}]})",
                                  "trajectory.json"),
                {525, 525, 319.5, 239.5}, {640, 480});
  const Calibration replica = parse_calibration(
      R"({"camera": {"w": 1200, "h": 680, "fx": 600.0, "fy": 600.0, "cx": 599.5, "cy": 339.5, "scale": 6553.5}})",
      "cam_params.json");
  expect_camera(replica, {600, 600, 599.5, 339.5}, {1200, 680});
  EXPECT_DOUBLE_EQ(replica.depth_scale_m, 1 / 6553.5);
  expect_camera(
      parse_calibration(R"({"fl_x": 700, "fl_y": 701, "cx": 320, "cy": 240, "w": 640, "h": 480, "frames": []})",
                        "transforms.json"),
      {700, 701, 320, 240}, {640, 480});
}

TEST(CalibrationForms, reads_cameras_of_colmap) {
  const std::string head = "# Camera list with one line of data per camera:\n# Number of cameras: 1\n";
  expect_camera(parse_calibration(head + "1 PINHOLE 640 480 525 526 320 240\n", "cameras.txt"), {525, 526, 320, 240},
                {640, 480});
  expect_camera(parse_calibration(head + "1 SIMPLE_RADIAL 640 480 525 320 240 0.01\n", "cameras.txt"),
                {525, 525, 320, 240}, {640, 480});
  const Calibration fisheye =
      parse_calibration("1 OPENCV_FISHEYE 640 480 300 301 320 240 0.1 0.2 0.3 0.4\n", "cameras.txt");
  EXPECT_EQ(fisheye.camera.parameters().lens, geometry::Lens::kFisheye);
}

TEST(CalibrationForms, reads_numbers_matrices_and_infos_of_datasets) {
  const cv::Size vga(640, 480);
  expect_camera(parse_calibration("726.28741455078 726.28741455078 354.6496887207 186.46566772461\n", "calibration.txt",
                                  cv::Size(739, 458)),
                {726.28741455078, 726.28741455078, 354.6496887207, 186.46566772461}, {739, 458});
  expect_camera(parse_calibration("585\t0\t320\n0\t586\t240\n0\t0\t1\n", "camera-intrinsics.txt", vga),
                {585, 586, 320, 240}, vga);
  expect_camera(parse_calibration("1170.18 0 647.75 0\n0 1170.18 483.75 0\n0 0 1 0\n0 0 0 1\n", "intrinsic_color.txt",
                                  cv::Size(1296, 968)),
                {1170.18, 1170.18, 647.75, 483.75}, {1296, 968});
  expect_camera(parse_calibration("colorHeight = 968\ncolorToDepthExtrinsics = 1 0 0 0\ncolorWidth = 1296\n"
                                  "fx_color = 1170.187988\nfx_depth = 571.623718\nfy_color = 1170.187988\n"
                                  "mx_color = 647.750000\nmy_color = 483.750000\n",
                                  "scene0000_00.txt"),
                {1170.187988, 1170.187988, 647.75, 483.75}, {1296, 968});
  expect_camera(parse_calibration("m_versionNumber = 4\nm_sensorName = StructureSensor\nm_colorWidth = 640\n"
                                  "m_colorHeight = 480\nm_depthShift = 1000\n"
                                  "m_calibrationColorIntrinsic = 582.871 0 320 0 0 582.871 240 0 0 0 1 0 0 0 0 1 \n",
                                  "info.txt"),
                {582.871, 582.871, 320, 240}, vga);
}

TEST(CalibrationForms, a_negative_fy_is_taken_for_a_y_axis_that_points_up) {
  const Calibration read = parse_calibration("481.20 0 319.50\n0 -480.00 239.50\n0 0 1\n", "K.txt", cv::Size(640, 480));
  expect_camera(read, {481.2, 480, 319.5, 239.5}, {640, 480});
  EXPECT_TRUE(read.y_up);
}

TEST(CalibrationForms, says_what_is_wrong_with_its_value) {
  EXPECT_THAT(
      [] { parse_calibration("Camera.fx: 0\nCamera.fy: 5\nCamera.cx: 1\nCamera.cy: 1\n", "s.yaml", cv::Size(64, 48)); },
      ThrowsMessage<SourceError>(AllOf(HasSubstr("s.yaml (ORB-SLAM2 settings)"), HasSubstr("fx is '0'"))));
  EXPECT_THAT([] { parse_calibration("Camera.fx: 5\nCamera.fy: 5\nCamera.cx: 1\nCamera.cy: 1\n", "s.yaml"); },
              ThrowsMessage<SourceError>(HasSubstr("'height' is missing")));
  EXPECT_THAT(
      [] {
        parse_calibration(
            "cam0:\n  camera_model: omni\n  intrinsics: [1, 300, 300, 320, 240]\n  resolution: [640, 480]\n", "c.yaml");
      },
      ThrowsMessage<SourceError>(AllOf(HasSubstr("'omni'"), HasSubstr("rectify"))));
  EXPECT_THAT([] { parse_calibration("Camera.type: \"PinHole\"\n", "s.yaml"); },
              ThrowsMessage<SourceError>(AllOf(HasSubstr("unknown key"), HasSubstr("ORB-SLAM3"))));
}

TEST(CalibrationForms, damaged_texts_end_without_harm) {
  for (const char* const text :
       {"{", "[[[[", "{\"a\": [1, {\"b\": ]}", "Camera.fx: [", "- - -", ":", "{:}", "k:\n- ["}) {
    EXPECT_THROW(parse_calibration(text, "x"), SourceError) << text;
  }
  EXPECT_THROW(parse_calibration(std::string(100000, '['), "x"), SourceError);
  EXPECT_THROW(parse_calibration("{" + std::string(100000, '{'), "x"), SourceError);
}

TEST(CalibrationRequest, are_read_and_checked) {
  CalibrationRequest request;
  EXPECT_TRUE(take_calibration_parameter(request, "tum:x", "intrinsics", "525,526,319.5,239.5"));
  expect_camera(requested_calibration(request, "", cv::Size(640, 480)), {525, 526, 319.5, 239.5}, {640, 480});
  EXPECT_TRUE(take_calibration_parameter(request, "tum:x", "intrinsics", "525,526,319.5,239.5,320,240"));
  expect_camera(requested_calibration(request, "", cv::Size(640, 480)), {525, 526, 319.5, 239.5}, {320, 240});
  EXPECT_FALSE(take_calibration_parameter(request, "tum:x", "masks", "1"));
  for (const auto& [key, value] :
       {std::pair("intrinsics", "525,526"), std::pair("intrinsics", "a,b,c,d"), std::pair("depth_factor", "0"),
        std::pair("depth_factor", "mm"), std::pair("fps", "-3")}) {
    const std::string name = key, text = value;
    const auto take = [&] { take_calibration_parameter(request, "tum:x", name, text); };
    EXPECT_THAT(take, ThrowsMessage<SourceError>(AllOf(HasSubstr("tum:x"), HasSubstr(text))));
  }
}

}  // namespace
}  // namespace rtd::camera
