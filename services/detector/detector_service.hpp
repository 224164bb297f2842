// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/concurrency/bounded_queue.hpp"
#include "common/msg/camera_frame.hpp"
#include "common/msg/ros.hpp"
#include "common/service/config.hpp"
#include "common/service/exit_code.hpp"
#include "common/service/log.hpp"
#include "common/service/run_settings.hpp"
#include "common/service/runtime.hpp"
#include "common/vision/detection.hpp"
#include "services/detector/core/detector.hpp"
#include "services/detector/image_input.hpp"
#include "services/detector/mask_stage.hpp"

namespace CLI {
class App;
}

namespace rtd::detector {

/// Logs what happens to the engine: why the CPU takes its place, that the memory of its device holds fewer images. Each
/// of these once, also when several guards report. Not thread-safe.
class EngineLog {
 public:
  explicit EngineLog(std::string asked) : asked_(std::move(asked)) {}

  void report(const EngineGuard& guard) {
    const std::string& device = guard.detector().device();
    const std::string before = std::exchange(device_, device);
    const bool fell_back = !guard.fallback().empty();
    if (fell_back && guard.fallback() != fallback_) {
      fallback_ = guard.fallback();
      SPDLOG_WARN("event=engine_fallback asked={} device=\"{}\" cause=\"{}\"", asked_, device, fallback_);
    } else if (fallback_.empty() && !before.empty() && device != before) {
      SPDLOG_WARN("event=engine_changed device=\"{}\"", device);
    }
  }

 private:
  const std::string asked_;
  std::string device_, fallback_;
};

/// vision_msgs: box centre and size in px, class_id = class name, header.stamp = stamp of the image.
msg::Detection2DArray to_message(const std::vector<vision::Detection>& detections, std::int64_t stamp_ns,
                                 const std::string& camera_frame = msg::kCameraFrame);

/// Section `detector` of the configuration.
struct ServiceConfig {
  std::string model;
  std::string input = "auto";
  std::vector<std::string> robots;
  int batch = 8;
  int decoders = 0;
  DetectorConfig core;
  service::MaskSettings masks;
  MaskConfig mask_core;
  int workers = 2;
  double max_rate_hz = 0;

  void bind(auto& binder) {
    service::bind_model(binder, model);
    binder
        .choice("input", input, {"auto", "frame", "jpeg"},
                "raw frames of this host, JPEG images of the network, or auto: where the camera is")
        .option("--input");
    binder
        .field("robots", robots,
               "serve several robots by their JPEG images: all, or names such as anna,ben; empty: one robot")
        .option("--robots");
    binder.field("batch", batch, {1, 64}, "several robots: images computed at once, at most").option("--batch");
    binder.field("decoders", decoders, {0, 64}, "several robots: threads that decode JPEGs, 0 = up to four cores")
        .option("--decoders");
    core.bind(binder);
    service::bind_engine(binder, core.engine);
    masks.bind(binder);
    mask_core.bind(binder);
    binder.field("workers", workers, {1, 16}, "pace asap: images worked on side by side, each with its own network");
    binder.field("max_rate_hz", max_rate_hz, {0.0, 1000.0}, "realtime pace: detect at most this often, 0 = no limit")
        .option("--max-rate");
  }
};

/// `load()`, with what is wrong about a network as an error of the configuration.
auto load_network(const auto& load) {
  try {
    return load();
  } catch (const ModelError& error) {
    throw service::ConfigError(error.what());
  } catch (const EngineError& error) {
    throw service::ConfigError(std::string("detector.engine: ") + error.what());
  }
}

/// The part of the configuration for the network, with the file found. Throws ConfigError without weights.
DetectorConfig core_config(const ServiceConfig& config);
/// The part for person masks; without a path there are none. Throws ConfigError when they are asked for and their
/// network is not found.
MaskConfig mask_config(const ServiceConfig& config);

/// Images in, boxes out, and before the boxes of an image which pixels are people, while a program reads them. Realtime
/// pace: the newest image wins, what came meanwhile is dropped and counted. Asap and lockstep: every image gets its
/// detections, in order, an empty array where nothing was found.
class DetectorService {
 public:
  static constexpr const char* kName = "detector";
  static constexpr const char* kDescription = "Finds people and things in camera images (YOLOX, NanoDet, YOLOv5)";
  static constexpr std::uint32_t kShmSegmentMib = bus::kSmallSegmentMib;
  using Config = ServiceConfig;
  static void add_options(CLI::App& app, std::vector<service::GivenOption>& given);

  /// Loads the network. Throws ConfigError when there is none or it is broken.
  DetectorService(const Config& config, service::Runtime& runtime);
  ~DetectorService();
  DetectorService(const DetectorService&) = delete;
  DetectorService& operator=(const DetectorService&) = delete;
  service::ExitCode run();

 private:
  /// An image that a worker has taken, and its place in the order of publishing.
  struct Taken {
    Arrival arrival;
    std::uint64_t turn = 0;
  };
  using Arrivals = concurrency::BoundedQueue<Arrival>;

  /// What is published about an image.
  struct Found {
    msg::Detection2DArray detections;
    std::optional<msg::Image> masks;
  };

  static std::optional<cv::Mat> image_of(const Arrival& arrival);
  void load_masks();
  void work(std::size_t worker);
  std::optional<Taken> take();
  std::optional<Found> detect(std::size_t worker, const Arrival& arrival);
  std::optional<msg::Image> find_masks(std::size_t worker, const BoxedImage& boxed, const msg::Header& header);
  void publish_in_turn(std::uint64_t turn, const std::optional<Found>& found);
  void report_engine(const EngineGuard& detector);
  void skip(const Arrival& arrival, const std::string& cause);
  void count(double detect_ms);
  bool peers_matched() const;
  void report_state();
  void keep_rate(std::int64_t started_ns) const;

  const Config config_;
  service::Runtime& runtime_;
  std::vector<std::unique_ptr<EngineGuard>> detectors_;  ///< one for each worker
  EngineLog engine_log_;
  std::shared_ptr<Arrivals> arrivals_;
  std::unique_ptr<MaskStage> masks_;     ///< null: boxes alone
  bus::Writer<msg::Image> mask_writer_;  ///< before the other writer: who reads both is matched here first
  bus::Writer<msg::Detection2DArray> detections_;
  std::unique_ptr<ImageInput> input_;
  std::mutex take_mutex_;
  std::uint64_t taken_ = 0;
  std::mutex turn_mutex_;
  std::condition_variable turn_changed_;
  std::uint64_t published_ = 0;  ///< turns that are over
  std::mutex counters_mutex_;
  std::atomic<std::uint64_t> detected_{0};
  std::uint64_t broken_ = 0;
  std::string engine_;  ///< what computes the boxes, for people
  double total_detect_ms_ = 0, max_detect_ms_ = 0;
  service::RateLimit broken_log_{std::chrono::seconds(1)};
};

}  // namespace rtd::detector
