// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include "common/bus/bus.hpp"
#include "services/filter/core/dynamic_filter.hpp"

namespace rtd::filter {

/// Publishes on `rtd/movers` where the objects of each frame are, once slam has said where the camera was: one frame
/// later. Frames that slam did not track in frame `map` have no movers. Does nothing while nobody reads. One thread.
class MoversPublisher {
 public:
  explicit MoversPublisher(bus::Bus& bus) : writer_(bus.writer(bus::topics::kMovers)) {}

  bool wanted() const { return writer_.matched() > 0; }
  /// What a frame shows; kept until slam has answered.
  void add(std::uint64_t seq, std::int64_t stamp_ns, std::vector<ObjectSighting> sightings);
  void on_result(const msg::TrackingResult& result);
  /// Time went back, or another camera.
  void clear();

 private:
  struct Waiting {
    std::uint64_t seq = 0;
    std::int64_t stamp_ns = 0;
    std::vector<ObjectSighting> sightings;
  };
  static constexpr std::size_t kMaxWaiting = 32;

  bus::Writer<msg::Movers> writer_;
  std::deque<Waiting> waiting_;  ///< by seq
  WorldMovers movers_;
};

}  // namespace rtd::filter
