// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "common/bus/bus.hpp"
#include "common/concurrency/bounded_queue.hpp"
#include "services/launcher/core/run/record_builder.hpp"
#include "services/launcher/core/run/sample_keeper.hpp"

namespace rtd::launcher {

/// Listens to a run and keeps its record. Thread-safe.
class Collector {
 public:
  struct Options {
    std::uint64_t samples = 12;
    std::uint64_t total = 0;  ///< frames expected, 0 = unknown
  };

  Collector(bus::Bus& bus, const Options& options);
  ~Collector();

  /// filter and slam are heard: from now on no frame is missed.
  bool connected() const;
  std::string services_heard() const;
  LiveStatus live() const;
  std::optional<std::string> take_notice();
  bool tracked_any() const;
  /// Writes what was heard (frames, counters, samples) into the record.
  void fill(RunRecord& record) const;

 private:
  void encode_samples();

  mutable std::mutex mutex_;
  RecordBuilder builder_;
  SampleKeeper samples_;
  std::uint64_t total_;
  concurrency::BoundedQueue<std::shared_ptr<const msg::RgbdFrame>> pictures_{2, concurrency::Overflow::kDropOldest};
  std::thread encoder_;
  bus::Reader<msg::TrackingResult> tracking_;
  bus::Reader<msg::FeatureFrame> features_;
  bus::Reader<msg::ServiceStatus> status_;
  bus::Reader<msg::RgbdFrame> frames_;
};

}  // namespace rtd::launcher
