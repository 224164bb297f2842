// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/msg/stamps.hpp"
#include "services/filter/core/filter_config.hpp"
#include "services/filter/core/motion/dynamic_regions.hpp"
#include "services/filter/core/boxes/kalman.hpp"
#include "services/filter/core/boxes/mover_sighting.hpp"

namespace rtd::filter {

/// A mover without a class, with an identity.
struct Mover {
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
  std::vector<Mover> movers() const;
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
