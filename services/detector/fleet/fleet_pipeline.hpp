// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <opencv2/core.hpp>
#include <span>
#include <string>
#include <vector>

#include "common/service/log.hpp"
#include "services/detector/core/fleet/stage_timing.hpp"
#include "services/detector/fleet/answer.hpp"
#include "services/detector/fleet/fleet_arrivals.hpp"
#include "services/detector/fleet/fleet_config.hpp"
#include "services/detector/fleet/handover.hpp"
#include "services/detector/fleet/worker_pool.hpp"

namespace rtd::detector {

/// Images of several robots in, detections out, in two stages: one takes batches in turns and decodes them while the
/// other one computes the batch before. Knows neither topics nor who the robots are. Thread-safe.
class FleetPipeline {
 public:
  /// `on_answer` and `on_turn` run on the thread of run(), `on_broken` there or on the one that decodes.
  struct Outputs {
    std::function<void(const std::string& robot, const Answer& answer)> on_answer;
    std::function<void(const std::string& robot, const std::string& cause)> on_broken;
    std::function<void()> on_turn;  ///< before each batch, at least every 50 ms while there is none
  };
  enum class End { kClosed, kEngineFailed };

  FleetPipeline(const FleetConfig& config, Inference inference, Outputs outputs);

  void put(const std::string& robot, std::shared_ptr<const msg::CompressedImage> jpeg) { arrivals_.put(robot, jpeg); }
  /// The robot has left.
  void remove(const std::string& robot) { arrivals_.remove(robot); }
  /// Images of the robot that newer ones have replaced.
  std::uint64_t dropped(const std::string& robot) const { return arrivals_.dropped(robot); }

  /// Works until it is closed, or until the engine has failed kMaxFailures times in a row, as that of a GPU that is
  /// gone does. To be called once.
  End run();
  void close();
  /// What computes, for people.
  std::string device() const;
  std::uint64_t images() const { return images_; }    ///< computed; after run()
  std::uint64_t batches() const { return batches_; }  ///< the same

  static constexpr int kMaxFailures = 20;

 private:
  using Clock = std::chrono::steady_clock;
  using Boxes = std::vector<std::vector<vision::Detection>>;
  struct Image {
    std::string robot;
    std::int64_t stamp_ns = 0, arrived_ns = 0;
  };
  /// What goes to the network, image by image.
  struct Batch {
    std::vector<Image> images;
    std::vector<cv::Mat> pixels;
  };

  void prepare_batches();
  Clock::time_point decode_at(Clock::time_point began, std::size_t images);
  Batch decode(const std::vector<FleetArrivals::Queue::Taken>& taken);
  void detect(const Batch& batch);
  Boxes infer(std::span<const cv::Mat> images);

  const Inference inference_;
  const Outputs outputs_;
  FleetArrivals arrivals_;
  Handover<Batch> handover_;
  WorkerPool decoders_;
  mutable std::mutex mutex_;  ///< guards the next two
  StageTiming timing_;
  std::string device_;
  std::atomic<bool> closed_{false};
  int failures_ = 0;  ///< of the engine, in a row
  std::uint64_t batches_ = 0, images_ = 0;
  service::RateLimit failure_log_{std::chrono::seconds(1)};
};

}  // namespace rtd::detector
