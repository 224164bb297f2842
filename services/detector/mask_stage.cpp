// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/mask_stage.hpp"

#include <algorithm>
#include <bitset>
#include <utility>

#include "common/msg/stamps.hpp"
#include "common/service/monotonic_clock.hpp"

namespace rtd::detector {
namespace {

/// A mean that a new value changes by a fifth.
void smooth(double& mean, double value) {
  mean = mean == 0 ? value : mean + 0.2 * (value - mean);
}

std::unique_ptr<PersonSegmenter> load(MaskConfig config) {
  try {
    return std::make_unique<PersonSegmenter>(config);
  } catch (const EngineError& error) {
    SPDLOG_WARN("event=engine_fallback asked={} network=masks cause=\"{}\"", config.engine, error.what());
    config.engine = "cpu";
    return std::make_unique<PersonSegmenter>(std::move(config));
  }
}

int people_among(const std::vector<vision::Detection>& detections) {
  return static_cast<int>(std::ranges::count(detections, "person", &vision::Detection::class_name));
}

std::size_t count_labels(const vision::PersonMasks& masks) {
  std::bitset<256> seen;
  for (const std::uint8_t label : masks.labels) seen.set(label);
  return seen.reset(0).count();
}

}  // namespace

msg::Image to_message(const vision::PersonMasks& masks, cv::Size image_px, const msg::Header& header) {
  const auto cells_along = [](int px) {
    return static_cast<std::uint32_t>((px + vision::kMaskStepPx - 1) / vision::kMaskStepPx);
  };
  msg::Image message;
  message.header = header;
  message.width = cells_along(image_px.width);
  message.height = cells_along(image_px.height);
  message.encoding = "mono8";
  message.step = message.width;
  const std::size_t cells = std::size_t{message.width} * message.height;
  message.data = masks.labels.size() == cells ? masks.labels : std::vector<std::uint8_t>(cells, 0);
  return message;
}

void MaskBudget::saw_image(std::int64_t stamp_ns) {
  constexpr double kLongest_ms = 1000;  // a pause says nothing about the camera's rate
  const double gap_ms = static_cast<double>(msg::minus_ns(stamp_ns, std::exchange(last_stamp_ns_, stamp_ns))) * 1e-6;
  if (gap_ms > 0 && gap_ms < kLongest_ms) smooth(gap_ms_, gap_ms);
}

void MaskBudget::took(double boxes_ms, double masks_ms, int fresh) {
  smooth(boxes_ms_, boxes_ms);
  if (fresh > 0) smooth(mask_ms_, masks_ms / fresh);
}

int MaskBudget::fresh_at_most(int all) const {
  if (gap_ms_ == 0 || mask_ms_ == 0) return all;
  return static_cast<int>(std::clamp((gap_ms_ - boxes_ms_) / mask_ms_, 1.0, static_cast<double>(all)));
}

MaskStage::MaskStage(MaskConfig config, std::size_t workers, bool in_time) : in_time_(in_time) {
  for (std::size_t i = 0; i < workers; ++i) segmenters_.push_back(load(config));
}

void MaskStage::saw_image(std::int64_t stamp_ns) {
  const std::lock_guard lock(mutex_);
  budget_.saw_image(stamp_ns);
}

vision::PersonMasks MaskStage::segment(std::size_t worker, const BoxedImage& boxed) {
  const int most = fresh_at_most();
  const std::int64_t started_ns = service::monotonic_ns();
  vision::PersonMasks masks;
  try {
    masks = segmenters_[worker]->segment(boxed.color_bgr, boxed.detections, most);
  } catch (const std::exception& error) {
    const std::lock_guard lock(mutex_);
    if (failure_log_.pass()) SPDLOG_WARN("event=masks_failed cause=\"{}\" effect=\"boxes alone\"", error.what());
  }
  const double masks_ms = static_cast<double>(service::monotonic_ns() - started_ns) * 1e-6;
  count(masks, std::min(most, people_among(boxed.detections)), boxed.boxes_ms, masks_ms);
  return masks;
}

int MaskStage::fresh_at_most() const {
  const std::lock_guard lock(mutex_);
  const int all = segmenter().config().masks_per_frame;
  return in_time_ ? budget_.fresh_at_most(all) : all;
}

void MaskStage::count(const vision::PersonMasks& masks, int fresh, double boxes_ms, double masks_ms) {
  const std::size_t people = count_labels(masks);
  const std::lock_guard lock(mutex_);
  budget_.took(boxes_ms, masks_ms, fresh);
  ++counters_.frames;
  counters_.masks += people;
  counters_.total_ms += masks_ms;
}

MaskStage::Counters MaskStage::counters() const {
  const std::lock_guard lock(mutex_);
  return counters_;
}

}  // namespace rtd::detector
