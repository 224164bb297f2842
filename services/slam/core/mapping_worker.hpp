// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>
#include <variant>
#include <vector>

#include "common/concurrency/bounded_queue.hpp"
#include "services/slam/core/mapper.hpp"

namespace rtd::slam {

enum class MappingMode : std::uint8_t {
  kSynchronous,  ///< in the caller's thread: same input, same map
  kThreaded,     ///< beside tracking
};

/// Runs a Mapper in the caller's thread or in one of its own, and hands out what tracking needs of it.
/// insert(), recentre(), finish(): one thread (tracking). snapshot(), take_changes(), room(), idle(), read(): any.
class MappingWorker {
 public:
  /// `on_thread_start` runs first in the mapper's own thread (priority, name); may be empty.
  MappingWorker(const SlamConfig& config, MappingMode mode, std::function<void()> on_thread_start);
  ~MappingWorker();

  /// Room for another keyframe; idle: nothing queued or in work. Synchronous: both always true.
  bool room() const;
  bool idle() const { return pending_ == 0; }
  /// Hands a keyframe over. The first keyframe of a map is inserted before this returns, in both modes.
  void insert(KeyframeProposal proposal);
  /// Asks for snapshots around this keyframe from now on.
  void recentre(KeyframeId centre);
  /// Newest snapshot; null before the first keyframe.
  LocalMapPtr snapshot() const;
  std::vector<KeyframeChange> take_changes();
  /// Works off what is queued and ends the thread; later calls of insert() do nothing.
  void finish();
  /// Looks at the whole map between two keyframes: may wait for a bundle adjustment.
  void read(const std::function<void(const Map&)>& look) const;

 private:
  using Command = std::variant<KeyframeProposal, KeyframeId>;
  void run(const Command& command);
  void loop();

  const MappingMode mode_;
  mutable std::mutex mapper_mutex_;  ///< held while the mapper works
  Mapper mapper_;
  KeyframeId centre_ = 0;
  mutable std::mutex output_mutex_;  ///< guards the two below, held briefly
  LocalMapPtr snapshot_;
  std::vector<KeyframeChange> changes_;
  std::atomic<int> pending_{0};
  concurrency::BoundedQueue<Command> queue_;
  std::thread thread_;
};

}  // namespace rtd::slam
