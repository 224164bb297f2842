// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <mutex>
#include <span>
#include <thread>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/msg/map_update.hpp"
#include "common/service/stop_token.hpp"
#include "services/slam/core/map/map_changes.hpp"

namespace rtd::slam {

/// Messages of at most about `max_bytes` that say all of `news`, a part of `view`; session and revision are the
/// caller's to fill in. At least one message when there is news.
std::vector<msg::MapUpdate> make_map_updates(const MapView& view, const MapNews& news, std::size_t max_bytes = 100'000);

/// Publishes on `rtd/map` what changes in a map, while it has a reader: each keyframe's points once, then poses only.
/// A new reader gets the whole map, and so do the others with it. A thread of its own, nicer than tracking, copies the
/// map in portions; a map whose copy takes long is published more rarely.
class MapPublisher {
 public:
  /// `view` copies the map; called from the thread.
  MapPublisher(bus::Bus& bus, std::function<MapView()> view, std::chrono::milliseconds period);
  ~MapPublisher();
  MapPublisher(const MapPublisher&) = delete;
  MapPublisher& operator=(const MapPublisher&) = delete;

  /// What is being published, and of which map.
  struct Session {
    std::int64_t session_ns = 0;  ///< MapUpdate::session_ns; 0: nothing was yet
    std::uint64_t map = 0;        ///< MapView::session
  };
  Session session() const;  ///< any thread

 private:
  void loop();
  void begin_session(std::uint64_t map);
  MapChanges::Extent next_extent();
  void send(std::span<msg::MapUpdate> updates);
  void wait_for_readers();

  const std::function<MapView()> view_;
  const std::chrono::milliseconds period_;
  MapChanges changes_;
  mutable std::mutex mutex_;  ///< guards session_
  Session session_;
  std::uint64_t revision_ = 0;
  bool behind_ = false;                       ///< a reader has not acknowledged in time: it may have lost messages
  int readers_ = 0;                           ///< as of the last match, which comes on a thread of the bus
  std::atomic<std::int64_t> newcomer_ns_{0};  ///< when the newest reader was matched; 0: served
  bus::Writer<msg::MapUpdate> writer_;
  service::StopToken ended_;
  std::thread thread_;
};

}  // namespace rtd::slam
