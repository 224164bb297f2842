// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/fleet_pipeline.hpp"

#include <exception>

#include "common/service/monotonic_clock.hpp"
#include "common/vision/image_codecs.hpp"

namespace rtd::detector {
namespace {

constexpr std::chrono::milliseconds kLongestTurn{50};

/// Empty when they are broken, or so many that decoding them would cost the other robots time and memory.
cv::Mat pixels_of(const msg::CompressedImage& jpeg) {
  try {
    return vision::decode_image(jpeg.data, vision::kBusImages).pixels;
  } catch (const std::exception&) {  // data from outside never ends the process
    return {};
  }
}

}  // namespace

void FleetArrivals::put(const std::string& robot, std::shared_ptr<const msg::CompressedImage> jpeg) {
  {
    const std::lock_guard lock(mutex_);
    queue_.put(robot, std::move(jpeg), service::monotonic_ns());
  }
  changed_.notify_one();
}

std::vector<FleetArrivals::Queue::Taken> FleetArrivals::take() {
  std::unique_lock lock(mutex_);
  while (!closed_) {
    Queue::Turn turn = queue_.take(service::monotonic_ns());
    if (!turn.batch.empty()) return std::move(turn.batch);
    if (turn.wait_until_ns) {
      changed_.wait_until(lock, std::chrono::steady_clock::time_point(std::chrono::nanoseconds(*turn.wait_until_ns)));
    } else {
      changed_.wait(lock);
    }
  }
  return {};
}

void FleetArrivals::remove(const std::string& robot) {
  const std::lock_guard lock(mutex_);
  queue_.remove(robot);
}

std::uint64_t FleetArrivals::dropped(const std::string& robot) const {
  const std::lock_guard lock(mutex_);
  return queue_.dropped(robot);
}

void FleetArrivals::close() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  changed_.notify_all();
}

void share_parts(std::size_t parts, int threads, const std::function<void(std::size_t part)>& work) {
  std::atomic<std::size_t> next{0};
  const auto run_parts = [&] {
    for (std::size_t part = next++; part < parts; part = next++) work(part);
  };
  std::vector<std::jthread> helpers;
  for (std::size_t i = 1; i < std::min(parts, static_cast<std::size_t>(threads)); ++i) helpers.emplace_back(run_parts);
  run_parts();
}

FleetPipeline::FleetPipeline(const FleetConfig& config, Inference inference, Outputs outputs)
    : inference_(std::move(inference)),
      outputs_(std::move(outputs)),
      arrivals_(config.queue),
      decoders_(config.decoders),
      device_(inference_.device()) {}

FleetPipeline::End FleetPipeline::run() {
  const std::jthread decoding([this] { prepare_batches(); });
  while (!closed_) {
    outputs_.on_turn();
    if (const std::optional<Batch> batch = handover_.take_for(kLongestTurn)) detect(*batch);
    if (failures_ == kMaxFailures) close();
  }
  return failures_ < kMaxFailures ? End::kClosed : End::kEngineFailed;
}

void FleetPipeline::close() {
  closed_ = true;
  arrivals_.close();
  handover_.close();
}

/// The first stage: takes the newest images and decodes them when the network is about to be free.
void FleetPipeline::prepare_batches() {
  std::size_t before = 0;  // images of the batch that the network has now
  while (const auto began = handover_.wait_free()) {
    handover_.wait_wanted(decode_at(*began, before));
    const auto taken = arrivals_.take();
    if (taken.empty()) return;
    const std::int64_t started_ns = service::monotonic_ns();
    Batch batch = decode(taken);
    {
      const std::lock_guard lock(mutex_);
      timing_.decoded(service::monotonic_ns() - started_ns);
    }
    if (batch.images.empty()) continue;
    before = batch.images.size();
    handover_.put(std::move(batch));
  }
}

FleetPipeline::Clock::time_point FleetPipeline::decode_at(Clock::time_point began, std::size_t images) {
  const std::lock_guard lock(mutex_);
  return began + timing_.delay(images);
}

FleetPipeline::Batch FleetPipeline::decode(const std::vector<FleetArrivals::Queue::Taken>& taken) {
  std::vector<cv::Mat> decoded(taken.size());
  share_parts(taken.size(), decoders_, [&](std::size_t i) { decoded[i] = pixels_of(*taken[i].image); });
  Batch batch;
  for (std::size_t i = 0; i < taken.size(); ++i) {
    if (decoded[i].empty()) {
      outputs_.on_broken(taken[i].robot, "not a JPEG image of at most 3840x2160 px");
      continue;
    }
    batch.images.push_back({taken[i].robot, msg::to_ns(taken[i].image->header.stamp), taken[i].arrived_ns});
    batch.pixels.push_back(std::move(decoded[i]));
  }
  return batch;
}

void FleetPipeline::detect(const Batch& batch) {
  const std::size_t count = batch.images.size();
  Boxes found = infer(batch.pixels);
  ++batches_;
  images_ += count;
  for (std::size_t i = 0; i < count; ++i) {
    const Image& image = batch.images[i];
    if (i < found.size()) {
      outputs_.on_answer(image.robot, {image.stamp_ns, image.arrived_ns, count, std::move(found[i])});
    } else {
      outputs_.on_broken(image.robot, "the network failed");
    }
  }
}

/// Nothing when the engine fails, which may be for once: the next images come.
FleetPipeline::Boxes FleetPipeline::infer(std::span<const cv::Mat> images) {
  const std::int64_t started_ns = service::monotonic_ns();
  Boxes found;
  try {
    found = inference_.detect(images);
    failures_ = 0;
  } catch (const std::exception& error) {
    ++failures_;
    if (failure_log_.pass()) SPDLOG_ERROR("event=inference_failed images={} cause=\"{}\"", images.size(), error.what());
  }
  const std::lock_guard lock(mutex_);
  timing_.inferred(images.size(), service::monotonic_ns() - started_ns);
  device_ = inference_.device();
  return found;
}

std::string FleetPipeline::device() const {
  const std::lock_guard lock(mutex_);
  return device_;
}

}  // namespace rtd::detector
