// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/detector_service.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <vector>

#include "common/bus/vendors.hpp"
#include "common/service/config.hpp"
#include "common/service/load_step.hpp"
#include "common/service/metric_names.hpp"
#include "common/service/model_locator.hpp"
#include "common/service/monotonic_clock.hpp"
#include "common/service/peer_clocks.hpp"
#include "tests/support/detector/tiny_network.hpp"
#include "tests/support/frame_header.hpp"
#include "tests/support/inprocess/inprocess_bus.hpp"
#include "tests/support/noting_backend.hpp"
#include "tests/support/service_fixture.hpp"

namespace rtd::detector {
namespace {

using test_support::Inbox;
using namespace ::testing;

/// A camera and a filter around one detector service.
class DetectorServiceTest : public test_support::ServiceFixture<DetectorService> {
 protected:
  DetectorServiceTest() : frames_(bus_->writer(bus::topics::kFrame)), jpegs_(bus_->writer(bus::topics::kColorJpeg)) {
    receive(bus::topics::kDetections, answer_box_);
    std::filesystem::create_directories(folder_);
    config_.model = (folder_ / "tiny.onnx").string();
    config_.core.class_names = {"person", "box"};
    std::ofstream(config_.model, std::ios::binary) << test::tiny_network_onnx({});
    config_.masks.use = "off";  // whatever this host has
  }
  /// With a network for masks and a reader of them.
  void with_masks() {
    config_.masks.use = "on";
    config_.masks.model = (folder_ / "mask.onnx").string();
    std::ofstream(config_.masks.model, std::ios::binary) << test::tiny_mask_network_onnx();
  }

  /// A 64x64 frame, white in one cell or black.
  void send_frame(std::int64_t stamp_ns, bool white_cell = false) {
    auto frame = std::make_unique<msg::RgbdFrame>();
    *frame = {};
    test_support::fill_header(*frame, 64, 64);
    frame->stamp_ns = stamp_ns;
    if (white_cell) white_cell_of({64, 64, CV_8UC3, frame->color_bgr.data()});
    frames_.write(*frame);
  }
  static void white_cell_of(cv::Mat image) { image(cv::Rect(40, 24, 8, 8)).setTo(cv::Scalar::all(255)); }
  void send_jpeg(std::int64_t stamp_ns, std::vector<std::uint8_t> data) {
    jpegs_.write({{msg::to_time(stamp_ns), "camera_color_optical_frame"}, "jpeg", std::move(data)});
  }
  void expect_refused(const char* text) {
    service::Heartbeat heartbeat(*bus_, "detector", stop_);
    service::Runtime runtime{*bus_, heartbeat, stop_, service::Pace::kLockstep, bus_options_};
    EXPECT_THAT([&] { const DetectorService service(config_, runtime); },
                ThrowsMessage<service::ConfigError>(HasSubstr(text)));
  }
  std::vector<std::int64_t> answered_stamps() const {
    std::vector<std::int64_t> stamps;
    for (const auto& answer : answer_box_.all()) stamps.push_back(msg::to_ns(answer->header.stamp));
    return stamps;
  }

  Inbox<msg::Detection2DArray> answer_box_;
  bus::Writer<msg::RgbdFrame> frames_;
  bus::Writer<msg::CompressedImage> jpegs_;
};

TEST_F(DetectorServiceTest, answers_every_frame_in_lockstep) {
  start(service::Pace::kLockstep);
  for (std::int64_t stamp_ns = 0; stamp_ns < 20; ++stamp_ns) {
    send_frame(stamp_ns);
    ASSERT_TRUE(answer_box_.wait_count(static_cast<std::size_t>(stamp_ns) + 1)) << "frame " << stamp_ns;
    EXPECT_EQ(answered_stamps().back(), stamp_ns);
  }
}

TEST_F(DetectorServiceTest, answers_every_frame_of_the_window_in_order_at_full_speed) {
  start(service::Pace::kAsap);
  std::vector<std::int64_t> sent;
  for (std::int64_t stamp_ns = 0; stamp_ns < 60; ++stamp_ns) {
    send_frame(stamp_ns);
    sent.push_back(stamp_ns);
    if (stamp_ns < 2) continue;
    ASSERT_TRUE(answer_box_.wait_count(static_cast<std::size_t>(stamp_ns) - 1));
  }
  ASSERT_TRUE(answer_box_.wait_count(sent.size()));
  EXPECT_EQ(answered_stamps(), sent);
}

TEST_F(DetectorServiceTest, sends_boxes_and_empty_arrays) {
  start(service::Pace::kLockstep);
  send_frame(1, true);
  ASSERT_TRUE(answer_box_.wait_count(1));
  send_frame(2, false);
  ASSERT_TRUE(answer_box_.wait_count(2));
  const auto answers = answer_box_.all();
  ASSERT_THAT(answers[0]->detections, SizeIs(1));
  EXPECT_EQ(answers[0]->detections[0].results[0].hypothesis.class_id, "person");
  EXPECT_NEAR(answers[0]->detections[0].bbox.center.position.x, 44.0, 0.01);
  EXPECT_NEAR(answers[0]->detections[0].bbox.center.position.y, 28.0, 0.01);
  EXPECT_EQ(answers[0]->header.frame_id, "camera_color_optical_frame");
  EXPECT_THAT(answers[1]->detections, SizeIs(0));
}

TEST_F(DetectorServiceTest, sends_masks_with_the_boxes_of_each_image) {
  with_masks();
  Inbox<msg::Image> masks;
  receive(bus::topics::kPersonMasks, masks);
  start(service::Pace::kLockstep);
  send_frame(1, true);
  ASSERT_TRUE(answer_box_.wait_count(1));
  send_frame(2, false);
  ASSERT_TRUE(answer_box_.wait_count(2));
  ASSERT_TRUE(masks.wait_count(2)) << "also of an image without people";
  const auto sent = masks.all();
  EXPECT_EQ(msg::to_ns(sent[0]->header.stamp), 1);
  EXPECT_EQ(sent[0]->width, 16U);
  EXPECT_EQ(sent[0]->height, 16U);
  EXPECT_EQ(sent[0]->header.frame_id, "camera_color_optical_frame");
  EXPECT_EQ(sent[0]->data[16 * 7 + 11], 1) << "the white cell";
  EXPECT_EQ(sent[0]->data[0], 0);
  EXPECT_EQ(msg::to_ns(sent[1]->header.stamp), 2);
  EXPECT_THAT(sent[1]->data, ::testing::Each(0));
  EXPECT_TRUE(wait_metric(service::metric::kMasks, 1));
  EXPECT_GT(metric(*states_.all().back(), service::metric::kMasksMs).value_or(0), 0.0);
}

TEST_F(DetectorServiceTest, writes_the_masks_of_an_image_before_its_boxes) {
  constexpr std::size_t kImages = 10;
  with_masks();
  Inbox<msg::Image> masks;
  receive(bus::topics::kPersonMasks, masks);
  const auto noting = std::make_shared<test_support::NotingBackend>(bus::inprocess::create_backend(bus_options_));
  bus::Bus bus(noting);
  auto running = std::async(std::launch::async, [&] {
    service::Heartbeat heartbeat(bus, DetectorService::kName, stop_);
    service::Runtime runtime{bus, heartbeat, stop_, service::Pace::kAsap, bus_options_};
    return DetectorService(config_, runtime).run();
  });
  EXPECT_TRUE(wait_state(msg::ServiceState::kReady));
  for (std::size_t i = 0; i < kImages; ++i) {
    send_frame(static_cast<std::int64_t>(i), true);
    EXPECT_TRUE(answer_box_.wait_count(i + 1));
  }
  stop_.request_stop();
  EXPECT_EQ(running.get(), service::kOk);
  std::vector<std::string> wanted;
  for (std::size_t i = 0; i < kImages; ++i)
    wanted.insert(wanted.end(), {bus::topics::kPersonMasks.name, bus::topics::kDetections.name});
  EXPECT_EQ(noting->written({bus::topics::kPersonMasks.name, bus::topics::kDetections.name}), wanted);
}

TEST_F(DetectorServiceTest, masks_of_the_same_images_are_the_same_whoever_computes_them) {
  with_masks();
  Inbox<msg::Image> masks;
  receive(bus::topics::kPersonMasks, masks);
  start(service::Pace::kAsap);
  for (std::int64_t stamp_ns = 0; stamp_ns < 20; ++stamp_ns) {
    send_frame(stamp_ns, stamp_ns % 3 != 0);
    ASSERT_TRUE(masks.wait_count(static_cast<std::size_t>(std::max<std::int64_t>(stamp_ns - 2, 0))));
  }
  ASSERT_TRUE(masks.wait_count(20));
  for (std::size_t i = 0; i < 20; ++i) {
    EXPECT_EQ(msg::to_ns(masks.at(i)->header.stamp), static_cast<std::int64_t>(i));
    EXPECT_EQ(masks.at(i)->data, masks.at(i % 3 == 0 ? 0 : 1)->data) << i;
  }
}

TEST_F(DetectorServiceTest, computes_no_masks_that_have_no_reader) {
  with_masks();
  start(service::Pace::kLockstep);
  EXPECT_TRUE(wait_metric(service::metric::kMasks, 0)) << "says that it can";
  send_frame(1, true);
  ASSERT_TRUE(wait_metric("frames", 1));
  EXPECT_EQ(metric(*states_.all().back(), service::metric::kMasks), 0);
}

TEST_F(DetectorServiceTest, masks_that_are_asked_for_need_their_network) {
  config_.masks.use = "on";
  config_.masks.model = (folder_ / "none.onnx").string();
  expect_refused("none.onnx");
  config_.masks.use = "auto";
  config_.masks.model = config_.model;  // finds boxes
  expect_refused("tiny.onnx");
}

TEST_F(DetectorServiceTest, continues_with_the_cpu_and_names_the_device_in_its_status) {
  config_.core.engine = "onnxruntime:/nowhere.so";
  start(service::Pace::kLockstep);
  EXPECT_TRUE(
      wait_state(msg::ServiceState::kReady, "computes on CPU (OpenCV DNN) in place of onnxruntime:/nowhere.so"));
  send_frame(1, true);
  ASSERT_TRUE(answer_box_.wait_count(1));
  EXPECT_THAT(answer_box_.all()[0]->detections, SizeIs(1));
  EXPECT_TRUE(wait_state(msg::ServiceState::kRunning, "computes on CPU"));
}

TEST_F(DetectorServiceTest, refuses_an_engine_that_does_not_exist) {
  config_.core.engine = "cuda";
  expect_refused("detector.engine: 'cuda' is not an engine");
}

TEST_F(DetectorServiceTest, takes_the_newest_frame_in_realtime_and_counts_the_others) {
  config_.max_rate_hz = 1.0;  // after the first answer it rests for a second, in which all others arrive
  start(service::Pace::kRealtime);
  send_frame(0);
  ASSERT_TRUE(answer_box_.wait_count(1));
  for (std::int64_t stamp_ns = 1; stamp_ns <= 10; ++stamp_ns) {
    send_frame(stamp_ns);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));  // the bus itself keeps only the last 4
  }
  ASSERT_TRUE(answer_box_.wait_count(2));
  EXPECT_THAT(answered_stamps(), ElementsAre(0, 10));
  EXPECT_TRUE(wait_metric("frames_dropped", 9));
}

TEST_F(DetectorServiceTest, keeps_to_the_rate_limit_in_realtime) {
  config_.max_rate_hz = 20.0;
  start(service::Pace::kRealtime);
  const std::int64_t started_ns = service::monotonic_ns();
  for (std::size_t i = 0; i < 5; ++i) {
    send_frame(static_cast<std::int64_t>(i));
    ASSERT_TRUE(answer_box_.wait_count(i + 1));
  }
  EXPECT_GE(service::monotonic_ns() - started_ns, 4 * 50'000'000);
}

TEST_F(DetectorServiceTest, follows_the_load_step_of_a_filter_on_its_own_host_only) {
  start(service::Pace::kRealtime);
  double took_s = 0;
  const auto answers_in_a_second = [&](double filters_host, double step) {
    const std::size_t before = answer_box_.all().size();
    const std::int64_t began_ns = service::monotonic_ns();
    for (int i = 0; i < 100; ++i) {
      say("filter", msg::ServiceState::kRunning, {{"host_id", filters_host}, {service::metric::kLoadStep, step}});
      send_frame(i);
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    took_s = 1e-9 * static_cast<double>(service::monotonic_ns() - began_ns);  // more on a busy host
    return answer_box_.all().size() - before;
  };
  const double here = service::PeerClocks::this_host_id();
  std::size_t answers = answers_in_a_second(here, 4);
  EXPECT_LE(answers, 4 * took_s + 1);
  answers = answers_in_a_second(here, 1e9);
  EXPECT_LE(answers, 4 * took_s + 1) << "more than there are: the last";
  EXPECT_GE(answers_in_a_second(here, 0), 15U);
  EXPECT_GE(answers_in_a_second(here, std::nan("")), 15U);
  EXPECT_GE(answers_in_a_second(here + 1, 4), 15U);
}

TEST_F(DetectorServiceTest, skips_and_counts_a_broken_jpeg) {
  config_.input = "jpeg";
  start(service::Pace::kLockstep);
  cv::Mat image = cv::Mat::zeros(64, 64, CV_8UC3);
  white_cell_of(image);
  std::vector<std::uint8_t> good;
  cv::imencode(".jpg", image, good);
  send_jpeg(1, {});
  send_jpeg(2, {0xFF, 0xD8, 0xFF, 0xE0, 1, 2, 3});
  send_jpeg(3, std::vector<std::uint8_t>(3000, 0x41));
  send_jpeg(4, good);
  ASSERT_TRUE(answer_box_.wait_count(1));
  EXPECT_THAT(answered_stamps(), ElementsAre(4));
  EXPECT_THAT(answer_box_.all()[0]->detections, SizeIs(1));
  EXPECT_TRUE(wait_metric("frames_broken", 3));
}

TEST_F(DetectorServiceTest, asks_for_jpegs_while_the_camera_is_on_another_host) {
  frames_ = {};  // no raw frames on this host
  launch(service::Pace::kLockstep);
  const auto eventually = [this](auto condition) {
    for (int i = 0; i < 500 && !condition(); ++i) {
      say("camera", msg::ServiceState::kReady);
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return condition();
  };
  EXPECT_TRUE(eventually([this] { return jpegs_.matched() == 1; }));
  std::vector<std::uint8_t> jpeg;
  cv::imencode(".jpg", cv::Mat::zeros(64, 64, CV_8UC3), jpeg);
  send_jpeg(1, jpeg);
  EXPECT_TRUE(answer_box_.wait_count(1));
  frames_ = bus_->writer(bus::topics::kFrame);  // the camera has come here
  EXPECT_TRUE(eventually([this] { return jpegs_.matched() == 0; }));
  send_frame(2);
  EXPECT_TRUE(answer_box_.wait_count(2));
  EXPECT_THAT(answered_stamps(), ElementsAre(1, 2));
}

TEST_F(DetectorServiceTest, skips_and_counts_a_frame_of_impossible_size) {
  start(service::Pace::kLockstep);
  auto frame = std::make_unique<msg::RgbdFrame>();
  *frame = {};
  test_support::fill_header(*frame, 100'000, 2);
  frames_.write(*frame);
  send_frame(5);
  ASSERT_TRUE(answer_box_.wait_count(1));
  EXPECT_THAT(answered_stamps(), ElementsAre(5));
  EXPECT_TRUE(wait_metric("topic.rtd/frame.implausible", 1));
}

TEST_F(DetectorServiceTest, reports_how_long_it_took) {
  start(service::Pace::kLockstep);
  send_frame(1);
  ASSERT_TRUE(wait_metric("frames", 1));
  EXPECT_GT(metric(*states_.all().back(), "detect_ms").value_or(0), 0.0);
  EXPECT_TRUE(wait_state(msg::ServiceState::kRunning));
}

TEST_F(DetectorServiceTest, is_not_ready_without_a_filter) {
  stop_receiving();
  launch(service::Pace::kLockstep);
  ASSERT_TRUE(states_.wait([](const auto& all) { return !all.empty() && !all.back()->message.empty(); }));
  for (const auto& status : states_.all()) EXPECT_EQ(status->state, msg::ServiceState::kStarting);
}

TEST_F(DetectorServiceTest, ends_within_a_second_while_frames_wait) {
  start(service::Pace::kAsap);
  for (std::int64_t stamp_ns = 0; stamp_ns < 30; ++stamp_ns) send_frame(stamp_ns);
  const std::int64_t asked_ns = service::monotonic_ns();
  EXPECT_EQ(stop(), service::kOk);
  EXPECT_LT(service::monotonic_ns() - asked_ns, 1'000'000'000);
}

TEST_F(DetectorServiceTest, refuses_to_start_without_weights_or_with_broken_ones) {
  config_.model = "/nowhere/model.onnx";
  expect_refused("deploy/setup.sh --models");
  config_.model = (folder_ / "broken.onnx").string();
  std::ofstream(config_.model) << "<html>404</html>";
  expect_refused("broken.onnx");
}

TEST_F(DetectorServiceTest, answers_with_the_real_network) {
  const service::ModelSearch model = service::find_model("", service::process_environment());
  if (!model) GTEST_SKIP() << model.message;
  config_ = {};
  config_.model = model.path;
  start(service::Pace::kLockstep);
  for (std::size_t i = 0; i < 4; ++i) {
    send_frame(static_cast<std::int64_t>(i));
    ASSERT_TRUE(answer_box_.wait_count(i + 1));
  }
  EXPECT_THAT(answered_stamps(), ElementsAre(0, 1, 2, 3));
}

}  // namespace
}  // namespace rtd::detector
