// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>
#include <optional>
#include <string>

#include "common/occupancy/navigation_grid.hpp"

namespace CLI {
class App;
}

namespace rtd::maps {

/// The command line of `rtd map`.
struct MapRequest {
  bool info = false, to_export = false;  ///< which of the two
  std::string file;
  bool json = false;
  std::string format;               ///< ply, pcd, tum or bt; of a voxel map ply, pcd or pgm
  std::string out;                  ///< file to write
  long long map_id = -1;            ///< which map of the file; -1 = the one with most keyframes
  std::optional<double> floor_m;    ///< of a voxel map; empty: found in it
  occupancy::RobotHeights heights;  ///< what counts in a floor plan
};

/// Adds `info` and `export`; parsing fills `request`, which must outlive `app`.
void add_map_commands(CLI::App& app, MapRequest& request);

/// Writes the report or the file; progress and errors go to `err`. Returns the exit code: 0; 1 when the output cannot
/// be written; 2 when the file cannot be read, is not a map or has another version, or the output exists; 3 when it is
/// damaged.
int run_map(const MapRequest& request, std::ostream& out, std::ostream& err);

}  // namespace rtd::maps
