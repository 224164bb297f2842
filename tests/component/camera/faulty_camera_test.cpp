// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>

#include "common/camera/synthetic/renderer.hpp"
#include "common/camera/synthetic/scene.hpp"
#include "common/camera/synthetic/scene_camera.hpp"
#include "common/camera/synthetic/synthetic_source.hpp"
#include "tests/unit/camera/played_frames.hpp"

namespace rtd::camera {
namespace {

using synthetic::Renderer;
using synthetic::Rendering;
using synthetic::Scene;
using synthetic::take_picture;
using test::play;
using test::play_all;
using test::same;
using ::testing::SizeIs;

const std::string kSmall = "&width=160&height=120";

/// The camera of a synthetic source of this width, without faults.
geometry::CameraModel pinhole(int width) {
  geometry::CameraModel::Parameters parameters;
  parameters.width = width;
  parameters.height = width * 3 / 4;
  parameters.fx = parameters.fy = 525.0 / 640 * width;
  parameters.cx = (parameters.width - 1) / 2.0;
  parameters.cy = (parameters.height - 1) / 2.0;
  return geometry::CameraModel(parameters);
}

const Scene& office() {
  static const Scene scene(synthetic::scene_catalog().front(), 1);
  return scene;
}

/// All that the camera sees at one moment.
Rendering look(Renderer& renderer, double t_s) {
  Rendering seen = renderer.render(office().geometry_at(t_s), office().textures(), office().T_world_camera(t_s));
  for (cv::Mat* image : {&seen.color_bgr, &seen.inverse_depth, &seen.moving_mask}) *image = image->clone();
  return seen;
}

TEST(Shutter, every_row_is_seen_at_its_own_time) {
  Renderer renderer(pinhole(160)), other(pinhole(160));
  constexpr double kTimeS = 2, kReadoutS = 0.2;
  const Rendering rolling = take_picture(renderer, office(), kTimeS, {kReadoutS, 0});
  for (const int first_row : {0, 40, 112}) {
    const cv::Range band(first_row, first_row + 8);
    const Rendering moment = look(other, kTimeS + kReadoutS * (first_row + 3.5 - 59.5) / 119);
    EXPECT_TRUE(same(rolling.color_bgr.rowRange(band), moment.color_bgr.rowRange(band))) << first_row;
    EXPECT_TRUE(same(rolling.inverse_depth.rowRange(band), moment.inverse_depth.rowRange(band))) << first_row;
    EXPECT_TRUE(same(rolling.moving_mask.rowRange(band), moment.moving_mask.rowRange(band))) << first_row;
  }
  EXPECT_FALSE(same(rolling.color_bgr.rowRange(0, 8), look(other, kTimeS).color_bgr.rowRange(0, 8)));
  int visible = 0;
  for (const synthetic::ObjectView& object : synthetic::find_objects(rolling)) visible += object.visible_px;
  EXPECT_EQ(visible, cv::countNonZero(rolling.moving_mask)) << "objects are counted over all bands";
}

TEST(Shutter, blur_is_the_mean_over_the_exposure_and_the_mask_its_middle) {
  Renderer renderer(pinhole(160)), other(pinhole(160));
  constexpr double kTimeS = 2, kExposureS = 0.012;
  const Rendering blurred = take_picture(renderer, office(), kTimeS, {0, kExposureS});
  cv::Mat mean = cv::Mat::zeros(120, 160, CV_64FC3), color;
  for (int i = -2; i <= 2; ++i) {
    look(other, kTimeS + kExposureS * i / 5).color_bgr.convertTo(color, CV_64F);
    mean += color / 5;
  }
  blurred.color_bgr.convertTo(color, CV_64F);
  EXPECT_LE(cv::norm(color, mean, cv::NORM_INF), 0.51);
  const Rendering middle = look(other, kTimeS);
  EXPECT_TRUE(same(blurred.moving_mask, middle.moving_mask));
  EXPECT_TRUE(same(blurred.inverse_depth, middle.inverse_depth));
  EXPECT_FALSE(same(blurred.color_bgr, middle.color_bgr));
}

TEST(FaultyCamera, depth_is_seen_later_than_colour) {
  const auto plain = play("synthetic:office?frames=2&fps=10&noise=0" + kSmall);
  const auto late = play("synthetic:office?frames=1&fps=10&noise=0&depth_lag_ms=100" + kSmall);
  EXPECT_TRUE(same(late[0].image.depth, plain[1].image.depth));
  EXPECT_TRUE(same(late[0].image.color_bgr, plain[0].image.color_bgr));
  EXPECT_TRUE(same(late[0].dynamic_mask, plain[0].dynamic_mask));
}

TEST(FaultyCamera, every_fifth_depth_is_missing) {
  const auto played = play_all("synthetic:office?frames=10&depth_missing_every=5" + kSmall);
  for (std::size_t i = 0; i < 10; ++i) {
    EXPECT_EQ(played.frames[i].has_depth, i % 5 != 4);
    EXPECT_EQ(cv::countNonZero(played.frames[i].image.depth) > 0, i % 5 != 4);
  }
  EXPECT_EQ(played.counters.frames_without_depth, 2U);
}

TEST(FaultyCamera, drops_leave_gaps_in_the_stamps_and_none_in_seq) {
  const std::string uri = "synthetic:office?frames=100&fps=60&drops=0.1&width=64&height=48";
  const auto frames = play(uri);
  ASSERT_THAT(frames, SizeIs(90));
  int gaps = 0;
  for (std::size_t i = 1; i < frames.size(); ++i) {
    EXPECT_EQ(frames[i].image.seq, i);
    const double periods = static_cast<double>(frames[i].image.stamp_ns - frames[i - 1].image.stamp_ns) * 60e-9;
    EXPECT_NEAR(periods, std::round(periods), 1e-3);
    if (periods > 1.5) ++gaps;
  }
  EXPECT_GT(gaps, 4);
  const auto source = make_source(uri);
  EXPECT_THAT(source->groundtruth(), SizeIs(90));
  EXPECT_EQ(source->pass_over(frames[40].image.stamp_ns), 40U);
  EXPECT_TRUE(same(source->next()->image.depth, frames[40].image.depth)) << "later frames stay as they are";
}

TEST(FaultyCamera, default_values_leave_the_bits) {
  std::string all;
  for (const synthetic::FaultParameter& parameter : synthetic::fault_parameters()) {
    const double value = synthetic::SensorFaults{}.*parameter.value;
    all += std::string("&") + parameter.key + "=" + std::to_string(value);
  }
  const auto plain = play("synthetic:flicker?frames=2&fps=3" + kSmall);
  const auto stated = play("synthetic:flicker?frames=2&fps=3" + kSmall + all);
  for (std::size_t i = 0; i < plain.size(); ++i) {
    EXPECT_TRUE(same(plain[i].image.color_bgr, stated[i].image.color_bgr));
    EXPECT_TRUE(same(plain[i].image.depth, stated[i].image.depth));
  }
}

TEST(FaultyCamera, calibration_is_off_and_truth_is_not) {
  const auto plain = play("synthetic:office?frames=2" + kSmall);
  const auto faulty =
      play("synthetic:office?frames=2&calibration_error=0.015&distortion=1&rolling_shutter_ms=21" + kSmall);
  const auto known = faulty[1].image.camera.parameters(), truth = plain[1].image.camera.parameters();
  EXPECT_NEAR(std::abs(known.fx / truth.fx - 1), 0.015, 1e-9);
  EXPECT_NEAR(known.distortion[0], 0.262383, 1e-9);
  EXPECT_TRUE(faulty[1].T_world_camera->isApprox(*plain[1].T_world_camera, 0));
  for (const SourceObject& object : faulty[1].objects) {
    const cv::Mat inside = faulty[1].dynamic_mask(object.box_px);
    EXPECT_GE(cv::countNonZero(inside), object.visible_px);
    EXPECT_EQ(object.box_px & cv::Rect(0, 0, 160, 120), object.box_px);
  }
}

class Preset : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Sensors, Preset, ::testing::Values("kinect", "d435"));

TEST_P(Preset, loses_a_fifth_of_the_depth) {
  const auto frames = play("synthetic:office?frames=4&fps=1&sensor=" + std::string(GetParam()));
  for (const SourceFrame& frame : frames) {
    const double holes = 1 - cv::countNonZero(frame.image.depth) / static_cast<double>(frame.image.depth.total());
    EXPECT_GT(holes, 0.14);
    EXPECT_LT(holes, 0.30);
  }
}

TEST(FaultyCamera, hair_and_dark_cloth_lose_most_of_their_depth) {
  const auto frames = play("synthetic:crowd?frames=4&fps=1&seed=1&dark_holes=0.75&holes=0.2");
  synthetic::SceneSpec crowd;
  for (const synthetic::SceneSpec& scene : synthetic::scene_catalog()) {
    if (scene.name == "crowd") crowd = scene;
  }
  const Scene scene(crowd, 1);
  Renderer renderer(pinhole(640));
  int dark = 0, lost = 0;
  for (int i = 0; i < 4; ++i) {
    const cv::Mat material = renderer.render(scene.geometry_at(i), scene.textures(), scene.T_world_camera(i)).material;
    const cv::Mat is_dark = material == static_cast<int>(synthetic::Material::kDark);
    const cv::Mat is_hole = frames[static_cast<std::size_t>(i)].image.depth == 0;
    dark += cv::countNonZero(is_dark);
    lost += cv::countNonZero(is_dark & is_hole);
  }
  ASSERT_GT(dark, 20000);
  EXPECT_GE(lost, 0.6 * dark);
}

TEST(FaultyCamera, monitors_stand_in_the_room) {
  Renderer renderer(pinhole(640));
  int monitor_px = 0;
  for (int i = 0; i < 10; ++i) {
    const cv::Mat material =
        renderer.render(office().geometry_at(i), office().textures(), office().T_world_camera(i)).material;
    monitor_px += cv::countNonZero(material == static_cast<int>(synthetic::Material::kMonitor));
  }
  EXPECT_GT(monitor_px, 10 * 500);
}

}  // namespace
}  // namespace rtd::camera
