// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstring>
#include <functional>
#include <thread>

#include "services/filter/filter_service.hpp"
#include "tests/support/service_fixture.hpp"
#include "tests/unit/filter/moving_scene.hpp"

namespace rtd::filter {

/// A camera, a detector and a slam around one filter service.
class FilterServiceTest : public test_support::ServiceFixture<FilterService> {
 protected:
  FilterServiceTest()
      : frames_(bus_->writer(bus::topics::kFrame)),
        boxes_(bus_->writer(bus::topics::kDetections)),
        results_(bus_->writer(bus::topics::kTracking)),
        events_(bus_->writer(bus::topics::kKeyframes)) {
    receive(bus::topics::kFeatures, answers_);
    config_.feedback_timeout_ms = 5000;
    config_.person_masks = "on";
  }
  void TearDown() override {
    detector_beats_.stop();
    ServiceFixture::TearDown();
  }
  void start(service::Pace pace, bool with_detector, const std::vector<msg::Metric>& detector_metrics = {}) {
    if (with_detector)
      detector_beats_.start([=, this] { say("detector", msg::ServiceState::kReady, detector_metrics); });
    ServiceFixture::start(pace);
    if (with_detector) std::this_thread::sleep_for(std::chrono::milliseconds(300));  // it has found the detector
  }

  /// Of another process.
  bus::Writer<msg::RgbdFrame> other_camera() {
    elsewhere_ = bus::connect(bus_options_);
    return elsewhere_->writer(bus::topics::kFrame);
  }
  static std::int64_t stamp(std::uint64_t seq) { return static_cast<std::int64_t>(seq) * 33'333'333 + 1'000'000'000; }
  void send_frame(std::uint64_t seq) { send_frame(seq, frames_); }
  void send_frame(std::uint64_t seq, bus::Writer<msg::RgbdFrame>& camera) {
    const vision::RgbdImage image = scene_.render(seq, 0, 0);
    *frame_ = {};
    frame_->seq = seq;
    frame_->stamp_ns = stamp(seq);
    frame_->source_id = 7;
    frame_->intrinsics = {525, 525, 319.5, 239.5};
    frame_->depth_scale_m = image.depth_scale_m;
    frame_->width = 640;
    frame_->height = 480;
    std::memcpy(frame_->color_bgr.data(), image.color_bgr.data, frame_->color_bgr.size());
    std::memcpy(frame_->depth.data(), image.depth.data, sizeof(frame_->depth));
    camera.write(*frame_);
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
  /// Labels of 4 px: 1 on the block of the scene.
  msg::Image masks_of(std::uint64_t seq) const {
    msg::Image message{.height = 120, .width = 160, .encoding = "mono8", .step = 160};
    message.header.stamp = msg::to_time(stamp(seq));
    cv::Mat labels = cv::Mat::zeros(120, 160, CV_8U);
    const cv::Rect block = test::MovingScene::block(0, 0);
    labels(cv::Rect(block.x / 4, block.y / 4, block.width / 4, block.height / 4)).setTo(1);
    message.data.assign(labels.begin<std::uint8_t>(), labels.end<std::uint8_t>());
    return message;
  }
  void send_result(std::uint64_t seq, std::uint64_t event_count, std::int64_t latency_ns = 0) {
    msg::TrackingResult result{};
    result.published_ns = 1;
    result.finished_ns = 1 + latency_ns;
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
  std::shared_ptr<bus::Bus> elsewhere_;
  test_support::Inbox<msg::FeatureFrame> answers_;
  std::unique_ptr<msg::RgbdFrame> frame_ = std::make_unique<msg::RgbdFrame>();
  bus::Writer<msg::RgbdFrame> frames_;
  bus::Writer<msg::Detection2DArray> boxes_;
  bus::Writer<msg::TrackingResult> results_;
  bus::Writer<msg::KeyframeEvent> events_;
  Beat detector_beats_;
};

}  // namespace rtd::filter
