// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/rtd_bench/detector/fleet_bench.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <thread>
#include <utility>

#include "services/detector/fleet_config.hpp"
#include "services/detector/fleet_pipeline.hpp"
#include "tests/bench/rtd_bench/bench_clock.hpp"
#include "tests/bench/rtd_bench/detector/detector_bench.hpp"
#include "tests/bench/rtd_bench/percentile.hpp"

namespace rtd::bench {
namespace {

using Clock = std::chrono::steady_clock;
using Jpegs = std::vector<std::shared_ptr<const msg::CompressedImage>>;

constexpr int kJpegQuality = 90;  // the camera's
constexpr double kNsPerMs = 1e6;
constexpr double kLongestWarmUpS = 1;

Clock::duration duration_of(double seconds) {
  return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
}

Jpegs encode(std::span<const cv::Mat> images) {
  Jpegs jpegs;
  for (const cv::Mat& image : images) {
    msg::CompressedImage jpeg;
    cv::imencode(".jpg", image, jpeg.data, {cv::IMWRITE_JPEG_QUALITY, kJpegQuality});
    jpegs.push_back(std::make_shared<const msg::CompressedImage>(std::move(jpeg)));
  }
  return jpegs;
}

/// What the robots got since the measurement began. Used by the thread that computes.
class Answers {
 public:
  Answers(int robots, Clock::time_point begin, Clock::time_point end) : begin_(begin), end_(end) {
    for (int robot = 0; robot < robots; ++robot) counts_[std::to_string(robot)] = 0;
  }
  void add(const std::string& robot, const detector::Answer& answer) {
    const Clock::time_point now = Clock::now();
    if (now < begin_ || now >= end_) return;
    ++counts_[robot];
    latencies_ms_.push_back(static_cast<double>(monotonic_ns() - answer.arrived_ns) / kNsPerMs);
    images_ += static_cast<double>(answer.batch);
  }
  void summarise(double seconds, FleetResult& result) const {
    const auto least = std::ranges::min_element(counts_, {}, &std::pair<const std::string, int>::second);
    const auto all = static_cast<double>(latencies_ms_.size());
    result.least_hz = least->second / seconds;
    result.mean_hz = all / static_cast<double>(counts_.size()) / seconds;
    result.latency_p50_ms = percentile(latencies_ms_, 50);
    result.latency_p99_ms = percentile(latencies_ms_, 99);
    result.batch_mean = all > 0 ? images_ / all : 0;
  }

 private:
  const Clock::time_point begin_, end_;
  std::map<std::string, int> counts_;
  std::vector<double> latencies_ms_;
  double images_ = 0;
};

/// Until the time is over; then the pipeline is closed.
void send(detector::FleetPipeline& pipeline, const Jpegs& jpegs, const FleetLoad& load, int robots,
          Clock::time_point end) {
  const double period_s = 1 / (load.rate_hz * robots);
  const Clock::time_point start = Clock::now();
  for (std::size_t i = 0; Clock::now() < end; ++i) {
    pipeline.put(std::to_string(i % static_cast<std::size_t>(robots)), jpegs[i % jpegs.size()]);
    std::this_thread::sleep_until(start + duration_of(period_s * static_cast<double>(i + 1)));
  }
  pipeline.close();
}

void serve(const std::shared_ptr<detector::EngineGuard>& detector, const Jpegs& jpegs, const FleetLoad& load,
           FleetResult& result) {
  const Clock::time_point begin = Clock::now() + duration_of(std::min(kLongestWarmUpS, load.seconds));
  const Clock::time_point end = begin + duration_of(load.seconds);
  Answers answers(result.robots, begin, end);
  detector::FleetConfig config;
  config.queue.batch = static_cast<std::size_t>(result.batch);
  config.decoders = detector::usual_decoders();
  detector::FleetPipeline pipeline(
      config,
      {[detector](std::span<const cv::Mat> images) { return detector->detect_batch(images); },
       [detector] { return detector->device(); }},
      {[&answers](const std::string& robot, const detector::Answer& answer) { answers.add(robot, answer); },
       [](const std::string&, const std::string&) {}, [] {}});
  CpuMeter cpu;
  cpu.start();
  const std::jthread sender([&] { send(pipeline, jpegs, load, result.robots, end); });
  if (pipeline.run() == detector::FleetPipeline::End::kEngineFailed)
    result.failure = "the engine failed again and again";
  result.cpu_percent = cpu.percent();
  result.device = pipeline.device();
  answers.summarise(load.seconds, result);
}

}  // namespace

std::size_t cases_of(const DetectorOptions& options, const FleetLoad& load) {
  return options.engines.size() * options.batches.size() * load.robots.size();
}

std::vector<FleetResult> bench_fleet(std::span<const cv::Mat> images, const DetectorOptions& options,
                                     const FleetLoad& load, const std::function<void()>& on_case) {
  std::vector<FleetResult> results;
  if (load.robots.empty()) return results;
  const Jpegs jpegs = encode(images);
  for (const std::string& engine : options.engines) {
    for (const int batch : options.batches) {
      std::shared_ptr<detector::EngineGuard> detector;
      std::string failure;
      try {
        detector = std::make_shared<detector::EngineGuard>(config_of(options, engine), batch);
        const std::string& fallback = detector->fallback();
        failure = fallback.empty() ? detector->no_batch() : fallback;
      } catch (const std::exception& error) {
        failure = error.what();
      }
      for (const int robots : load.robots) {
        results.push_back({.engine = engine, .batch = batch, .robots = robots, .failure = failure});
        if (failure.empty()) serve(detector, jpegs, load, results.back());
        on_case();
      }
    }
  }
  return results;
}

std::string fleet_table(const std::vector<FleetResult>& results, const FleetLoad& load) {
  if (results.empty()) return "";
  std::string text = fmt::format(
      "\nrobots that send {:g} JPEG images a second each, from arrival to boxes, {:g} s\n\n{:<16} {:>5} {:>6} {:>9} "
      "{:>9} {:>9} {:>9} {:>9} {:>10} {:>6}  {}\n",
      load.rate_hz, load.seconds, "engine", "batch", "robots", "Hz each", "Hz least", "images/s", "p50 ms", "p99 ms",
      "batch mean", "CPU %", "device");
  for (const FleetResult& result : results) {
    text += fmt::format("{:<16} {:>5} {:>6}", detector::engine_label(result.engine), result.batch, result.robots);
    text += result.failure.empty()
                ? fmt::format(" {:>9.1f} {:>9.1f} {:>9.1f} {:>9.1f} {:>9.1f} {:>10.1f} {:>6.0f}  {}\n", result.mean_hz,
                              result.least_hz, result.images_per_s(), result.latency_p50_ms, result.latency_p99_ms,
                              result.batch_mean, result.cpu_percent, result.device)
                : "  " + result.failure + "\n";
  }
  return text;
}

}  // namespace rtd::bench
