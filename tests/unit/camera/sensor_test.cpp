// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>

#include "common/camera/synthetic/scene_camera.hpp"
#include "common/camera/synthetic/sensor.hpp"
#include "common/camera/synthetic/synthetic_source.hpp"
#include "common/camera/synthetic/texture.hpp"

namespace rtd::camera::synthetic {
namespace {

cv::Mat wall_at(float depth_m) {
  return cv::Mat(100, 200, CV_32FC1, cv::Scalar(1.0F / depth_m));
}

struct Statistics {
  double mean_m = 0, sigma_m = 0, measured = 0;
};

Statistics statistics_of(const cv::Mat& depth) {
  double sum = 0, squares = 0, count = 0;
  for (int row = 0; row < depth.rows; ++row) {
    for (int column = 0; column < depth.cols; ++column) {
      const double depth_m = depth.at<std::uint16_t>(row, column) / 5000.0;
      if (depth_m == 0) continue;
      sum += depth_m;
      squares += depth_m * depth_m;
      ++count;
    }
  }
  return {sum / count, std::sqrt(squares / count - sum / count * sum / count),
          count / static_cast<double>(depth.total())};
}

TEST(Sensor, noise_grows_with_the_square_of_depth) {
  const Sensor sensor({}, 1);
  for (const float depth_m : {1.0F, 2.0F, 4.0F}) {
    const Statistics measured = statistics_of(sensor.measure_depth(wall_at(depth_m), 0));
    EXPECT_NEAR(measured.mean_m, depth_m, 0.0015 * depth_m * depth_m) << "unbiased within a fraction of the noise";
    EXPECT_GT(measured.sigma_m, 0.0008 * depth_m * depth_m);
    EXPECT_LT(measured.sigma_m, 0.0022 * depth_m * depth_m);
    EXPECT_EQ(measured.measured, 1.0);
  }
}

TEST(Sensor, measures_nothing_out_of_range) {
  const Sensor sensor({}, 1);
  EXPECT_EQ(cv::countNonZero(sensor.measure_depth(wall_at(0.3F), 0)), 0);
  EXPECT_EQ(cv::countNonZero(sensor.measure_depth(wall_at(7.0F), 0)), 0);
  EXPECT_EQ(cv::countNonZero(sensor.measure_depth(cv::Mat(10, 10, CV_32FC1, cv::Scalar(0)), 0)), 0);
}

TEST(Sensor, loses_the_projectors_shadow_left_of_a_near_object) {
  cv::Mat scene = wall_at(4);
  scene.colRange(100, 150).setTo(1.0F);  // 1 m
  const cv::Mat depth = Sensor({}, 1).measure_depth(scene, 0);
  const int shadow = 50 - cv::countNonZero(depth.row(50).colRange(50, 100));
  EXPECT_NEAR(shadow, 43.5 * (1.0 - 0.25), 2) << "baseline x focal length x difference of 1/z";
  EXPECT_EQ(cv::countNonZero(depth.row(50).colRange(152, 200)), 48) << "none on the right";
}

TEST(Sensor, ideal_sensor_only_rounds) {
  SensorModel model;
  model.noise = false;
  const Sensor sensor(model, 1);
  const cv::Mat depth = sensor.measure_depth(wall_at(2.34567F), 0);
  EXPECT_EQ(depth.at<std::uint16_t>(5, 5), 11728);
  const cv::Mat color(10, 10, CV_8UC3, cv::Scalar(1, 2, 3));
  EXPECT_EQ(cv::norm(sensor.measure_color(color, 0), color), 0);
}

TEST(Sensor, noise_is_the_same_for_the_same_frame_only) {
  const Sensor a({}, 1), b({}, 1), other({}, 2);
  const cv::Mat wall = wall_at(3);
  const auto differ = [](const cv::Mat& x, const cv::Mat& y) { return cv::norm(x, y, cv::NORM_L1) > 0; };
  EXPECT_FALSE(differ(a.measure_depth(wall, 4), b.measure_depth(wall, 4)));
  EXPECT_TRUE(differ(a.measure_depth(wall, 4), a.measure_depth(wall, 5)));
  EXPECT_TRUE(differ(a.measure_depth(wall, 4), other.measure_depth(wall, 4)));
}

TEST(Sensor, colour_noise_has_the_stated_deviation) {
  const cv::Mat grey(100, 200, CV_8UC3, cv::Scalar::all(128));
  cv::Scalar mean, deviation;
  cv::meanStdDev(Sensor({}, 1).measure_color(grey, 3), mean, deviation);
  EXPECT_NEAR(mean[0], 128, 0.1);
  EXPECT_NEAR(deviation[1], 2.0, 0.15);
}

TEST(Sensor, has_noise_for_rows_wider_than_640_px) {
  const Sensor sensor({}, 1);
  const cv::Mat grey(600, Sensor::kWidestRowPx, CV_8UC3, cv::Scalar::all(128));
  cv::Scalar mean, deviation;
  cv::meanStdDev(sensor.measure_color(grey, 3).colRange(3000, Sensor::kWidestRowPx), mean, deviation);
  EXPECT_NEAR(mean[0], 128, 0.1);
  EXPECT_NEAR(deviation[1], 2.0, 0.15);
  const cv::Mat too_wide(1, Sensor::kWidestRowPx + 1, CV_8UC3, cv::Scalar::all(128));
  EXPECT_THROW(sensor.measure_color(too_wide, 0), std::invalid_argument);
}

}  // namespace
}  // namespace rtd::camera::synthetic

namespace rtd::camera {
namespace {

using synthetic::Lens;
using synthetic::SensorFaults;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

SensorFaults parse(const std::string& parameters) {
  return parse_synthetic_options(parse_source_uri("synthetic:office" + parameters)).faults;
}

TEST(SensorFaults, defaults_lie_in_their_ranges) {
  for (const synthetic::FaultParameter& parameter : synthetic::fault_parameters()) {
    const double value = SensorFaults{}.*parameter.value;
    EXPECT_TRUE(value >= parameter.min && value <= parameter.max) << parameter.key;
  }
}

TEST(SensorFaults, every_parameter_is_a_key_of_the_source) {
  for (const synthetic::FaultParameter& parameter : synthetic::fault_parameters()) {
    const std::string key = parameter.key;
    EXPECT_EQ(parse("?" + key + "=" + std::to_string(parameter.max)).*parameter.value, parameter.max) << key;
  }
}

TEST(SensorFaults, single_parameters_override_a_preset) {
  const SensorFaults kinect = parse("?sensor=kinect"), mixed = parse("?sensor=kinect&holes=0.3");
  EXPECT_GT(kinect.rolling_shutter_ms, 0);
  EXPECT_EQ(mixed.rolling_shutter_ms, kinect.rolling_shutter_ms);
  EXPECT_EQ(mixed.holes, 0.3);
  EXPECT_NE(parse("?sensor=d435").disparity_step_px, kinect.disparity_step_px);
}

TEST(SensorFaults, refuse_what_is_unknown_or_out_of_range) {
  EXPECT_THAT([] { parse("?holes=2"); },
              ThrowsMessage<SourceError>(AllOf(HasSubstr("holes is '2'"), HasSubstr("[0, 0.9]"))));
  EXPECT_THAT([] { parse("?hole=0.2"); }, ThrowsMessage<SourceError>(HasSubstr("did you mean 'holes'?")));
  EXPECT_THAT([] { parse("?sensor=kinnect"); },
              ThrowsMessage<SourceError>(AllOf(HasSubstr("'kinnect'"), HasSubstr("kinect, d435"))));
}

TEST(SyntheticOptions, refuse_words_that_a_parameter_does_not_know) {
  EXPECT_THAT([] { parse("?timing=maybe"); },
              ThrowsMessage<SourceError>(HasSubstr("timing is 'maybe', allowed are unknown, known")));
  EXPECT_THAT(
      [] { parse("?motion=still"); },
      ThrowsMessage<SourceError>(HasSubstr("motion is 'still', allowed are handheld, watching, tour, rolling")));
  EXPECT_THAT([] { parse("?figures=real"); },
              ThrowsMessage<SourceError>(HasSubstr("figures is 'real', allowed are plain, drawn")));
  EXPECT_THAT([] { parse("?timings=known"); }, ThrowsMessage<SourceError>(HasSubstr("did you mean 'timing'?")));
}

TEST(SyntheticOptions, frames_say_how_the_sensor_is_timed_only_on_request) {
  const auto first_image = [](const std::string& parameters) {
    return make_source("synthetic:static?frames=1&width=64&height=48&rolling_shutter_ms=30&depth_lag_ms=-5" +
                       parameters)
        ->next()
        ->image;
  };
  for (const char* parameters : {"", "&timing=unknown"}) {
    EXPECT_EQ(first_image(parameters).readout_s, 0) << parameters;
    EXPECT_EQ(first_image(parameters).depth_offset_s, 0) << parameters;
  }
  EXPECT_EQ(first_image("&timing=known").readout_s, 0.03);
  EXPECT_EQ(first_image("&timing=known").depth_offset_s, -0.005);
}

TEST(FrameDrops, lose_a_share_at_random_places) {
  const FrameDrops drops(0.1, 3);
  EXPECT_EQ(drops.arrived_before(1000), 900U);
  std::map<std::uint64_t, int> gaps;
  for (std::uint64_t frame = 0; frame < 900; ++frame) {
    const std::uint64_t exposure = drops.exposure_of(frame);
    ASSERT_EQ(drops.arrived_before(exposure), frame);
    ASSERT_EQ(drops.arrived_before(exposure + 1), frame + 1);
    ++gaps[drops.exposure_of(frame + 1) - exposure];
  }
  EXPECT_GT(gaps[2], 50);
  EXPECT_GT(gaps[3], 0) << "two in a row";
}

TEST(FrameDrops, none_lose_nothing) {
  const FrameDrops drops(0, 3);
  EXPECT_EQ(drops.exposure_of(1'000'000'000'000), 1'000'000'000'000U);
}

geometry::CameraModel freiburg1(double factor) {
  geometry::CameraModel::Parameters parameters;
  parameters.width = 160;
  parameters.height = 120;
  parameters.fx = parameters.fy = 131.25;
  parameters.cx = 79.5;
  parameters.cy = 59.5;
  parameters.distortion = synthetic::lens_distortion(factor);
  return geometry::CameraModel(parameters);
}

TEST(Lens, shows_a_point_where_the_distortion_puts_it) {
  const geometry::CameraModel camera = freiburg1(1);
  const Lens lens(camera);
  const geometry::CameraModel::Parameters& pinhole = lens.pinhole().parameters();
  ASSERT_GT(pinhole.width, 160);
  synthetic::Rendering seen;
  const cv::Size size(pinhole.width, pinhole.height);
  seen.color_bgr = cv::Mat::zeros(size, CV_8UC3);
  seen.inverse_depth = cv::Mat::zeros(size, CV_32FC1);
  seen.moving_mask = cv::Mat::zeros(size, CV_8UC1);
  seen.material = cv::Mat::zeros(size, CV_8UC1);
  seen.object = cv::Mat(size, CV_16SC1, cv::Scalar(synthetic::kRoomItself));
  const cv::Rect spot(20, 15, 5, 5);
  seen.color_bgr(spot).setTo(cv::Scalar::all(255));
  seen.inverse_depth(spot).setTo(0.5);
  seen.moving_mask(spot).setTo(255);
  seen.object(spot).setTo(0);
  const synthetic::Rendering bent = lens.bent(seen);
  const Eigen::Vector2d undistorted(22 - (pinhole.cx - 79.5), 17 - (pinhole.cy - 59.5));
  const Eigen::Vector2d expected = camera.distort(undistorted);
  EXPECT_GT((expected - undistorted).norm(), 1) << "a lens that bends";
  const auto objects = synthetic::find_objects(bent);
  ASSERT_EQ(objects.size(), 1U);
  const cv::Rect box = objects[0].bounds_px;
  EXPECT_NEAR(box.x + (box.width - 1) / 2.0, expected.x(), 0.8);
  EXPECT_NEAR(box.y + (box.height - 1) / 2.0, expected.y(), 0.8);
  EXPECT_TRUE(objects[0].moving);
  EXPECT_EQ(bent.color_bgr.at<cv::Vec3b>((box.tl() + box.br()) / 2), cv::Vec3b::all(255));
  EXPECT_EQ(cv::countNonZero(bent.inverse_depth), objects[0].visible_px);
}

TEST(Lens, without_distortion_leaves_the_image) {
  const Lens lens(freiburg1(0));
  EXPECT_EQ(lens.pinhole().parameters(), freiburg1(0).parameters());
  synthetic::Rendering seen;
  seen.color_bgr = cv::Mat::zeros(120, 160, CV_8UC3);
  EXPECT_EQ(lens.bent(seen).color_bgr.data, seen.color_bgr.data);
}

TEST(Miscalibrated, is_off_by_the_stated_share) {
  const geometry::CameraModel::Parameters truth = freiburg1(1).parameters();
  const auto known = synthetic::miscalibrated(freiburg1(1), 0.015, 2).parameters();
  EXPECT_NEAR(std::abs(known.fx / truth.fx - 1), 0.015, 1e-9);
  EXPECT_NEAR(std::abs(known.cx - truth.cx), 0.015 * 160, 1e-9);
  EXPECT_NEAR(std::abs(known.cy - truth.cy), 0.015 * 120, 1e-9);
  EXPECT_EQ(synthetic::miscalibrated(freiburg1(1), 0, 2).parameters(), truth);
}

}  // namespace
}  // namespace rtd::camera

namespace rtd::camera::synthetic {
namespace {

const cv::Size kSize(120, 80);
constexpr double kFps = 30;

cv::Mat grey(int level) {
  return {kSize, CV_8UC3, cv::Scalar::all(level)};
}

ColorFaults with_exposure(double ev) {
  SensorFaults faults;
  faults.exposure_ev = ev;
  return {faults, kSize, kFps, 1};
}

TEST(ColorFaults, none_leave_the_image) {
  const ColorFaults faults({}, kSize, kFps, 1);
  cv::Mat image = grey(100);
  faults.expose(image, 2.5);
  EXPECT_EQ(cv::norm(image, grey(100), cv::NORM_L1), 0);
  EXPECT_EQ(faults.compressed(image).data, image.data);
}

TEST(ColorFaults, vignetting_darkens_the_corners) {
  SensorFaults faults;
  faults.vignetting = 0.4;
  cv::Mat image = grey(200);
  ColorFaults(faults, kSize, kFps, 1).expose(image, 0);
  EXPECT_EQ(image.at<cv::Vec3b>(40, 60)[0], 200);
  for (const cv::Point corner : {cv::Point(0, 0), cv::Point(119, 0), cv::Point(0, 79), cv::Point(119, 79)}) {
    EXPECT_NEAR(image.at<cv::Vec3b>(corner)[1], 120, 1);
  }
}

TEST(ColorFaults, exposure_follows_the_light_with_a_lag_of_five_frames) {
  const ColorFaults faults = with_exposure(1.5);
  constexpr double kLagS = 5 / kFps;
  double largest_ev = 0;
  int decaying = 0, wrong = 0;
  for (double t_s = 1; t_s < 60; t_s += 1 / kFps) {
    const double error_ev = faults.exposure_error_ev(t_s);
    largest_ev = std::max(largest_ev, std::abs(error_ev));
    if (std::abs(error_ev) < 0.2) continue;
    ++wrong;
    if (std::abs(faults.exposure_error_ev(t_s + kLagS) / error_ev - std::exp(-1)) < 0.02) ++decaying;
  }
  EXPECT_EQ(faults.exposure_error_ev(0), 0);
  EXPECT_LE(largest_ev, 1.5);
  EXPECT_GT(largest_ev, 1.0);
  EXPECT_GT(wrong, 100);
  EXPECT_GT(decaying, wrong / 2) << "unless the light changes again meanwhile";
}

TEST(ColorFaults, a_stop_doubles_the_light) {
  const ColorFaults faults = with_exposure(1.5);
  double t_s = 1;
  while (std::abs(faults.exposure_error_ev(t_s) + 1) > 0.05) t_s += 0.01;  // one stop too dark
  cv::Mat image = grey(200);
  faults.expose(image, t_s);
  EXPECT_NEAR(image.at<cv::Vec3b>(3, 3)[0], 200 * std::pow(0.5, 1 / 2.2), 5);
}

TEST(ColorFaults, jpeg_loses_little) {
  SensorFaults faults;
  faults.jpeg = 80;
  cv::Mat image(kSize, CV_8UC3);
  SeededRandom random(1);
  for (int row = 0; row < image.rows; ++row) {
    for (int column = 0; column < image.cols; ++column) {
      image.at<cv::Vec3b>(row, column) = cv::Vec3b::all(static_cast<std::uint8_t>(100 + column / 2 + random.index(9)));
    }
  }
  const cv::Mat compressed = ColorFaults(faults, kSize, kFps, 1).compressed(image);
  ASSERT_EQ(compressed.size(), image.size());
  const double rms = cv::norm(compressed, image) / std::sqrt(static_cast<double>(3 * image.total()));
  EXPECT_GT(rms, 0.5);
  EXPECT_LT(rms, 5);
}

}  // namespace
}  // namespace rtd::camera::synthetic
