// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/synthetic/sensor.hpp"

#include <gmock/gmock.h>

#include "common/camera/synthetic/scene_camera.hpp"
#include "common/camera/synthetic/synthetic_source.hpp"

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
  ASSERT_EQ(bent.objects.size(), 1U);
  const cv::Rect box = bent.objects[0].bounds_px;
  EXPECT_NEAR(box.x + (box.width - 1) / 2.0, expected.x(), 0.8);
  EXPECT_NEAR(box.y + (box.height - 1) / 2.0, expected.y(), 0.8);
  EXPECT_TRUE(bent.objects[0].moving);
  EXPECT_EQ(bent.color_bgr.at<cv::Vec3b>((box.tl() + box.br()) / 2), cv::Vec3b::all(255));
  EXPECT_EQ(cv::countNonZero(bent.inverse_depth), bent.objects[0].visible_px);
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
