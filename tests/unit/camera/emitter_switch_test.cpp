// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/recording/emitter_switch.hpp"

#include <gmock/gmock.h>

#include <opencv2/imgproc.hpp>
#include <random>
#include <vector>

#include "common/camera/source_factory.hpp"
#include "tests/unit/camera/image_bag.hpp"
#include "tests/unit/camera/played_frames.hpp"

namespace rtd::camera {
namespace {

using test::ImageBag;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// What an infrared camera sees that moves along a textured wall, `number` images after the start.
cv::Mat wall(int number) {
  std::mt19937 random(7);
  cv::Mat grey(24, 160, CV_8UC1);
  for (int i = 0; i < 24 * 160; ++i) grey.data[i] = static_cast<std::uint8_t>(random() % 160);
  cv::GaussianBlur(grey, grey, {}, 1);
  return grey(cv::Rect(2 * number, 0, 32, 24)).clone();
}

/// The same with dots that move with the camera.
cv::Mat dotted(int number) {
  cv::Mat grey = wall(number);
  std::mt19937 random(3);
  for (int i = 0; i < 40; ++i)
    grey.at<std::uint8_t>(static_cast<int>(random() % 24), static_cast<int>(random() % 32)) = 250;
  return grey;
}

std::string infrared_bag(ImageBag& bag, int images, const std::function<cv::Mat(int)>& image) {
  bag.add("/camera/infra1/camera_info", "sensor_msgs/CameraInfo", ImageBag::camera_info(), 0.5);
  for (int i = 0; i < images; ++i) {
    const double stamp_s = 1 + i / 30.0;
    bag.add("/camera/infra1/image_rect_raw", "sensor_msgs/Image", ImageBag::image(image(i), "mono8", stamp_s), stamp_s);
    bag.add("/camera/depth/image_rect_raw", "sensor_msgs/Image", ImageBag::image(ImageBag::depth(), "16UC1", stamp_s),
            stamp_s);
  }
  return bag.uri() + "?registered=1";
}

TEST(EmitterSwitch, leaves_out_the_images_with_dots_where_every_second_has_them) {
  ImageBag bag;
  const std::string uri = infrared_bag(bag, 25, [](int i) { return i % 2 == 0 ? dotted(i) : wall(i); });
  EXPECT_THAT(make_source(uri)->info().notes, Contains(HasSubstr("the emitter is on in every second image")));
  const test::Played played = test::play_all(uri);
  ASSERT_EQ(played.frames.size(), 12U);
  for (std::size_t i = 0; i < played.frames.size(); ++i) {
    cv::Mat grey;
    cv::cvtColor(played.frames[i].image.color_bgr, grey, cv::COLOR_BGR2GRAY);
    EXPECT_EQ(cv::norm(grey, wall(2 * static_cast<int>(i) + 1), cv::NORM_INF), 0) << "image " << i;
  }
  EXPECT_EQ(played.counters.of(SkipReason::kEmitterDots), 13U);
  EXPECT_EQ(played.counters.frames_left_out(), 0U) << "nothing is lost";
}

TEST(EmitterSwitch, uses_every_image_where_the_emitter_is_always_on_or_off) {
  for (const auto& image : {wall, dotted}) {
    ImageBag bag;
    const std::string uri = infrared_bag(bag, 25, image);
    EXPECT_THAT(make_source(uri)->info().notes, IsEmpty());
    EXPECT_EQ(test::play_all(uri).frames.size(), 25U);
  }
}

TEST(EmitterSwitch, follows_lost_images_and_an_emitter_that_stays_on) {
  EmitterSwitch emitter;
  std::vector<int> wrong;
  const auto show = [&](int number, bool dots) {
    const bool known = emitter.alternates();
    if (emitter.shows_dots(dots ? dotted(number) : wall(number)) != dots && known) wrong.push_back(number);
  };
  for (int i = 0; i < 20; ++i) show(i, i % 2 == 0);
  EXPECT_TRUE(emitter.alternates());
  for (int i = 21; i < 40; ++i) show(i, i % 2 == 0);  // one was lost
  EXPECT_THAT(wrong, IsEmpty());
  for (int i = 0; i < 40; ++i) emitter.shows_dots(dotted(i));
  EXPECT_FALSE(emitter.alternates());
  EXPECT_FALSE(emitter.shows_dots(dotted(41))) << "all have them: they are used";
}

}  // namespace
}  // namespace rtd::camera
