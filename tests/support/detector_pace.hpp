// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <optional>

#include "services/filter/core/dynamic_filter.hpp"
#include "tests/support/simulated_detector.hpp"

namespace rtd::test_support {

/// When a detector publishes, computed from the stamps of the frames instead of a clock: what rtd-detector does at pace
/// realtime. It takes the newest image when it is free, is busy for delay or period, and publishes the batch after the
/// delay. Without rate, delay and outages every frame has its own boxes, as in lockstep. Deterministic.
class DetectorPace {
 public:
  /// Without `pixels`: boxes alone.
  DetectorPace(Look look, const DetectorOptions& options, LookAtPixels pixels = {});

  /// Plays the time up to this frame; what has reached the filter when it judges it.
  filter::DetectorUpdate advance_to(const camera::SourceFrame& frame);

 private:
  struct PendingBatch {
    std::int64_t due_ns;
    filter::DetectionBatch batch;
  };
  filter::DetectionBatch look(const camera::SourceFrame& frame) const;
  void look_until(std::int64_t now_ns);
  bool gone(std::int64_t at_ns) const;
  bool silence_noticed(std::int64_t at_ns) const;

  Look look_;
  LookAtPixels pixels_;
  std::vector<Outage> outages_;
  std::int64_t delay_ns_, busy_ns_;
  std::optional<std::int64_t> first_ns_;
  std::int64_t free_ns_ = 0;  ///< the detector can take an image from here on
  std::optional<camera::SourceFrame> waiting_;
  std::deque<PendingBatch> under_way_;
};

}  // namespace rtd::test_support
