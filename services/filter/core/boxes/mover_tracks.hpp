// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/msg/stamps.hpp"
#include "services/filter/core/boxes/kalman.hpp"
#include "services/filter/core/config/filter_config.hpp"
#include "services/filter/core/motion/depth_check.hpp"
#include "services/filter/core/motion/dynamic_regions.hpp"
#include "services/filter/core/surfaces/cell_masks.hpp"
#include "services/filter/core/surfaces/depth_grid.hpp"

namespace rtd::filter {

/// The frame as the tracks of movers see it.
struct MoverFrame {
  const DepthGrid& grid;
  const std::vector<Eigen::Vector3f>& rays;
  const geometry::CameraModel& camera;
  CameraPose pose;
};

/// A surface that was seen moving: what one frame shows of a mover.
struct MoverSighting {
  Eigen::AlignedBox3d extent_world;  ///< 5 % of its cells lie beyond each side
  Box box_px;                        ///< image of the extent, undistorted pixels
  bool cut_off = false;              ///< by the border of the image
};

/// The clusters with at least 40 of these cells, in the order of their labels. `moving`: per cell, 1 = seen moving.
std::vector<MoverSighting> sight_movers(const MoverFrame& frame, const DepthClusters& clusters, const CellMask& moving);

/// Image of a box in space, undistorted pixels; nullopt if a corner is behind the camera.
std::optional<Box> project(const Eigen::AlignedBox3d& box_world, const MoverFrame& frame);
/// What is seen at the place of a box in space.
struct BoxContent {
  std::vector<int> cells;  ///< whose points lie in the box, ascending
  int measured = 0;        ///< cells with a depth in front of it, in it and behind it
};
BoxContent look_into(const Eigen::AlignedBox3d& box_world, const MoverFrame& frame);

/// A mover without a class, with an identity.
struct TrackedMover {
  int id = 0;  ///< unique until clear()
  Eigen::AlignedBox3d extent_world;
  Eigen::Vector3d velocity_world_m_s = Eigen::Vector3d::Zero();
  double age_s = 0;
  double unseen_s = 0;  ///< since it was last seen moving
};

/// Where movers without a class are, how large and how fast, in the world. What stays in sight is carried by the memory
/// of dynamic surfaces (DynamicMemory); what was out of sight for a second or more, out of the view or in a hole of the
/// depth image, is expected where its track predicts it, until it is seen at rest or its place empty.
/// docs/theory/dynamic_points.md section 4. Bounded, deterministic.
class MoverTracks {
 public:
  explicit MoverTracks(const MoverTrackConfig& config) : config_(config) {}

  /// Per cell: 1 = the surface here lies where a mover is expected that was out of sight.
  CellMask expected(const MoverFrame& frame) const;
  /// `moving`: per cell, 1 = of a surface that was seen moving in this very frame.
  void update(const MoverFrame& frame, const DepthClusters& clusters, const CellMask& moving,
              const FeatureVotes& slow_votes);
  /// Those seen often enough.
  std::vector<TrackedMover> movers() const;
  void clear() { tracks_.clear(); }

  static constexpr std::size_t kMaxTracks = 32;

 private:
  struct Track {
    int id = 0;
    std::array<AxisKalman, 3> axes;  ///< of the centre, m
    Eigen::Vector3d half_m;          ///< half of its extent
    std::int64_t first_ns = 0, now_ns = 0, seen_ns = 0;
    int hits = 1;
    bool whole = false;             ///< has been seen away from the border of the image
    bool out_of_sight = false;      ///< some time since it was last seen moving
    double rest_s = 0, gone_s = 0;  ///< seen at rest, or not where it should be, since it was last seen moving
    Eigen::Vector3d velocity() const { return {axes[0].state[1], axes[1].state[1], axes[2].state[1]}; }
    double unseen_s() const { return msg::minus_s(now_ns, seen_ns); }
    Eigen::AlignedBox3d extent(double margin_m) const;
  };
  void predict(Track& track, std::int64_t stamp_ns) const;
  std::vector<int> assign_to_tracks(const std::vector<MoverSighting>& sightings, const MoverFrame& frame) const;
  void hit(Track& track, const MoverSighting& sighting) const;
  void miss(Track& track, double elapsed_s, const MoverFrame& frame, const FeatureVotes& slow_votes) const;
  void start_track(const MoverSighting& sighting, std::int64_t stamp_ns);
  void place(Track& track, const Eigen::AlignedBox3d& extent_world) const;
  bool confirmed(const Track& track) const;
  double margin_m(const Track& track) const;
  bool ended(const Track& track) const;

  MoverTrackConfig config_;
  std::vector<Track> tracks_;
  int next_id_ = 0;
};

}  // namespace rtd::filter
