// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/camera_service.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include <atomic>
#include <condition_variable>
#include <filesystem>
#include <functional>
#include <future>
#include <mutex>

#include "common/geometry/pose_list.hpp"
#include "common/service/config.hpp"
#include "common/service/metric_names.hpp"
#include "common/service/monotonic_clock.hpp"
#include "common/service/peer_clocks.hpp"
#include "tests/component/camera/in_process.hpp"
#include "tests/support/eventually.hpp"
#include "tests/support/inbox.hpp"
#include "tests/support/temporary_folder.hpp"

namespace rtd::camera {
namespace {

using test::kPatience;
using test::kTinyScene;
using test_support::eventually;
using namespace ::testing;

/// Stands for filter and slam: notes every frame, answers those that `answers` accepts.
class FakeTracker {
 public:
  explicit FakeTracker(bus::Bus& bus) : results_(bus.writer(bus::topics::kTracking)) {
    frames_ = bus.reader<msg::RgbdFrame>(bus::topics::kFrame,
                                         [this](const std::shared_ptr<const msg::RgbdFrame>& frame) { take(*frame); });
  }

  /// Whether the n-th frame message (from 0) gets a result. Set before the camera starts.
  std::function<bool(std::uint64_t message, std::uint64_t seq)> answers = [](auto, auto) { return true; };
  /// Called instead of answering at once, when set: the test answers by itself.
  bool manual = false;

  void answer(std::uint64_t seq) {
    msg::TrackingResult result{};
    result.seq = seq;
    ++answered_;
    results_.write(result);
  }
  std::vector<std::uint64_t> seqs() const {
    const std::lock_guard lock(mutex_);
    return seqs_;
  }
  bool wait_for_messages(std::size_t count) {
    std::unique_lock lock(mutex_);
    return arrived_.wait_for(lock, kPatience, [&] { return seqs_.size() >= count; });
  }
  int most_in_flight() const { return most_in_flight_; }
  msg::RgbdFrame last() const {
    const std::lock_guard lock(mutex_);
    return *last_;
  }

 private:
  void take(const msg::RgbdFrame& frame) {
    std::uint64_t message = 0;
    {
      const std::lock_guard lock(mutex_);
      message = seqs_.size();
      seqs_.push_back(frame.seq);
      *last_ = frame;
      most_in_flight_ = std::max(most_in_flight_, static_cast<int>(seqs_.size()) - answered_);
    }
    arrived_.notify_all();
    if (!manual && answers(message, frame.seq)) answer(frame.seq);
  }

  mutable std::mutex mutex_;
  std::condition_variable arrived_;
  std::vector<std::uint64_t> seqs_;
  std::unique_ptr<msg::RgbdFrame> last_ = std::make_unique<msg::RgbdFrame>();
  std::atomic<int> answered_ = 0;
  int most_in_flight_ = 0;
  bus::Writer<msg::TrackingResult> results_;
  bus::Reader<msg::RgbdFrame> frames_;
};

class CameraServiceTest : public ::testing::Test {
 protected:
  void SetUp() override {
    statuses_ = bus_->reader<msg::ServiceStatus>(bus::topics::kStatus, [this](const auto& status) {
      const std::lock_guard lock(mutex_);
      if (status->service == "camera") last_status_ = *status;
    });
    config_.wait_for = {};
  }

  service::ExitCode run(service::Pace pace) {
    service::Heartbeat heartbeat(*bus_, "camera", stop_);
    service::Runtime runtime{*bus_, heartbeat, stop_, pace};
    return CameraService(config_, runtime).run();
  }
  std::future<service::ExitCode> start(service::Pace pace) {
    return std::async(std::launch::async, [this, pace] { return run(pace); });
  }
  msg::ServiceStatus last_status() const {
    const std::lock_guard lock(mutex_);
    return last_status_;
  }
  double metric(const std::string& name) const { return service::find_metric(last_status(), name).value_or(-1); }

  const std::shared_ptr<bus::Bus> bus_ = test::in_process_bus();
  service::StopToken stop_;
  ServiceConfig config_;
  const rtd::test::TemporaryFolder folder_;

 private:
  mutable std::mutex mutex_;
  msg::ServiceStatus last_status_;
  bus::Reader<msg::ServiceStatus> statuses_;
};

std::vector<std::uint64_t> counting_to(std::uint64_t count) {
  std::vector<std::uint64_t> seqs(count);
  for (std::uint64_t i = 0; i < count; ++i) seqs[i] = i;
  return seqs;
}

TEST_F(CameraServiceTest, lockstep_sends_every_frame_once_and_one_at_a_time) {
  FakeTracker tracker(*bus_);
  config_.source = std::string(kTinyScene) + "40";
  EXPECT_EQ(run(service::Pace::kLockstep), service::kOk);
  EXPECT_THAT(tracker.seqs(), ElementsAreArray(counting_to(40)));
  EXPECT_EQ(tracker.most_in_flight(), 1);
  EXPECT_EQ(metric("frames_in"), 40);
  EXPECT_EQ(metric("frames_published"), 40);
  EXPECT_EQ(metric("resends"), 0);
  EXPECT_EQ(metric("frame_id.camera_color_optical_frame"), 1) << "other services name the frame of its images by it";
  EXPECT_EQ(last_status().state, msg::ServiceState::kFinished);
}

TEST_F(CameraServiceTest, asap_fills_its_window_and_never_exceeds_it) {
  FakeTracker tracker(*bus_);
  tracker.manual = true;
  config_.source = std::string(kTinyScene) + "30";
  config_.resend_after_ms = 60000;
  auto running = start(service::Pace::kAsap);
  for (std::uint64_t seq = 0; seq < 30; ++seq) {
    ASSERT_TRUE(tracker.wait_for_messages(seq == 0 ? 1 : std::min<std::size_t>(30, seq + 3)))
        << "the window is not filled";
    tracker.answer(seq);
  }
  EXPECT_EQ(running.get(), service::kOk);
  EXPECT_THAT(tracker.seqs(), ElementsAreArray(counting_to(30)));
  EXPECT_EQ(tracker.most_in_flight(), 3);
}

TEST_F(CameraServiceTest, sends_the_frame_again_while_no_result_comes) {
  FakeTracker tracker(*bus_);
  tracker.answers = [](std::uint64_t message, std::uint64_t seq) { return seq != 1 || message == 3; };
  config_.source = std::string(kTinyScene) + "3";
  config_.resend_after_ms = 50;
  EXPECT_EQ(run(service::Pace::kLockstep), service::kOk);
  EXPECT_THAT(tracker.seqs(), ElementsAre(0, 1, 1, 1, 2));
  EXPECT_EQ(metric("resends"), 2);
  EXPECT_EQ(metric("frames_published"), 3);
}

TEST_F(CameraServiceTest, sends_the_window_again_one_by_one) {
  FakeTracker tracker(*bus_);
  tracker.answers = [](std::uint64_t message, std::uint64_t) { return message == 0 || message >= 5; };
  config_.source = std::string(kTinyScene) + "5";
  config_.resend_after_ms = 300;
  EXPECT_EQ(run(service::Pace::kAsap), service::kOk);
  EXPECT_THAT(tracker.seqs(), ElementsAre(0, 1, 2, 3, 1, 1, 2, 3, 4)) << "none before the one before it has a result";
}

TEST_F(CameraServiceTest, fails_when_no_result_ever_comes) {
  FakeTracker tracker(*bus_);
  tracker.manual = true;
  config_.source = std::string(kTinyScene) + "3";
  config_.result_timeout_s = 0.2;
  EXPECT_EQ(run(service::Pace::kLockstep), service::kRunFailed);
  EXPECT_THAT(last_status().message, HasSubstr("no tracking result for frame 0"));
  EXPECT_EQ(last_status().state, msg::ServiceState::kFailed);
}

TEST_F(CameraServiceTest, realtime_does_not_wait_for_results) {
  FakeTracker tracker(*bus_);
  tracker.answers = [](std::uint64_t, std::uint64_t seq) { return seq == 9; };
  config_.source = std::string(kTinyScene) + "10&fps=100";
  EXPECT_EQ(run(service::Pace::kRealtime), service::kOk);
  EXPECT_EQ(metric("frames_in"), 10);
  EXPECT_EQ(metric("frames_published") + metric("frames_late"), 10);
  EXPECT_EQ(tracker.seqs().size(), static_cast<std::size_t>(metric("frames_published")));
}

/// Plays 20 frames as an earlier process of the camera, and continues.
class ResumedCamera : public CameraServiceTest {
 protected:
  ResumedCamera() {
    config_.source = std::string(kTinyScene) + "100&fps=100";
    config_.source_id = 5;
    config_.frames = 20;
  }
  void begin() {
    EXPECT_EQ(run(service::Pace::kLockstep), service::kOk);
    config_.frames = 0;
  }
  service::ExitCode resume(service::Pace pace, std::chrono::nanoseconds away) {
    config_.resume_after = fmt::format("19,{},{}", static_cast<std::int64_t>(tracker_->last().stamp_ns),
                                       service::monotonic_ns() - away.count());
    return run(pace);
  }
  std::optional<FakeTracker> tracker_;
  void SetUp() override {
    CameraServiceTest::SetUp();
    tracker_.emplace(*bus_);
  }
  void TearDown() override {
    tracker_.reset();
    CameraServiceTest::TearDown();
  }
};

TEST_F(ResumedCamera, gives_every_frame_once_in_lockstep_as_the_same_source) {
  begin();
  EXPECT_EQ(resume(service::Pace::kLockstep, std::chrono::seconds(1)), service::kOk);
  EXPECT_THAT(tracker_->seqs(), ElementsAreArray(counting_to(100)));
  EXPECT_EQ(static_cast<std::uint64_t>(tracker_->last().source_id), 5U);
  EXPECT_EQ(metric("frames_in"), 100);
  EXPECT_EQ(metric("frames_published"), 80);
  config_.frames = 20;
  EXPECT_EQ(run(service::Pace::kLockstep), service::kOk) << "behind its last frame";
  EXPECT_EQ(tracker_->seqs().size(), 100U);
}

TEST_F(ResumedCamera, continues_in_realtime_where_the_recording_would_be_now) {
  config_.source = std::string(kTinyScene) + "0&fps=100";
  begin();
  auto running = std::async(std::launch::async,
                            [this] { return resume(service::Pace::kRealtime, std::chrono::milliseconds(300)); });
  EXPECT_TRUE(tracker_->wait_for_messages(22));
  stop_.request_stop();
  EXPECT_EQ(running.get(), service::kOk);
  EXPECT_GE(tracker_->seqs().at(20), 49U);
  EXPECT_NEAR(metric("frames_published") + metric("frames_late"), metric("frames_in") - 20, 1)
      << "all are accounted for, but for one that the stop may have kept from being sent";
}

TEST_F(ResumedCamera, refuses_a_place_that_it_cannot_read) {
  config_.resume_after = "19,soon";
  EXPECT_THAT([this] { run(service::Pace::kLockstep); },
              ThrowsMessage<service::ConfigError>(HasSubstr("camera.resume_after: '19,soon'")));
}

TEST_F(CameraServiceTest, frame_carries_the_image_and_its_calibration) {
  FakeTracker tracker(*bus_);
  config_.source = std::string(kTinyScene) + "2";
  EXPECT_EQ(run(service::Pace::kLockstep), service::kOk);
  const auto source = make_source(config_.source);
  source->next();
  const auto expected = source->next();
  const auto frame = std::make_unique<msg::RgbdFrame>(tracker.last());
  EXPECT_EQ(frame->stamp_ns, expected->image.stamp_ns);
  EXPECT_EQ(frame->width, 64U);
  EXPECT_EQ(frame->height, 48U);
  EXPECT_DOUBLE_EQ(frame->intrinsics[0], expected->image.camera.parameters().fx);
  EXPECT_DOUBLE_EQ(frame->depth_scale_m, 1.0 / 5000);
  EXPECT_NE(frame->published_ns, 0);
  EXPECT_EQ(std::memcmp(frame->color_bgr.data(), expected->image.color_bgr.data, 64 * 48 * 3), 0);
  EXPECT_EQ(std::memcmp(frame->depth.data(), expected->image.depth.data, 64 * 48 * 2), 0);
  EXPECT_EQ(frame->depth[64 * 48], 0) << "beyond the image";
}

TEST_F(CameraServiceTest, a_busy_computer_gets_fewer_jpegs_at_pace_realtime) {
  std::atomic<int> received{0};
  const auto jpegs = bus_->reader<msg::CompressedImage>(bus::topics::kColorJpeg, [&](const auto&) { ++received; });
  FakeTracker tracker(*bus_);
  auto filter = bus_->writer(bus::topics::kStatus);
  config_.source = std::string(kTinyScene) + "60&fps=60";
  auto code = start(service::Pace::kRealtime);
  while (code.wait_for(std::chrono::milliseconds(20)) != std::future_status::ready) {
    msg::ServiceStatus status;
    status.service = "filter";
    status.state = msg::ServiceState::kRunning;
    status.metrics = {{"host_id", service::PeerClocks::this_host_id()}, {service::metric::kLoadStep, 4}};
    filter.write(status);
  }
  EXPECT_EQ(code.get(), service::kOk);
  EXPECT_GE(received, 2);
  EXPECT_LE(received, 10) << "3 Hz, and what came before the first heartbeat";
}

TEST_F(CameraServiceTest, waits_for_the_configured_services) {
  service::StopToken others;
  service::Heartbeat slam(*bus_, "slam", others);
  config_.wait_for = {"slam"};
  config_.source = std::string(kTinyScene) + "3";
  FakeTracker tracker(*bus_);
  auto running = start(service::Pace::kLockstep);
  eventually([this] { return last_status().message.find("slam") != std::string::npos; });
  EXPECT_THAT(last_status().message, HasSubstr("slam"));
  EXPECT_EQ(running.wait_for(std::chrono::milliseconds(300)), std::future_status::timeout);
  EXPECT_THAT(tracker.seqs(), SizeIs(0));
  slam.set_state(msg::ServiceState::kReady);
  EXPECT_EQ(running.get(), service::kOk);
  EXPECT_THAT(tracker.seqs(), SizeIs(3));
}

TEST_F(CameraServiceTest, waits_for_the_launcher_to_subscribe_to_frames) {
  service::StopToken others;
  service::Heartbeat filter(*bus_, "filter", others);
  filter.set_state(msg::ServiceState::kReady);
  config_.wait_for = {"filter", "launcher"};
  config_.source = std::string(kTinyScene) + "3";
  FakeTracker tracker(*bus_);
  auto running = start(service::Pace::kLockstep);
  eventually([this] { return last_status().message.find("waits for 1 of 2") != std::string::npos; });
  EXPECT_THAT(last_status().message, HasSubstr("waits for 1 of 2 frame readers"));
  EXPECT_EQ(running.wait_for(std::chrono::milliseconds(300)), std::future_status::timeout);
  const bus::FrameReader launcher(*bus_, [](const auto&) {});
  EXPECT_EQ(running.get(), service::kOk);
  EXPECT_THAT(tracker.seqs(), SizeIs(3));
}

TEST_F(CameraServiceTest, names_the_missing_services_when_the_wait_is_over) {
  config_.wait_for = {"filter", "slam"};
  config_.start_timeout_s = 0.1;
  EXPECT_EQ(run(service::Pace::kLockstep), service::kRunFailed);
  EXPECT_THAT(last_status().message, HasSubstr("filter; slam; 1 of 1 frame readers"));
}

TEST_F(CameraServiceTest, ends_at_once_on_a_stop_request) {
  FakeTracker tracker(*bus_);
  config_.source = std::string(kTinyScene) + "0";
  auto running = start(service::Pace::kLockstep);
  ASSERT_TRUE(tracker.wait_for_messages(5));
  stop_.request_stop();
  ASSERT_EQ(running.wait_for(std::chrono::seconds(1)), std::future_status::ready);
  EXPECT_EQ(running.get(), service::kOk);
}

TEST_F(CameraServiceTest, limits_frames_and_writes_the_groundtruth) {
  FakeTracker tracker(*bus_);
  config_.source = std::string(kTinyScene) + "0";
  config_.frames = 4;
  config_.groundtruth_out = (folder_ / "gt.txt").string();
  EXPECT_EQ(run(service::Pace::kLockstep), service::kOk);
  EXPECT_THAT(tracker.seqs(), SizeIs(4));
  EXPECT_THAT(geometry::read_pose_list(std::filesystem::path(config_.groundtruth_out)).poses, SizeIs(4));
}

TEST_F(CameraServiceTest, publishes_the_true_pose_of_each_frame) {
  FakeTracker tracker(*bus_);
  test_support::Inbox<msg::PoseStamped> truth;
  const auto reader =
      bus_->reader<msg::PoseStamped>(bus::topics::kGroundTruth, [truth](auto pose) { truth.take(std::move(pose)); });
  config_.source = std::string(kTinyScene) + "5";
  EXPECT_EQ(run(service::Pace::kLockstep), service::kOk);
  ASSERT_TRUE(truth.wait_count(5));
  const geometry::Trajectory poses = make_source(config_.source)->groundtruth();
  for (std::size_t i = 0; i < 5; ++i) {
    const msg::PoseStamped pose = *truth.at(i);
    EXPECT_EQ(pose.header.frame_id, "world");
    EXPECT_EQ(msg::to_ns(pose.header.stamp), poses[i].stamp_ns);
    EXPECT_NEAR(pose.pose.position.x, poses[i].T_world_body.translation().x(), 1e-9);
    EXPECT_NEAR(pose.pose.position.z, poses[i].T_world_body.translation().z(), 1e-9);
  }
}

TEST_F(CameraServiceTest, refuses_a_source_that_cannot_be_used) {
  config_.source = "tum:/no/such/folder";
  EXPECT_THAT([this] { run(service::Pace::kLockstep); },
              ThrowsMessage<service::ConfigError>(HasSubstr("/no/such/folder does not exist")));
}

}  // namespace
}  // namespace rtd::camera
