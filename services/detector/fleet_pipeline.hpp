// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <opencv2/core.hpp>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "common/msg/ros.hpp"
#include "common/service/log.hpp"
#include "common/vision/detection.hpp"
#include "services/detector/core/fleet/fleet_queue.hpp"
#include "services/detector/fleet_config.hpp"

namespace rtd::detector {

/// The images that the robots have sent, for one thread that takes them in turns. Thread-safe.
class FleetArrivals {
 public:
  using Queue = FleetQueue<std::shared_ptr<const msg::CompressedImage>>;

  explicit FleetArrivals(const FleetQueueConfig& config) : queue_(config) {}

  void put(const std::string& robot, std::shared_ptr<const msg::CompressedImage> jpeg);
  /// The next batch; waits for one. Empty once closed.
  std::vector<Queue::Taken> take();
  void remove(const std::string& robot);
  std::uint64_t dropped(const std::string& robot) const;
  void close();

 private:
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  Queue queue_;
  bool closed_ = false;
};

/// Runs work(0) to work(parts - 1), each once, on up to `threads` threads, this one among them, and returns when all
/// have ended. `work` must not throw. cv::parallel_for_() has one number of threads for the whole process, which
/// belongs to the network.
void share_parts(std::size_t parts, int threads, const std::function<void(std::size_t part)>& work);

/// One place between two threads. The first one can wait until the second one wants something, so that it does not
/// prepare what will be old when it is used. Thread-safe.
template <class T>
class Handover {
 public:
  using Clock = std::chrono::steady_clock;

  /// Waits until the place is free; the time at which it became free. Empty once closed.
  std::optional<Clock::time_point> wait_free() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return closed_ || !item_; });
    return closed_ ? std::nullopt : std::optional(taken_at_);
  }
  /// Waits until the taker waits for the next item, or until the time.
  void wait_wanted(Clock::time_point latest) {
    std::unique_lock lock(mutex_);
    changed_.wait_until(lock, latest, [this] { return closed_ || wanted_; });
  }
  /// The place must be free.
  void put(T item) {
    {
      const std::lock_guard lock(mutex_);
      item_ = std::move(item);
    }
    changed_.notify_all();
  }
  /// Empty when nothing came in time, or once closed.
  std::optional<T> take_for(std::chrono::milliseconds timeout) {
    std::unique_lock lock(mutex_);
    wanted_ = true;
    changed_.notify_all();
    changed_.wait_for(lock, timeout, [this] { return closed_ || item_; });
    wanted_ = false;
    if (item_) taken_at_ = Clock::now();
    std::optional<T> taken = std::exchange(item_, std::nullopt);
    lock.unlock();
    changed_.notify_all();
    return taken;
  }
  void close() {
    {
      const std::lock_guard lock(mutex_);
      closed_ = true;
    }
    changed_.notify_all();
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<T> item_;
  Clock::time_point taken_at_{};
  bool wanted_ = false, closed_ = false;
};

/// An answer and what it was computed from.
struct Answer {
  std::int64_t stamp_ns = 0;    ///< of the image
  std::int64_t arrived_ns = 0;  ///< CLOCK_MONOTONIC
  std::size_t batch = 0;        ///< images computed together
  std::vector<vision::Detection> detections;
};

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
  const int decoders_;        ///< threads
  mutable std::mutex mutex_;  ///< guards the next two
  StageTiming timing_;
  std::string device_;
  std::atomic<bool> closed_{false};
  int failures_ = 0;  ///< of the engine, in a row
  std::uint64_t batches_ = 0, images_ = 0;
  service::RateLimit failure_log_{std::chrono::seconds(1)};
};

}  // namespace rtd::detector
