// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <random>
#include <vector>

#include "common/camera/folder/frame_lists.hpp"
#include "common/camera/open/source_factory.hpp"
#include "common/camera/recording/emitter_switch.hpp"
#include "common/camera/recording/frame_pairer.hpp"
#include "tests/unit/camera/image_bag.hpp"
#include "tests/unit/camera/played_frames.hpp"

namespace rtd::camera {
namespace {

using test::ImageBag;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr std::int64_t kMs = 1'000'000;

StampedMessage at(std::int64_t stamp_ns, std::int64_t recorded_ns) {
  return {stamp_ns, {"/topic", recorded_ns, ros::Wire::kRos1, {}}};
}

/// Two cameras at 30 Hz that drift against each other, shake and lose images.
std::vector<StampedFile> shaky_stamps(std::mt19937& random, double period_ms) {
  std::uniform_real_distribution<double> shake_ms(-6, 6);
  std::vector<StampedFile> stamps;
  for (int i = 0; i < 1500; ++i) {
    if (random() % 10 == 0) continue;
    stamps.push_back({static_cast<std::int64_t>((period_ms * i + shake_ms(random)) * kMs), {}});
  }
  return stamps;
}

TEST(FramePairer, pairs_a_stream_as_the_lists_of_a_folder_are_paired) {
  std::mt19937 random(5);
  const std::vector<StampedFile> colors = shaky_stamps(random, 33.3), depths = shaky_stamps(random, 33.4);
  const std::vector<geometry::StampPair> expected =
      geometry::associate(geometry::stamps_of(colors), geometry::stamps_of(depths), kPairingToleranceNs);

  struct Event {
    std::int64_t recorded_ns;
    bool color;
    std::int64_t stamp_ns;
  };
  std::vector<Event> events;
  for (const StampedFile& color : colors) events.push_back({color.stamp_ns + 10 * kMs, true, color.stamp_ns});
  for (const StampedFile& depth : depths) events.push_back({depth.stamp_ns + 80 * kMs, false, depth.stamp_ns});
  std::sort(events.begin(), events.end(), [](const Event& a, const Event& b) { return a.recorded_ns < b.recorded_ns; });

  FramePairer pairer;
  SkipLog skips;
  std::vector<std::pair<std::int64_t, std::int64_t>> pairs, expected_pairs;
  const auto take_decided = [&] {
    while (const auto pair = pairer.next(skips)) pairs.emplace_back(pair->color.stamp_ns, pair->depth.stamp_ns);
  };
  for (const Event& event : events) {
    event.color ? pairer.add_color(at(event.stamp_ns, event.recorded_ns), skips)
                : pairer.add_depth(at(event.stamp_ns, event.recorded_ns));
    take_decided();
  }
  pairer.finish();
  take_decided();

  for (const auto& [color, depth] : expected)
    expected_pairs.emplace_back(colors[color].stamp_ns, depths[depth].stamp_ns);
  EXPECT_EQ(pairs, expected_pairs);
  EXPECT_EQ(skips.counters().of(SkipReason::kNoDepthPartner), colors.size() - expected_pairs.size());
}

TEST(FramePairer, holds_a_few_frames_only_when_depth_never_comes) {
  FramePairer pairer;
  SkipLog skips;
  for (int i = 0; i < 1000; ++i) {
    pairer.add_color(at(i * kMs, 0), skips);
    EXPECT_FALSE(pairer.next(skips));
  }
  EXPECT_GE(skips.counters().of(SkipReason::kNoDepthPartner), 1000 - FramePairer::kMaxPending);
}

TEST(FramePairer, gives_a_depth_image_once) {
  FramePairer pairer;
  SkipLog skips;
  pairer.add_color(at(100 * kMs, 100 * kMs), skips);
  pairer.add_depth(at(108 * kMs, 108 * kMs));
  pairer.add_color(at(110 * kMs, 110 * kMs), skips);
  EXPECT_FALSE(pairer.next(skips)) << "more may come";
  pairer.finish();
  const auto pair = pairer.next(skips);
  ASSERT_TRUE(pair);
  EXPECT_EQ(pair->color.stamp_ns, 110 * kMs) << "the closer one";
  EXPECT_FALSE(pairer.next(skips));
  EXPECT_EQ(skips.counters().of(SkipReason::kNoDepthPartner), 1U);
}

TEST(FramePairer, the_same_image_once_more_is_no_loss_and_another_one_of_its_stamp_is) {
  FramePairer pairer;
  SkipLog skips;
  const auto add = [&](std::uint8_t publisher_count, std::uint8_t pixel) {
    StampedMessage image = at(kMs, 2 * kMs);
    image.message.bytes = std::vector<std::uint8_t>(10'000, 7);
    image.message.bytes[0] = publisher_count;
    image.message.bytes[9000] = pixel;
    for (std::size_t i = 5000; i < 5010; ++i) image.message.bytes[i] = pixel;
    pairer.add_color(std::move(image), skips);
  };
  add(1, 7);
  add(2, 7);
  EXPECT_EQ(skips.counters().of(SkipReason::kRepeated), 1U);
  EXPECT_EQ(skips.counters().frames_left_out(), 0U);
  EXPECT_EQ(skips.why_none(), "");
  add(3, 8);
  EXPECT_EQ(skips.counters().of(SkipReason::kStampDoubled), 1U);
  EXPECT_EQ(skips.counters().frames_left_out(), 1U);
}

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
