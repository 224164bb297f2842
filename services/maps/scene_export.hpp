// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>
#include <string>

namespace CLI {
class App;
}

namespace rtd::maps {

/// The command line of `rtd export`: a run as the input of Gaussian splatting and photogrammetry.
struct SceneRequest {
  std::string folder;              ///< of a run
  std::string colmap, nerfstudio;  ///< new folders; empty: not wanted
  std::string source;              ///< plays the frames of the run; empty: the one that the run names
};

/// Adds `scene`; parsing fills `request`, which must outlive `app`.
void add_scene_command(CLI::App& app, SceneRequest& request);

/// Writes keyframes as undistorted images with poses, intrinsics, landmarks, and masks of what moves. Returns the exit
/// code: 0; 1 when the output cannot be written; 2 when run or source cannot be read, or the output exists; 3 when
/// masks are missing, or images of keyframes.
int export_scene(const SceneRequest& request, std::ostream& out, std::ostream& err);

}  // namespace rtd::maps
