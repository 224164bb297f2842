// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/imgcodecs.hpp>

#include "common/msg/transform_eigen.hpp"
#include "services/evaluation/core/report/run_summary.hpp"
#include "tests/unit/evaluation/eval_paths.hpp"

namespace rtd::eval::testing_support {

/// A run of 100 frames at 10 Hz along winding_path: frames 40..44 lost, frame 60 missing, 30 of 130 features removed.
inline Run fabricated_run() {
  Run record;
  record.version = "1.2.3";
  record.source = "synthetic:office";
  record.pace = "lockstep";
  record.filter_mode = "rtd";
  record.dds = "fastdds";
  record.detector = "v5lite-s";
  record.frames_in = 100;
  record.frames_dropped = 1;
  record.duration_s = 12.5;
  record.drops = {{"camera.late", 1}};
  record.processes = {{"slam", {3.5, 120, 0}}, {"filter", {4.5, 80, 1}}};
  record.events = {"filter restarted"};
  std::uint64_t seq = 0;
  for (const StampedPose& pose : winding_path(100, 0.1)) {
    run_record::FrameRecord frame;
    frame.tracking.seq = seq;
    frame.tracking.stamp_ns = pose.stamp_ns;
    frame.tracking.published_ns = 5'000'000'000;
    frame.tracking.finished_ns = frame.tracking.published_ns + static_cast<std::int64_t>(seq + 1) * 1'000'000;
    frame.tracking.T_world_camera = msg::to_message(pose.T_world_body);
    frame.tracking.state = seq >= 40 && seq < 45 ? msg::TrackingState::kLost : msg::TrackingState::kOk;
    frame.tracking.features_static = 100;
    frame.tracking.features_removed = 30;
    frame.tracking.inliers = 60;
    frame.tracking.keyframes = 7;
    frame.tracking.landmarks = 900;
    frame.tracking.stage_ms[msg::kStagePose] = 2.0F;
    if (seq % 10 == 0) frame.tracking.stage_ms[msg::kStageMapping] = 20.0F;
    frame.filter_stage_ms[msg::kStageExtract] = 11.0F;
    if (seq != 60) record.frames.push_back(frame);
    ++seq;
  }
  return record;
}

/// A grey picture with one kept and one removed feature.
inline run_record::SampleFrame fabricated_sample(std::uint64_t seq) {
  run_record::SampleFrame sample;
  sample.seq = seq;
  cv::imencode(".jpg", cv::Mat(48, 64, CV_8UC3, cv::Scalar(90, 90, 90)), sample.jpeg);
  sample.features = {{10, 12, false}, {30, 32, true}};
  return sample;
}

}  // namespace rtd::eval::testing_support
