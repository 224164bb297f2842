// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <atomic>
#include <future>
#include <mutex>
#include <opencv2/imgcodecs.hpp>

#include "services/camera/camera_service.hpp"
#include "tests/component/camera/in_process.hpp"
#include "tests/support/eventually.hpp"

namespace rtd::camera {
namespace {

using test::kPatience;
using test::kTinyScene;
using test_support::eventually;
using ::testing::HasSubstr;

class FramePublisherTest : public ::testing::Test {
 protected:
  const std::shared_ptr<bus::Bus> bus_ = test::in_process_bus();
};

TEST_F(FramePublisherTest, encodes_jpeg_while_the_topic_has_readers) {
  std::promise<msg::CompressedImage> jpeg;
  std::promise<msg::CameraInfo> info;
  const auto jpegs = bus_->reader<msg::CompressedImage>(bus::topics::kColorJpeg,
                                                        [&](const auto& message) { jpeg.set_value(*message); });
  const auto infos =
      bus_->reader<msg::CameraInfo>(bus::topics::kCameraInfo, [&](const auto& message) { info.set_value(*message); });
  FramePublisher publisher(*bus_, 90, concurrency::Overflow::kBlock, [] {});
  const auto frame = make_source(std::string(kTinyScene) + "1")->next();
  publisher.open(frame->image.color_bgr.size());
  EXPECT_TRUE(publisher.publish(frame->image));
  auto received = jpeg.get_future();
  ASSERT_EQ(received.wait_for(kPatience), std::future_status::ready);
  EXPECT_EQ(publisher.jpegs().encoded(), 1U);
  const msg::CompressedImage image = received.get();
  EXPECT_EQ(msg::to_ns(image.header.stamp), frame->image.stamp_ns);
  EXPECT_THAT(image.format, HasSubstr("jpeg"));
  EXPECT_EQ(cv::imdecode(image.data, cv::IMREAD_COLOR).size(), cv::Size(64, 48));
  auto received_info = info.get_future();
  ASSERT_EQ(received_info.wait_for(kPatience), std::future_status::ready);
  EXPECT_EQ(received_info.get().width, 64U);
}

TEST_F(FramePublisherTest, publishes_ten_small_pictures_of_the_depth_a_second_while_they_have_readers) {
  std::vector<msg::CompressedImage> pictures;
  std::mutex mutex;
  const auto reader = bus_->reader<msg::CompressedImage>(bus::topics::kDepthJpeg, [&](const auto& message) {
    const std::lock_guard lock(mutex);
    pictures.push_back(*message);
  });
  vision::RgbdImage image = make_source(std::string(kTinyScene) + "1")->next()->image;
  image.color_bgr = cv::Mat(480, 640, CV_8UC3, cv::Scalar::all(9));
  image.depth = cv::Mat(480, 640, CV_16UC1, cv::Scalar(2.0 / image.depth_scale_m));
  {
    FramePublisher publisher(*bus_, 90, concurrency::Overflow::kBlock, [] {});
    for (int i = 0; i < 30; ++i, image.stamp_ns += 33'333'333) publisher.publish(image);
  }
  const auto count = [&] {
    const std::lock_guard lock(mutex);
    return pictures.size();
  };
  eventually([&] { return count() == 10; });
  ASSERT_EQ(count(), 10U);
  const cv::Mat picture = cv::imdecode(pictures.back().data, cv::IMREAD_COLOR);
  EXPECT_EQ(picture.size(), cv::Size(320, 240));
  EXPECT_LT(pictures.back().data.size(), 30'000U);
}

TEST_F(FramePublisherTest, does_not_encode_jpeg_without_readers) {
  FramePublisher publisher(*bus_, 90, concurrency::Overflow::kBlock, [] {});
  const auto frame = make_source(std::string(kTinyScene) + "1")->next();
  publisher.open(frame->image.color_bgr.size());
  EXPECT_TRUE(publisher.publish(frame->image));
  EXPECT_EQ(publisher.jpegs().encoded(), 0U);
}

TEST_F(FramePublisherTest, encodes_every_jpeg_when_nothing_may_be_dropped) {
  std::atomic<int> received{0};
  const auto jpegs = bus_->reader<msg::CompressedImage>(bus::topics::kColorJpeg, [&](const auto&) { ++received; });
  const int kImages = bus::qos_settings(bus::topics::kColorJpeg.profile).depth;  // the reader holds them all
  {
    JpegPublisher publisher(*bus_, 90, concurrency::Overflow::kBlock);
    for (int i = 0; i < kImages; ++i) publisher.offer(cv::Mat(480, 640, CV_8UC3, cv::Scalar(i, i, i)), i);
  }
  eventually([&] { return received == kImages; });
  EXPECT_EQ(received, kImages) << "what waits at the end is published too";
}

TEST_F(FramePublisherTest, leaves_out_jpegs_beyond_a_limit_of_the_rate) {
  const auto jpegs = bus_->reader<msg::CompressedImage>(bus::topics::kColorJpeg, [](const auto&) {});
  JpegPublisher publisher(*bus_, 90, concurrency::Overflow::kBlock);
  const auto encoded_in_a_second = [&](double max_hz, std::int64_t begin_s) {
    publisher.limit_rate(max_hz);
    const std::uint64_t before = publisher.encoded();
    for (int i = 0; i < 30; ++i)
      publisher.offer(cv::Mat(48, 64, CV_8UC3, cv::Scalar::all(9)), begin_s * 1'000'000'000 + i * 33'333'333L);
    eventually([&] { return publisher.waiting() == 0; });
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    return publisher.encoded() - before;
  };
  EXPECT_EQ(encoded_in_a_second(0, 10), 30U);
  EXPECT_EQ(encoded_in_a_second(10, 11), 10U);
  EXPECT_EQ(encoded_in_a_second(3, 12), 3U);
  EXPECT_EQ(encoded_in_a_second(3, 2), 3U) << "a source that begins again";
}

TEST_F(FramePublisherTest, counts_jpegs_replaced_by_newer_ones) {
  std::atomic<std::uint64_t> received{0};
  const auto jpegs = bus_->reader<msg::CompressedImage>(bus::topics::kColorJpeg, [&](const auto&) { ++received; });
  constexpr std::uint64_t kImages = 50;
  std::uint64_t dropped = 0;
  {
    JpegPublisher publisher(*bus_, 90, concurrency::Overflow::kDropOldest);
    for (std::uint64_t i = 0; i < kImages; ++i) publisher.offer(cv::Mat(480, 640, CV_8UC3, cv::Scalar::all(9)), 1);
    dropped = publisher.dropped();
  }
  EXPECT_GT(dropped, 0U);
  eventually([&] { return received == kImages - dropped; });
  EXPECT_EQ(received, kImages - dropped);
}

}  // namespace
}  // namespace rtd::camera
