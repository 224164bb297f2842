// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/launcher/run/collector.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <thread>

#include "common/bus/bus_factory.hpp"
#include "tests/support/frame_header.hpp"
#include "tests/support/frame_list.hpp"
#include "tests/support/inprocess/inprocess_bus.hpp"

namespace rtd::launcher {
namespace {

constexpr std::uint64_t kFrames = 30;

/// The services' side of the bus: publishes what they would.
class CollectorTest : public testing::Test {
 protected:
  CollectorTest() { collector_.read_frames(); }
  void publish(std::uint64_t seq) {
    auto frame = frames_.loan();
    test_support::fill_header(*frame, 64, 48);
    frame->seq = seq;
    frame->color_bgr.fill(static_cast<std::uint8_t>(seq));
    frames_.write(std::move(frame));
    auto features = std::make_unique<msg::FeatureFrame>();
    test_support::fill_camera(*features, 64, 48);
    features->seq = seq;
    features->count = 5;
    features_.write(*features);
    msg::TrackingResult result{};
    result.seq = seq;
    result.state = msg::TrackingState::kOk;
    result.T_world_camera.rotation_xyzw = {0, 0, 0, 1};
    result.finished_ns = 20'000'000;
    tracking_.write(result);
  }
  run_record::RunRecord record_when_complete(std::size_t samples) {
    run_record::RunRecord record;
    const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    do {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
      collector_.fill(record);
    } while ((record.samples.size() < samples || record.frames.size() < kFrames) &&
             std::chrono::steady_clock::now() < give_up);
    return record;
  }

  std::shared_ptr<bus::Bus> bus_ = bus::connect({.vendor = bus::inprocess::vendor(), .domain = 71});
  bus::Writer<msg::RgbdFrame> frames_ = bus_->writer(bus::topics::kFrame);
  bus::Writer<msg::FeatureFrame> features_ = bus_->writer(bus::topics::kFeatures);
  bus::Writer<msg::TrackingResult> tracking_ = bus_->writer(bus::topics::kTracking);
  bus::Writer<msg::ServiceStatus> status_ = bus_->writer(bus::topics::kStatus);
  FrameList store_;
  Collector collector_{*bus_, store_, {6, kFrames}};
};

TEST_F(CollectorTest, keeps_every_frame_and_a_few_pictures) {
  for (std::uint64_t seq = 0; seq < kFrames; ++seq) {
    publish(seq);
    std::this_thread::sleep_for(
        std::chrono::milliseconds(20));  // a camera; the encoder lets pictures go rather than wait
  }
  const run_record::RunRecord record = record_when_complete(6);
  ASSERT_EQ(record.frames.size(), kFrames);
  EXPECT_EQ(record.frames_in, kFrames);
  ASSERT_EQ(record.samples.size(), 6U);
  EXPECT_EQ(record.samples[1].seq, 5U);
  EXPECT_EQ(record.samples[1].features.size(), 5U);
  const cv::Mat picture = cv::imdecode(record.samples[1].jpeg, cv::IMREAD_COLOR);
  ASSERT_EQ(picture.size(), cv::Size(64, 48));
  EXPECT_NEAR(picture.at<cv::Vec3b>(20, 20)[0], 5, 3);
}

TEST_F(CollectorTest, keeps_the_masks_of_people_in_its_pictures_when_it_is_to) {
  FrameList store;
  Collector collector(*bus_, store, {.samples = 6, .total = kFrames, .masks = true});
  collector.read_frames();
  auto masks = bus_->writer(bus::topics::kPersonMasks);
  publish(0);
  for (int i = 0; i < 500 && collector.ask(&RecordBuilder::frames_in) == 0; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  run_record::RunRecord record;
  for (int i = 0; i < 500 && (record.samples.empty() || record.samples[0].masks.empty()); ++i) {
    msg::Image people;  // of the frame's stamp, 0
    people.encoding = "mono8";
    people.width = people.step = 16;
    people.height = 12;
    people.data.assign(16 * 12, 1);
    masks.write(people);
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    collector.fill(record);
  }
  ASSERT_EQ(record.samples.size(), 1U);
  EXPECT_EQ(record.samples[0].masks.columns, 16);
}

TEST_F(CollectorTest, receives_from_filter_and_slam_before_the_first_frame) {
  bus::Writer<msg::ServiceStatus> of_filter = bus_->writer(bus::topics::kStatus);
  EXPECT_FALSE(collector_.connected()) << "nothing says that they have found its readers";
  const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(5);
  status_.write({.service = "slam"});
  of_filter.write({.service = "filter"});
  while (!collector_.connected() && std::chrono::steady_clock::now() < give_up) std::this_thread::yield();
  EXPECT_TRUE(collector_.connected());
  tracking_ = {};
  while (collector_.connected() && std::chrono::steady_clock::now() < give_up) std::this_thread::yield();
  EXPECT_FALSE(collector_.connected());
}

TEST_F(CollectorTest, subscribes_to_frames_when_asked) {
  const auto camera = bus::connect({.vendor = bus::inprocess::vendor(), .domain = 72});
  const bus::Writer<msg::RgbdFrame> frames = camera->writer(bus::topics::kFrame);
  FrameList store;
  Collector collector(*camera, store, {});
  EXPECT_EQ(frames.matched(), 0) << "a camera that waits for the launcher waits for this reader";
  collector.read_frames();
  EXPECT_GE(frames.matched(), 1);
}

TEST_F(CollectorTest, shows_the_known_length_and_what_services_complain_about) {
  msg::ServiceStatus status;
  status.service = "filter";
  status.state = msg::ServiceState::kDegraded;
  status.message = "detector gone";
  status_.write(status);
  std::optional<std::string> notice;
  const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(5);
  while (!(notice = collector_.take_notice()) && std::chrono::steady_clock::now() < give_up) std::this_thread::yield();
  EXPECT_EQ(notice, "filter: detector gone");
  EXPECT_EQ(collector_.live().total, kFrames);
}

TEST_F(CollectorTest, a_heartbeat_in_the_name_of_another_connection_does_not_count) {
  const std::shared_ptr<bus::Bus> peer = bus::connect({.vendor = bus::inprocess::vendor(), .domain = 71});
  bus::Writer<msg::ServiceStatus> forger = peer->writer(bus::topics::kStatus);
  const auto status_of = [](std::int64_t pid, double frames_in) {
    return msg::ServiceStatus{.service = "camera", .pid = pid, .metrics = {{"frames_in", frames_in}}};
  };
  status_.write(status_of(10, 3));
  publish(0);
  forger.write(status_of(11, 1e6));  // as a camera that was restarted: its frames would be numbered behind those seen
  status_.write(status_of(10, 4));
  publish(1);
  const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(5);
  run_record::RunRecord record;
  while ((record.frames.size() < 2 || record.frames_in < 4) && std::chrono::steady_clock::now() < give_up) {
    collector_.fill(record);
  }
  EXPECT_EQ(record.frames_in, 4U);
}

TEST_F(CollectorTest, a_frame_with_an_impossible_size_leaves_no_picture) {
  auto frame = frames_.loan();
  test_support::fill_header(*frame, 100'000, 48);
  frames_.write(std::move(frame));
  publish(5);
  run_record::RunRecord record;
  const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(5);
  while (record.samples.empty() && std::chrono::steady_clock::now() < give_up) collector_.fill(record);
  ASSERT_EQ(record.samples.size(), 1U);
  EXPECT_EQ(record.samples[0].seq, 5U);
}

}  // namespace
}  // namespace rtd::launcher
