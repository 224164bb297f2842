// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/run_files.hpp"

#include <fstream>
#include <functional>
#include <stdexcept>
#include <string>

namespace rtd::slam {
namespace {

void write_file(const std::filesystem::path& path, const std::function<void(std::ostream&)>& write) {
  std::ofstream file(path);
  write(file);
  file.close();
  if (!file) throw std::runtime_error("cannot write " + path.string() + ": check the folder and the free space");
}

}  // namespace

void write_run_files(const SlamSystem& slam, const std::filesystem::path& folder) {
  std::error_code ignored;  // an existing folder is fine, an impossible one shows when the file is written
  std::filesystem::create_directories(folder, ignored);
  write_file(folder / "trajectory.txt", [&](std::ostream& out) { geometry::write_tum_trajectory(out, slam.trajectory()); });
  write_file(folder / "keyframes.txt", [&](std::ostream& out) { geometry::write_tum_trajectory(out, slam.keyframes()); });
  for (const MapId map : slam.maps()) {
    if (map == 0) continue;
    write_file(folder / ("trajectory_map_" + std::to_string(map) + ".txt"),
               [&](std::ostream& out) { geometry::write_tum_trajectory(out, slam.trajectory(map)); });
  }
  write_file(folder / "map.ply", [&](std::ostream& out) { write_ply(out, slam.map_points()); });
}

}  // namespace rtd::slam
