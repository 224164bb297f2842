// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "common/bus/frame_topics.hpp"
#include "common/concurrency/bounded_queue.hpp"
#include "common/service/peer_table.hpp"
#include "common/service/topic_source.hpp"
#include "services/launcher/core/run/record_builder.hpp"

namespace rtd::launcher {

/// Subscribes to the topics of a run and keeps its record. Thread-safe.
class Collector {
 public:
  struct Options {
    std::uint64_t samples = 12;
    std::uint64_t total = 0;     ///< frames expected, 0 = unknown
    std::uint64_t held = 0;      ///< frames that the source has, 0 = as many as it gives
    bool keep_features = false;  ///< for RunRecord::judged_frames
    bool masks = false;          ///< of people in the samples: the detector computes them for each reader
    bool secured = false;        ///< a heartbeat of camera, filter or slam counts when its sender may write their topic
  };

  /// `store` outlives this and is used by it alone.
  Collector(bus::Bus& bus, FrameStore& store, const Options& options);
  ~Collector();

  /// Connected to slam, and to the filter if there is one: from now on no result is missed.
  bool connected(bool with_filter = true) const;
  /// Subscribes to the frames too: a camera that waits for the launcher sends its first one from now on.
  void read_frames();
  /// What a function of RecordBuilder returns now.
  auto ask(auto function, const auto&... arguments) const {
    const std::lock_guard lock(mutex_);
    return std::invoke(function, builder_, arguments...);
  }
  /// From the newest heartbeat of a service; empty: none, or none with it.
  std::optional<double> metric_of(const std::string& service, const std::string& metric) const;
  LiveStatus live() const;
  std::optional<std::string> take_notice();
  /// The run ends: frames of another source than its own no longer count.
  void close();
  /// Writes what was received (frames, counters, samples, features of the first kMaxJudgedFrames frames) into the
  /// record.
  void fill(run_record::RunRecord& record) const;
  static constexpr std::size_t kMaxJudgedFrames = 5000;  ///< about 15 kB each

 private:
  void add(const msg::TrackingResult& result);
  void add(const msg::FeatureFrame& features);
  void add(const msg::ServiceStatus& status, const bus::WriterId& writer);
  void add(const msg::Image& masks);
  void add_image(const std::shared_ptr<const msg::FrameView>& frame);
  service::ProcessGone process_gone() const;
  void encode_samples();

  bus::Bus& bus_;
  const std::shared_ptr<service::ProcessRegistry> processes_ = std::make_shared<service::ProcessRegistry>();
  const std::shared_ptr<bus::SourceGate> camera_, filter_, slam_;
  mutable std::mutex mutex_;
  service::PeerTable peers_;  ///< whose heartbeats count
  RecordBuilder builder_;
  SampleKeeper samples_;
  std::uint64_t total_, held_;
  bool keep_features_, with_masks_;
  std::map<std::int64_t, std::vector<run_record::JudgedFeature>> judged_;  ///< by stamp
  concurrency::BoundedQueue<std::shared_ptr<const msg::FrameView>> images_{2, concurrency::Overflow::kDropOldest};
  std::thread encoder_;
  bus::Reader<msg::TrackingResult> tracking_reader_;
  bus::Reader<msg::FeatureFrame> features_reader_;
  bus::Reader<msg::ServiceStatus> status_reader_;
  bus::Reader<msg::Image> masks_reader_;
  bus::FrameReader frame_reader_;
};

}  // namespace rtd::launcher
