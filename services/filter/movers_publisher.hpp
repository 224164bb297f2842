// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/geometry/mover_trails.hpp"
#include "services/filter/core/dynamic_filter.hpp"

namespace rtd::filter {

/// The objects of one frame as vision_msgs has them: a box each, aligned with the axes of `map_frame`, with the
/// covariance of its middle. The score fades while an object is hidden.
msg::Detection3DArray make_boxes(const std::vector<WorldMover>& movers, std::int64_t stamp_ns,
                                 const std::string& map_frame);
/// The same for people who watch: box and name of each, and of those that do not rest their speed and an arrow to where
/// they are a second later. They vanish by themselves.
msg::MarkerArray make_markers(const std::vector<WorldMover>& movers, const std::vector<bool>& rest,
                              const msg::Header& header);

/// Publishes where the objects of each frame are, once slam has said where the camera was: one frame later.
/// `rtd/movers` says most; `rt/filter/movers` and `rt/filter/movers_markers` are for programs of ROS 2. Frames that
/// slam did not track have no movers; `rtd/movers` has those of the first map only. Each topic costs nothing while it
/// has no reader. One thread.
class MoversPublisher {
 public:
  /// `map_frame`: name on the wire.
  MoversPublisher(bus::Bus& bus, std::string map_frame);

  bool wanted() const { return writer_.matched() > 0 || boxes_.matched() > 0 || markers_.matched() > 0; }
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
  bus::Writer<msg::Detection3DArray> boxes_;
  bus::Writer<msg::MarkerArray> markers_;
  std::string map_frame_;
  std::deque<Waiting> waiting_;  ///< by seq
  WorldMovers movers_;
  geometry::MoverTrails trails_;  ///< of the markers
  std::uint32_t map_ = 0;         ///< that the last tracked frame was in
};

}  // namespace rtd::filter
