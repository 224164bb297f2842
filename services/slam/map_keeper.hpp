// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <mutex>
#include <string>
#include <thread>

#include "common/io/atomic_file.hpp"
#include "common/service/stop_token.hpp"
#include "services/slam/config.hpp"
#include "services/slam/core/slam_system.hpp"

namespace rtd::slam {

/// What a saved file holds.
struct SavedMap {
  std::uint64_t keyframes = 0, landmarks = 0, bytes = 0;
};

/// Keeps the map of a SlamSystem on disk: checkpoints while it grows, written in its own thread that yields to all
/// others, and the last word at the end. Tracking is never held up, the mapper only while the map is copied.
class MapKeeper {
 public:
  /// `slam` outlives it.
  MapKeeper(const MapFileConfig& config, const SlamSystem& slam);
  ~MapKeeper();
  MapKeeper(const MapKeeper&) = delete;
  MapKeeper& operator=(const MapKeeper&) = delete;

  /// Why the last save failed, what is left and what to do; empty when it did not. Any thread.
  std::string trouble() const;
  /// Ends the checkpoints and saves the map; false when that fails. An empty map leaves the file as it is. True without
  /// a file in the configuration.
  bool save_at_end();
  /// Saves the map as it is now, whatever the configuration says; checkpoints continue. Any thread; the mapper waits
  /// while the map is copied. Throws std::runtime_error with file and cause: nothing was mapped, or the file cannot be
  /// written, which then keeps what it held.
  SavedMap save_to(const std::filesystem::path& path, io::NamedBy named_by = io::NamedBy::kOperator);

 private:
  /// Distinguishes one state of the map from a later one.
  struct Growth {
    KeyframeId next_keyframe = 0;
    LandmarkId next_landmark = 0;
    bool operator==(const Growth&) const = default;
  };

  void loop();
  bool save(const char* occasion);
  bool is_configured(const std::filesystem::path& path) const;
  SavedMap write(const std::filesystem::path& path, const char* occasion, io::NamedBy named_by);
  void note_trouble(std::string trouble);

  const MapFileConfig config_;
  const SlamSystem& slam_;
  std::mutex file_mutex_;     ///< one file at a time
  Growth saved_;              ///< what the configured file holds; guarded by file_mutex_
  mutable std::mutex mutex_;  ///< guards trouble_
  std::string trouble_;
  service::StopToken ended_;
  std::thread thread_;
};

/// Writes PATH.txt (TUM format); where stamps go back, as when a recording is played again, PATH_segment_2.txt and so
/// on with what follows: in each file stamps increase. Throws std::runtime_error naming the file that cannot be
/// written.
void write_trajectory(const std::vector<StampedPose>& poses, const std::filesystem::path& path);

/// Writes trajectory.txt, keyframes.txt (TUM format) and map.ply of the first map into `folder`, which is made when
/// missing, and trajectory_map_N.txt for each other map that was never merged: it has its own world frame;
/// trajectories as write_trajectory(). Call after SlamSystem::finish(). Throws std::runtime_error naming the file that
/// cannot be written.
void write_run_files(const SlamSystem& slam, const std::filesystem::path& folder);

}  // namespace rtd::slam
