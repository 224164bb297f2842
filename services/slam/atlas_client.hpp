// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <future>
#include <memory>
#include <string>

#include "common/bus/bus.hpp"
#include "common/concurrency/bounded_queue.hpp"
#include "common/msg/atlas.hpp"
#include "services/slam/keyframe_sender.hpp"
#include "services/slam/place_policy.hpp"

namespace rtd::slam {

/// Asks an atlas where the robot is while a PlacePolicy wants to know, and takes the part of the joint map that comes
/// back. It is read in a thread of its own, nicer than tracking, and taken over between two frames. Where the camera is
/// not found in it, a new map begins. Without an atlas nothing happens. One thread.
class AtlasClient {
 public:
  /// Both change the map between two frames and say so with begin_map(); `take_map` returns why it does not, else "".
  using TakeMap = std::function<std::string(MapContents contents)>;
  using Forget = std::function<void()>;

  /// `slam` and `sender` outlive it.
  AtlasClient(bus::Bus& bus, const SensorConfig& sensor, const SlamSystem& slam, KeyframeSender& sender,
              TakeMap take_map, Forget forget);

  void begin_map(bool loaded) { policy_.begin_map(loaded); }
  /// After each frame.
  void update(const msg::FeatureFrame& frame, const msg::TrackingResult& result);

 private:
  using Submaps = concurrency::BoundedQueue<std::shared_ptr<const msg::Submap>>;
  void give_up();
  void receive();
  void take();
  void refuse(const char* cause);
  void query(const msg::FeatureFrame& frame);

  SensorConfig sensor_;
  const SlamSystem& slam_;
  KeyframeSender& sender_;
  const TakeMap take_map_;
  const Forget forget_;
  PlacePolicy policy_;
  const std::shared_ptr<Submaps> arrivals_;
  bus::Reader<msg::Submap> reader_;
  std::future<MapContents> reading_;
};

}  // namespace rtd::slam
