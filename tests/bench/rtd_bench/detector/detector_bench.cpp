// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/rtd_bench/detector/detector_bench.hpp"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <numeric>
#include <stdexcept>

#include "services/detector/core/detector.hpp"
#include "tests/bench/rtd_bench/bench_clock.hpp"
#include "tests/bench/rtd_bench/percentile.hpp"

namespace rtd::bench {
namespace {

using Boxes = std::vector<vision::Detection>;

constexpr std::size_t kFewestBatches = 5;
constexpr double kMsPerNs = 1e-6, kSecondsPerNs = 1e-9;

/// Counted batches of a case: all images once, or a few batches where that would be fewer.
std::size_t rounds_of(std::size_t images, int batch) {
  const auto size = static_cast<std::size_t>(batch);
  return std::max(kFewestBatches, (images + size - 1) / size);
}

/// What the others are compared with.
struct Reference {
  std::span<const cv::Mat> images;
  std::vector<Boxes> boxes;
  double confidence_threshold = 0;
};

/// One engine with batches of one size.
class Contender {
 public:
  Contender(const DetectorOptions& options, DetectorCase what) {
    result_.what = std::move(what);
    const std::int64_t begin_ns = monotonic_ns();
    guard([&] {
      detector_ = std::make_unique<detector::Detector>(config_of(options, result_.what.engine));
      result_.device = detector_->device();
    });
    result_.load_s = static_cast<double>(monotonic_ns() - begin_ns) * kSecondsPerNs;
  }

  /// The batch of round 0 is not counted.
  void take(std::size_t round, const Reference& reference) {
    if (!detector_) return;
    const auto size = static_cast<std::size_t>(result_.what.batch);
    std::vector<cv::Mat> batch;
    for (std::size_t i = 0; i < size; ++i)
      batch.push_back(reference.images[(round * size + i) % reference.images.size()]);
    guard([&] {
      const std::int64_t wall_ns = monotonic_ns(), cpu_ns = read_clock_ns(CLOCK_PROCESS_CPUTIME_ID);
      const std::vector<Boxes> found = detector_->detect_batch(batch);
      const std::int64_t used_ns = read_clock_ns(CLOCK_PROCESS_CPUTIME_ID) - cpu_ns;
      if (round > 0) count(monotonic_ns() - wall_ns, used_ns);
      for (std::size_t i = 0; i < size; ++i) compare(round * size + i, found[i], reference);
    });
  }

  DetectorResult finish() {
    const double images = static_cast<double>(result_.batch_ms.size()) * result_.what.batch;
    result_.cpu_ms_per_image = images > 0 ? cpu_ms_ / images : 0;
    if (detector_) result_.device = detector_->device();  // some say there how they have run
    return std::move(result_);
  }

 private:
  void guard(const auto& work) {
    try {
      work();
    } catch (const std::exception& error) {
      detector_.reset();
      result_.failure = error.what();
    }
  }
  void count(std::int64_t wall_ns, std::int64_t used_ns) {
    result_.batch_ms.push_back(static_cast<double>(wall_ns) * kMsPerNs);
    cpu_ms_ += static_cast<double>(used_ns) * kMsPerNs;
  }
  /// Each image once.
  void compare(std::size_t index, const Boxes& found, const Reference& reference) {
    if (index >= reference.images.size()) return;
    result_.same.add(detector::disagreement(reference.boxes[index], found, reference.confidence_threshold));
    result_.boxes += found.size();
  }

  DetectorResult result_;
  std::unique_ptr<detector::Detector> detector_;  ///< null after a failure
  double cpu_ms_ = 0;
};

/// All engines on batches of one size, in turn.
void contest(const Reference& reference, const DetectorOptions& options, int batch,
             const std::function<void()>& on_batch, std::vector<DetectorResult>& results) {
  std::vector<Contender> contenders;
  for (const std::string& engine : options.engines) contenders.emplace_back(options, DetectorCase{engine, batch});
  for (std::size_t round = 0; round <= rounds_of(reference.images.size(), batch); ++round) {
    for (std::size_t i = 0; i < contenders.size(); ++i) {
      contenders[(round + i) % contenders.size()].take(round, reference);
      on_batch();
    }
  }
  for (Contender& contender : contenders) results.push_back(contender.finish());
}

}  // namespace

detector::DetectorConfig config_of(const DetectorOptions& options, const std::string& engine) {
  detector::DetectorConfig config;
  config.model_path = options.model_path;
  config.engine = engine;
  config.threads = options.threads;
  config.onnxruntime = options.onnxruntime;
  return config;
}

double DetectorResult::ms_per_image() const {
  return percentile(batch_ms, 50) / what.batch;
}

double DetectorResult::images_per_s() const {
  const double all_ms = std::accumulate(batch_ms.begin(), batch_ms.end(), 0.0);
  return all_ms > 0 ? 1000 * static_cast<double>(batch_ms.size()) * what.batch / all_ms : 0;
}

std::size_t batches_of(std::size_t images, const DetectorOptions& options) {
  std::size_t batches = 0;
  for (const int batch : options.batches) batches += options.engines.size() * (1 + rounds_of(images, batch));
  return batches;
}

DetectorComparison bench_detector(std::span<const cv::Mat> images, const DetectorOptions& options,
                                  const std::function<void()>& on_batch) {
  if (images.empty()) throw std::invalid_argument("there are no images to detect on");
  for (const std::string& engine : options.engines) static_cast<void>(detector::parse_engine(engine));
  detector::Detector cpu(config_of(options, "cpu"));
  Reference reference{images, {}, cpu.config().decode.confidence_threshold};
  for (const cv::Mat& image : images) reference.boxes.push_back(cpu.detect(image));
  DetectorComparison comparison{std::filesystem::path(options.model_path).filename().string(),
                                cpu.input_size(),
                                images.size(),
                                options.threads,
                                {},
                                {},
                                {}};
  for (const int batch : options.batches) contest(reference, options, batch, on_batch, comparison.cases);
  return comparison;
}

}  // namespace rtd::bench
