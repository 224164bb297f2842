// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/filter_service.hpp"

#include <gmock/gmock.h>

#include <cstring>
#include <future>
#include <thread>

#include "common/bus/bus_factory.hpp"
#include "common/service/monotonic_clock.hpp"
#include "tests/support/inbox.hpp"
#include "tests/unit/filter/moving_scene.hpp"

namespace rtd::filter {
namespace {

using test_support::Inbox;
constexpr std::chrono::seconds kPatience{15};
constexpr std::uint32_t kFirstDomain = 120;  // in-process domains of this binary, one per test

/// A camera, a detector and a slam around one filter service that runs in a thread.
class FilterServiceTest : public ::testing::Test {
 protected:
  void SetUp() override {
    static std::uint32_t domain = kFirstDomain;
    bus::BusOptions options;
    options.vendor = "inprocess";
    options.domain = domain++;
    bus_ = bus::connect(options);
    frames_ = bus_->writer(bus::topics::kFrame);
    boxes_ = bus_->writer(bus::topics::kDetections);
    results_ = bus_->writer(bus::topics::kTracking);
    events_ = bus_->writer(bus::topics::kKeyframes);
    statuses_ = bus_->writer(bus::topics::kStatus);
    features_ =
        bus_->reader<msg::FeatureFrame>(bus::topics::kFeatures, [this](auto m) { answers_.take(std::move(m)); });
    filter_status_ = bus_->reader<msg::ServiceStatus>(bus::topics::kStatus, [this](auto m) {
      if (m->service == "filter") states_.take(std::move(m));
    });
    frame_ = std::make_unique<msg::RgbdFrame>();
    config_.feedback_timeout_ms = 5000;
  }
  void TearDown() override { EXPECT_EQ(stop(), service::kOk); }

  void start(service::Pace pace, bool with_detector) {
    if (with_detector) detector_beats_.start([this] { say("detector", msg::ServiceState::kReady); });
    running_ = std::async(std::launch::async, [this, pace] {
      service::Heartbeat heartbeat(*bus_, "filter", stop_);
      service::Runtime runtime{*bus_, heartbeat, stop_, pace};
      return FilterService(config_, runtime).run();
    });
    ASSERT_TRUE(wait_state(msg::ServiceState::kReady)) << "the filter did not become ready";
    if (with_detector) std::this_thread::sleep_for(std::chrono::milliseconds(300));  // it has heard the detector
  }
  service::ExitCode stop() {
    detector_beats_.stop();
    stop_.request_stop();
    return running_.valid() ? running_.get() : service::kOk;
  }
  bool wait_state(msg::ServiceState state, std::chrono::milliseconds patience = kPatience) {
    return states_.wait([state](const auto& all) { return !all.empty() && all.back()->state == state; }, patience);
  }
  bool wait_metric(const std::string& name, double value) {
    return states_.wait([&](const auto& all) {
      return !all.empty() && std::any_of(all.back()->metrics.begin(), all.back()->metrics.end(),
                                         [&](const msg::Metric& m) { return m.name == name && m.value == value; });
    });
  }
  void say(const std::string& service, msg::ServiceState state) {
    msg::ServiceStatus status;
    status.service = service;
    status.pid = 1;
    status.state = state;
    statuses_.write(status);
  }

  static std::int64_t stamp(std::uint64_t seq) { return static_cast<std::int64_t>(seq) * 33'333'333 + 1'000'000'000; }
  void send_frame(std::uint64_t seq, std::uint64_t source = 7) {
    const vision::RgbdImage image = scene_.render(seq, 0, 0);
    *frame_ = {};
    frame_->seq = seq;
    frame_->stamp_ns = stamp(seq);
    frame_->source_id = source;
    frame_->intrinsics = {525, 525, 319.5, 239.5};
    frame_->depth_scale_m = image.depth_scale_m;
    frame_->width = 640;
    frame_->height = 480;
    std::memcpy(frame_->color_bgr.data(), image.color_bgr.data, frame_->color_bgr.size());
    std::memcpy(frame_->depth.data(), image.depth.data, sizeof(frame_->depth));
    frames_.write(*frame_);
  }
  /// A person on the block of the scene, or an empty answer.
  void send_boxes(std::uint64_t seq, bool person) {
    msg::Detection2DArray message;
    message.header.stamp = msg::to_time(stamp(seq));
    if (person) {
      const cv::Rect block = test::MovingScene::block(0, 0);
      msg::Detection2D box;
      msg::ObjectHypothesisWithPose result;
      result.hypothesis = {"person", 0.9};
      box.results = {result};
      box.bbox.center.position = {block.x + 0.5 * block.width, block.y + 0.5 * block.height};
      box.bbox.size_x = block.width + 10;
      box.bbox.size_y = block.height + 10;
      message.detections.push_back(box);
    }
    boxes_.write(message);
  }
  void send_result(std::uint64_t seq, std::uint64_t event_count) {
    msg::TrackingResult result{};
    result.seq = seq;
    result.state = msg::TrackingState::kOk;
    result.T_world_camera.rotation_xyzw = {0, 0, 0, 1};
    result.event_count = event_count;
    results_.write(result);
  }

  /// Repeats something every 100 ms until stopped.
  class Beat {
   public:
    void start(std::function<void()> action) {
      token_ = std::make_unique<service::StopToken>();
      thread_ = std::thread([action = std::move(action), token = token_.get()] {
        do action();
        while (!token->wait_for(std::chrono::milliseconds(100)));
      });
    }
    void stop() {
      if (!thread_.joinable()) return;
      token_->request_stop();
      thread_.join();
    }

   private:
    std::unique_ptr<service::StopToken> token_;
    std::thread thread_;
  };

  const test::MovingScene scene_;
  ServiceConfig config_;
  service::StopToken stop_;
  std::shared_ptr<bus::Bus> bus_;
  Inbox<msg::FeatureFrame> answers_;
  Inbox<msg::ServiceStatus> states_;
  std::unique_ptr<msg::RgbdFrame> frame_;
  bus::Writer<msg::RgbdFrame> frames_;
  bus::Writer<msg::Detection2DArray> boxes_;
  bus::Writer<msg::TrackingResult> results_;
  bus::Writer<msg::KeyframeEvent> events_;
  bus::Writer<msg::ServiceStatus> statuses_;
  bus::Reader<msg::FeatureFrame> features_;
  bus::Reader<msg::ServiceStatus> filter_status_;
  Beat detector_beats_;
  std::future<service::ExitCode> running_;
};

TEST_F(FilterServiceTest, pairs_each_frame_with_its_own_boxes) {
  start(service::Pace::kAsap, true);
  send_boxes(0, true);
  send_boxes(1, false);
  for (std::uint64_t seq = 0; seq < 2; ++seq) send_frame(seq);
  ASSERT_TRUE(answers_.wait_count(2));
  EXPECT_EQ(answers_.at(0)->detection_use, msg::DetectionUse::kExact);
  EXPECT_EQ(answers_.at(0)->objects, 1U);
  EXPECT_GT(answers_.at(0)->removed, 20U);
  EXPECT_EQ(answers_.at(1)->detection_use, msg::DetectionUse::kExact);
  EXPECT_EQ(answers_.at(1)->objects, 0U);
  EXPECT_EQ(answers_.at(1)->stamp_ns, stamp(1));
}

TEST_F(FilterServiceTest, publishes_what_moves_to_those_who_listen) {
  Inbox<msg::Image> masks;
  const auto reader =
      bus_->reader<msg::Image>(bus::topics::kDynamicMask, [&](auto mask) { masks.take(std::move(mask)); });
  start(service::Pace::kAsap, true);
  send_boxes(0, true);
  send_frame(0);
  ASSERT_TRUE(masks.wait_count(1));
  EXPECT_EQ(msg::to_ns(masks.at(0)->header.stamp), stamp(0));
  EXPECT_EQ(masks.at(0)->width, 160U);
  const cv::Rect block = test::MovingScene::block(0, 0);
  EXPECT_EQ(masks.at(0)->data.at(static_cast<std::size_t>(160 * (block.y / 4 + 2) + block.x / 4 + 2)), 255);
}

TEST_F(FilterServiceTest, waits_for_boxes_that_come_late) {
  start(service::Pace::kAsap, true);
  send_frame(0);
  EXPECT_FALSE(answers_.wait_count(1, std::chrono::milliseconds(300))) << "answered without the boxes";
  send_boxes(0, true);
  ASSERT_TRUE(answers_.wait_count(1));
  EXPECT_EQ(answers_.at(0)->detection_use, msg::DetectionUse::kExact);
  EXPECT_GT(answers_.at(0)->stage_ms[msg::kStageWaitDetections], 100.0F) << "ms";
}

TEST_F(FilterServiceTest, carries_the_newest_boxes_in_realtime_and_does_not_wait) {
  start(service::Pace::kRealtime, true);
  send_frame(0);
  ASSERT_TRUE(answers_.wait_count(1));
  EXPECT_EQ(answers_.at(0)->detection_use, msg::DetectionUse::kNone);
  send_boxes(0, true);
  send_frame(3);
  ASSERT_TRUE(answers_.wait_count(2));
  EXPECT_EQ(answers_.at(1)->detection_use, msg::DetectionUse::kCarried);
  EXPECT_EQ(answers_.at(1)->objects, 1U);
  send_frame(60);  // the boxes are two seconds old
  ASSERT_TRUE(answers_.wait_count(3));
  EXPECT_EQ(answers_.at(2)->detection_use, msg::DetectionUse::kNone);
}

TEST_F(FilterServiceTest, says_within_half_a_second_that_the_detector_has_gone_and_when_it_is_back) {
  start(service::Pace::kRealtime, true);
  send_frame(0);
  ASSERT_TRUE(wait_state(msg::ServiceState::kRunning));
  detector_beats_.stop();
  const std::int64_t silent_ns = service::monotonic_ns();
  ASSERT_TRUE(wait_state(msg::ServiceState::kDegraded));
  EXPECT_LT(service::monotonic_ns() - silent_ns, 600'000'000) << "0.5 s and the jitter of a busy host";
  send_frame(30);
  ASSERT_TRUE(answers_.wait_count(2));
  EXPECT_EQ(answers_.at(1)->detection_use, msg::DetectionUse::kDetectorGone);
  detector_beats_.start([this] { say("detector", msg::ServiceState::kReady); });
  EXPECT_TRUE(wait_state(msg::ServiceState::kRunning));
}

TEST_F(FilterServiceTest, goes_on_with_geometry_when_the_detector_ends_in_lockstep) {
  start(service::Pace::kLockstep, true);
  detector_beats_.stop();
  say("detector", msg::ServiceState::kFinished);
  send_frame(0);
  ASSERT_TRUE(answers_.wait_count(1));
  EXPECT_EQ(answers_.at(0)->detection_use, msg::DetectionUse::kDetectorGone);
  EXPECT_TRUE(wait_state(msg::ServiceState::kDegraded));
}

TEST_F(FilterServiceTest, does_not_wait_for_a_detector_that_is_switched_off) {
  config_.detector = "off";
  start(service::Pace::kLockstep, true);
  send_frame(0);
  ASSERT_TRUE(answers_.wait_count(1));
  EXPECT_EQ(answers_.at(0)->detection_use, msg::DetectionUse::kNone);
}

TEST_F(FilterServiceTest, waits_in_lockstep_for_slam_and_its_keyframes) {
  start(service::Pace::kLockstep, false);
  send_frame(0);
  ASSERT_TRUE(answers_.wait_count(1));
  send_frame(1);
  send_result(0, 1);
  EXPECT_FALSE(answers_.wait_count(2, std::chrono::milliseconds(300))) << "a keyframe event is still missing";
  msg::KeyframeEvent event{};
  event.T_world_camera.rotation_xyzw = {0, 0, 0, 1};
  events_.write(event);
  EXPECT_TRUE(answers_.wait_count(2));
}

TEST_F(FilterServiceTest, gives_a_repeated_frame_the_same_answer) {
  start(service::Pace::kLockstep, false);
  for (int i = 0; i < 3; ++i) send_frame(0);
  ASSERT_TRUE(answers_.wait_count(3));
  EXPECT_EQ(std::memcmp(answers_.at(0).get(), answers_.at(2).get(), sizeof(msg::FeatureFrame)), 0);
}

TEST_F(FilterServiceTest, answers_a_defective_frame_without_features_and_counts_it) {
  start(service::Pace::kLockstep, false);
  *frame_ = {};
  frame_->width = 100'000;
  frame_->height = 3;
  frames_.write(*frame_);
  ASSERT_TRUE(answers_.wait_count(1));
  EXPECT_EQ(answers_.at(0)->count, 0U);
  EXPECT_TRUE(wait_metric("frames_defective", 1));
  send_frame(1);
  ASSERT_TRUE(answers_.wait_count(2));
  EXPECT_GT(answers_.at(1)->count, 500U);
}

TEST_F(FilterServiceTest, keeps_to_the_first_of_two_cameras) {
  start(service::Pace::kAsap, false);
  send_frame(0, 7);
  send_frame(0, 8);
  send_frame(1, 8);
  send_frame(1, 7);
  ASSERT_TRUE(answers_.wait_count(2));
  EXPECT_EQ(answers_.at(1)->seq, 1U);
  EXPECT_TRUE(wait_metric("frames_foreign", 2));
}

TEST_F(FilterServiceTest, takes_time_that_goes_backwards) {
  start(service::Pace::kAsap, false);
  for (const std::uint64_t seq : {10U, 11U, 2U, 3U}) send_frame(seq);
  ASSERT_TRUE(answers_.wait_count(4));
  EXPECT_EQ(answers_.at(3)->seq, 3U);
}

TEST_F(FilterServiceTest, ends_within_a_second_while_it_waits) {
  start(service::Pace::kLockstep, true);
  send_frame(0);
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  const std::int64_t asked_ns = service::monotonic_ns();
  EXPECT_EQ(stop(), service::kOk);
  EXPECT_LT(service::monotonic_ns() - asked_ns, 1'000'000'000);
}

TEST_F(FilterServiceTest, refuses_a_motion_level_that_does_not_exist) {
  config_.core.motion_levels = {{"dog", "fast"}};
  service::Heartbeat heartbeat(*bus_, "filter", stop_);
  service::Runtime runtime{*bus_, heartbeat, stop_, service::Pace::kAsap};
  EXPECT_THAT([&] { const FilterService service(config_, runtime); },
              testing::ThrowsMessage<service::ConfigError>(testing::HasSubstr("dog")));
}

}  // namespace
}  // namespace rtd::filter
