// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <thread>

#include "common/bus/bus.hpp"
#include "common/concurrency/bounded_queue.hpp"
#include "common/msg/atlas.hpp"
#include "services/slam/config.hpp"
#include "services/slam/core/slam_system.hpp"
#include "services/slam/map_publisher.hpp"

namespace rtd::slam {

/// What a frame sees, people left out, with the depths that it measured; the session is the caller's to fill in.
msg::KeyframeFeatures make_features(const Frame& frame);
/// The same for a keyframe of the map. A feature of a landmark of measured depth that was seen to rest, or for want of
/// witnesses by three keyframes, has its id and its present depth.
msg::KeyframeFeatures make_features(const Map& map, const Keyframe& keyframe, bool witnesses);

/// Sends the features of keyframes that are asked for on `rtd/keyframe_request`, the newest request only, no faster
/// than it is allowed to. A thread of its own, nicer than tracking, copies one keyframe at a time; it sleeps while
/// nothing is asked.
class KeyframeSender {
 public:
  /// `slam` and `publisher`, whose sessions requests name, outlive it.
  KeyframeSender(bus::Bus& bus, const ServiceConfig& config, const SlamSystem& slam, const MapPublisher& publisher);
  ~KeyframeSender();
  KeyframeSender(const KeyframeSender&) = delete;
  KeyframeSender& operator=(const KeyframeSender&) = delete;

  /// Sends at once, in the present session. Any thread.
  void send(msg::KeyframeFeatures features);

 private:
  using Requests = concurrency::BoundedQueue<std::shared_ptr<const msg::KeyframeRequest>>;
  void loop();
  std::optional<msg::KeyframeFeatures> next(std::int64_t session_ns, std::span<const std::uint32_t>& ids) const;

  const AtlasConfig config_;
  const bool witnesses_;
  const SlamSystem& slam_;
  const MapPublisher& publisher_;
  const std::shared_ptr<Requests> requests_;
  bus::Writer<msg::KeyframeFeatures> writer_;
  bus::Reader<msg::KeyframeRequest> reader_;
  std::thread thread_;
};

}  // namespace rtd::slam
