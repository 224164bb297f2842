// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <variant>
#include <vector>

#include "common/concurrency/bounded_queue.hpp"
#include "services/slam/core/mapping/mapper.hpp"

namespace rtd::slam {

enum class MappingMode : std::uint8_t {
  kSynchronous,  ///< in the caller's thread: same input, same map
  kThreaded,     ///< next to tracking
};

/// What happens to a global bundle adjustment that is under way when mapping ends: it may need seconds.
enum class PendingAdjustment : std::uint8_t { kAwait, kCancel };

/// Runs a Mapper in the caller's thread or in one of its own, and provides what tracking needs from it.
/// restart(), restore(), insert(), begin_map(), recentre(), places_like(), finish(): one thread (tracking). snapshot(),
/// take_changes(), room(), idle(), read(), session(): any.
class MappingWorker {
 public:
  /// `on_thread_start` runs first in the mapper's own thread (priority, name); may be empty.
  MappingWorker(const SlamConfig& config, MappingMode mode, std::function<void()> on_thread_start);
  ~MappingWorker();

  /// Forgets the map and all that is queued; waits for the keyframe in work and gives up a global adjustment. The
  /// keyframes that were announced are taken back (take_changes()). Ids begin at 0 again.
  void restart();
  /// Continues a saved map; before the first keyframe of a session.
  void restore(MapContents contents);
  /// Counts the calls of restart().
  std::uint64_t session() const { return session_; }
  /// Room for another keyframe; idle: nothing queued or in work. Synchronous: both always true.
  bool room() const;
  bool idle() const { return pending_ == 0; }
  /// Passes a keyframe on.
  void insert(KeyframeProposal proposal);
  /// Inserts the first keyframe of a map before it returns, in both modes; snapshots are taken around it from now on.
  LocalMapPtr begin_map(KeyframeProposal first);
  /// Asks for snapshots around this keyframe from now on.
  void recentre(KeyframeId centre);
  /// Parts of the map around places that look like this frame; every `attempt` of a search, counted from 0, tries
  /// others. Synchronous: at once. Threaded: never waits; the result belongs to an earlier frame and is empty when it
  /// has been taken or is not ready yet.
  std::vector<LocalMapPtr> places_like(const FramePtr& frame, std::size_t attempt);
  /// Newest snapshot; null before the first keyframe.
  LocalMapPtr snapshot() const;
  std::vector<KeyframeChange> take_changes();
  /// Loops closed so far, from the `first` on.
  std::vector<LoopClosure> loops(std::size_t first = 0) const;
  /// Forgets keyframes that were removed long ago, after `before` has had a last look at the map. Waits for the mapper.
  void forget_removed(const std::function<void(const Map&)>& before);
  /// Works off what is queued and ends the thread; later calls of insert() do nothing.
  void finish(PendingAdjustment pending);
  /// What `look` finds in the whole map between two keyframes: may wait for a bundle adjustment.
  auto read(const auto& look) const {
    const std::lock_guard lock(mapper_mutex_);
    return look(mapper_->map());
  }

 private:
  struct Recentre {};         ///< on wanted_centre_
  struct ApplyAdjustment {};  ///< of global bundle adjustment
  struct PlaceQuestion {
    FramePtr frame;
    std::size_t attempt;
  };
  using Command = std::variant<KeyframeProposal, Recentre, PlaceQuestion, ApplyAdjustment>;
  struct Queued {
    Command command;
    std::uint64_t session = 0;  ///< whose map it is about
  };
  std::unique_ptr<Mapper> make_mapper();
  bool enqueue(Command command) { return queue_.push({std::move(command), session_}); }
  LocalMapPtr run(const Command& command);
  LocalMapPtr run_locked(const Command& command);
  void run_queued(const Queued& queued);
  void work(const KeyframeProposal& proposal);
  void work(Recentre command);
  void work(ApplyAdjustment command);
  LocalMapPtr publish();
  void find_places(const PlaceQuestion& question);
  void loop();

  const SlamConfig config_;
  const MappingMode mode_;
  const std::size_t places_per_frame_;
  std::atomic<std::uint64_t> session_{0};
  mutable std::mutex mapper_mutex_;  ///< held while the mapper works
  std::unique_ptr<Mapper> mapper_;   ///< another one in each session
  KeyframeId centre_ = 0;
  mutable std::mutex output_mutex_;  ///< guards the three below, held briefly
  LocalMapPtr snapshot_;
  std::vector<KeyframeChange> changes_;
  std::vector<LocalMapPtr> places_;
  std::vector<LoopClosure> loops_;
  std::atomic<int> pending_{0};
  std::atomic<bool> place_wanted_{false};
  std::atomic<KeyframeId> wanted_centre_{0};
  std::atomic<bool> recentre_queued_{false};
  concurrency::BoundedQueue<Queued> queue_;
  std::thread thread_;
};

}  // namespace rtd::slam
