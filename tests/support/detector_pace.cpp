// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/detector_pace.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace rtd::test_support {
namespace {

constexpr double kSilenceNoticed_s = 0.45;  ///< as in rtd-filter

std::int64_t to_ns(double seconds) {
  return std::llround(seconds * 1e9);
}

}  // namespace

DetectorPace::DetectorPace(Look look, const DetectorOptions& options, LookAtPixels pixels)
    : look_(std::move(look)),
      pixels_(std::move(pixels)),
      outages_(options.outages),
      delay_ns_(to_ns(options.delay_ms * 1e-3)),
      busy_ns_(std::max(delay_ns_, options.rate_hz > 0 ? to_ns(1.0 / options.rate_hz) : 0)) {}

filter::DetectorUpdate DetectorPace::advance_to(const camera::SourceFrame& frame) {
  const std::int64_t now_ns = frame.image.stamp_ns;
  if (!first_ns_) first_ns_ = now_ns;
  look_until(now_ns - 1);  // at the image that has waited
  waiting_ = frame;
  look_until(now_ns);
  filter::DetectorUpdate update{!silence_noticed(now_ns), {}};
  while (!under_way_.empty() && under_way_.front().due_ns <= now_ns) {
    if (!gone(under_way_.front().due_ns)) update.batches.push_back(std::move(under_way_.front().batch));
    under_way_.pop_front();
  }
  return update;
}

filter::DetectionBatch DetectorPace::look(const camera::SourceFrame& frame) const {
  filter::DetectionBatch batch{frame.image.stamp_ns, look_(frame), {}};
  if (pixels_) batch.masks = pixels_(frame, batch.detections);
  return batch;
}

/// Takes the waiting image as soon as the detector is free; one that meets an outage is lost.
void DetectorPace::look_until(std::int64_t now_ns) {
  if (!waiting_) return;
  const std::int64_t start_ns = std::max(free_ns_, waiting_->image.stamp_ns);
  if (start_ns > now_ns) return;
  if (!gone(start_ns)) {
    under_way_.push_back({start_ns + delay_ns_, look(*waiting_)});
    free_ns_ = start_ns + busy_ns_;
  }
  waiting_.reset();
}

bool DetectorPace::gone(std::int64_t at_ns) const {
  const double at_s = static_cast<double>(at_ns - *first_ns_) * 1e-9;
  return std::any_of(outages_.begin(), outages_.end(),
                     [&](const Outage& outage) { return at_s >= outage.begin_s && at_s < outage.end_s; });
}

bool DetectorPace::silence_noticed(std::int64_t at_ns) const {
  const double at_s = static_cast<double>(at_ns - *first_ns_) * 1e-9;
  return std::any_of(outages_.begin(), outages_.end(), [&](const Outage& outage) {
    return at_s >= outage.begin_s + kSilenceNoticed_s && at_s < outage.end_s;
  });
}

}  // namespace rtd::test_support
