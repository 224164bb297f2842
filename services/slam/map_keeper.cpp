// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/map_keeper.hpp"

#include <fmt/format.h>
#include <stdexcept>
#include <string>

#include "common/concurrency/thread_priority.hpp"
#include "common/io/atomic_file.hpp"
#include "common/service/log.hpp"
#include "common/service/monotonic_clock.hpp"
#include "services/slam/map_file.hpp"

namespace rtd::slam {
namespace {

double ms_since(std::int64_t start_ns) {
  return static_cast<double>(service::monotonic_ns() - start_ns) * 1e-6;
}

}  // namespace

MapKeeper::MapKeeper(const MapFileConfig& config, const SlamSystem& slam) : config_(config), slam_(slam) {
  if (!config.save.empty()) io::remove_unfinished(io::folder_of(config.save));  // of a process that was killed
  if (!config.save.empty() && config.checkpoint_s > 0) thread_ = std::thread([this] { loop(); });
}

MapKeeper::~MapKeeper() {
  ended_.request_stop();
  if (thread_.joinable()) thread_.join();
}

std::string MapKeeper::trouble() const {
  const std::lock_guard lock(mutex_);
  return trouble_;
}

bool MapKeeper::save_at_end() {
  ended_.request_stop();
  if (thread_.joinable()) thread_.join();
  return config_.save.empty() || save("end");
}

void MapKeeper::loop() {
  constexpr int kNicer = 10;
  concurrency::lower_thread_priority(kNicer);
  const std::chrono::milliseconds period(static_cast<std::int64_t>(config_.checkpoint_s * 1000));
  while (!ended_.wait_for(period)) {
    const Growth now = slam_.read_map([](const Map& map) { return Growth{map.next_keyframe(), map.next_landmark()}; });
    Growth saved;
    {
      const std::lock_guard lock(file_mutex_);
      saved = saved_;
    }
    if (now != saved) save("checkpoint");
  }
}

bool MapKeeper::save(const char* occasion) {
  if (slam_.read_map([](const Map& map) { return map.empty(); })) {
    SPDLOG_WARN("event=map_not_saved file={} cause=\"nothing was mapped\"", config_.save);
    return true;
  }
  try {
    write(config_.save, occasion, io::NamedBy::kOperator);
  } catch (const std::exception& error) {
    SPDLOG_ERROR("event=map_not_saved file={} occasion={} cause=\"{}\" kept=\"what the file held before\"",
                 config_.save, occasion, error.what());
    note_trouble(fmt::format("map not saved, {} keeps what it held: {}", config_.save, error.what()));
    return false;
  }
  note_trouble({});
  return true;
}

SavedMap MapKeeper::save_to(const std::filesystem::path& path, io::NamedBy named_by) {
  const SavedMap saved = write(path, "request", named_by);
  if (is_configured(path)) note_trouble({});
  return saved;
}

bool MapKeeper::is_configured(const std::filesystem::path& path) const {
  return path.lexically_normal() == std::filesystem::path(config_.save).lexically_normal();
}

SavedMap MapKeeper::write(const std::filesystem::path& path, const char* occasion, io::NamedBy named_by) {
  const std::lock_guard lock(file_mutex_);
  const std::int64_t start_ns = service::monotonic_ns();
  const MapSnapshot snapshot = slam_.read_map([](const Map& map) { return take_snapshot(map); });
  const double copy_ms = ms_since(start_ns);
  if (snapshot.keyframes.empty()) throw std::runtime_error("nothing was mapped: there is no map to save");
  const std::uint64_t bytes = save_map_file(path, snapshot, named_by);
  SPDLOG_INFO("event=map_saved file={} occasion={} keyframes={} landmarks={} bytes={} copy_ms={:.0f} ms={:.0f}",
              path.string(), occasion, snapshot.head.keyframes, snapshot.head.landmarks, bytes, copy_ms,
              ms_since(start_ns));
  if (is_configured(path)) saved_ = {snapshot.head.next_keyframe, snapshot.head.next_landmark};
  return {snapshot.head.keyframes, snapshot.head.landmarks, bytes};
}

void MapKeeper::note_trouble(std::string trouble) {
  const std::lock_guard lock(mutex_);
  trouble_ = std::move(trouble);
}

void write_trajectory(const std::vector<StampedPose>& poses, const std::filesystem::path& path) {
  int number = 0;
  for (const geometry::Trajectory& segment : geometry::split_where_time_goes_back(poses)) {
    const std::string name = ++number == 1 ? path.string() : path.string() + "_segment_" + std::to_string(number);
    io::write_file(name + ".txt", [&](std::ostream& out) { geometry::write_tum_trajectory(out, segment); });
  }
  if (number > 1)
    SPDLOG_WARN("event=stamps_went_back segments={} file={}.txt holds=\"the first\"", number, path.string());
}

void write_run_files(const SlamSystem& slam, const std::filesystem::path& folder) {
  std::error_code ignored;  // an existing folder is fine, an impossible one shows when the file is written
  std::filesystem::create_directories(folder, ignored);
  write_trajectory(slam.trajectory(), folder / "trajectory");
  io::write_file(folder / "keyframes.txt",
                 [&](std::ostream& out) { geometry::write_tum_trajectory(out, slam.keyframes()); });
  for (const MapId map : slam.maps()) {
    if (map == 0) continue;
    write_trajectory(slam.trajectory(map), folder / ("trajectory_map_" + std::to_string(map)));
  }
  io::write_file(folder / "map.ply", [&](std::ostream& out) { write_ply(out, slam.map_points()); });
}

}  // namespace rtd::slam
