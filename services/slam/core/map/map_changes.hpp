// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "services/slam/core/map/map.hpp"

namespace rtd::slam {

/// A keyframe as viewers show it.
struct KeyframeView {
  KeyframeId id = kNoKeyframe;
  MapId map = 0;
  std::int64_t stamp_ns = 0;
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
  std::vector<LandmarkId> landmarks;  ///< those whose reference it is, ascending: each landmark belongs to one keyframe
  std::vector<Eigen::Vector3f> points_m;  ///< p_camera of each of them, m
  std::vector<KeyframeId> covisible;      ///< its parent and older keyframes that see much of the same, ascending
};

/// A copy of what viewers show of a whole map.
struct MapView {
  std::uint64_t session = 0;            ///< counts the maps of this process that replaced one another
  std::vector<KeyframeView> keyframes;  ///< by id
  std::vector<KeyframeId> loop_edges;   ///< older and newer keyframe of each closed loop that are still in the map
};

/// Calls its argument with the map while no other thread changes it.
using ReadMap = std::function<void(const std::function<void(const Map&)>&)>;

/// Copies the map in portions of a few milliseconds, so that the mapper never waits longer. What changes meanwhile may
/// be seen half: each keyframe and each landmark fits itself and its reference, the next copy has the rest.
MapView copy_view(const ReadMap& read);

/// What is to be said of one keyframe: always its pose, and what else is set.
struct KeyframeNews {
  KeyframeId id = kNoKeyframe;
  bool points = false, edges = false, removed = false;
};

/// The differences of a map from what was reported before.
struct MapNews {
  bool new_session = false;             ///< what was reported before is void
  bool loops = false;                   ///< the closed loops are others
  std::vector<KeyframeNews> keyframes;  ///< removed ones first, then by id

  bool empty() const { return !new_session && !loops && keyframes.empty(); }
};

/// Finds what changed in a map since it was last reported. What was reported is compared, not what was seen last: slow
/// drift is reported too, as soon as it adds up. Not thread-safe.
class MapChanges {
 public:
  struct Tolerance {
    double translation_m = 1e-4, rotation_rad = 1.7e-4;  ///< of a keyframe's pose: 0.1 mm, 0.01 degrees
    double point_m = 0.005;                              ///< of a point in its camera's frame
    /// Of a point, as a share of its distance. What moves less is reported bit by bit, because global adjustment moves
    /// almost every point a little: of `refined_at_once` keyframes at a time, or a hundredth of all if that is more.
    double point_share = 0.02;
    std::size_t refined_at_once = 8;
  };
  enum class Extent : std::uint8_t { kChanges, kEverything };

  MapChanges() = default;
  explicit MapChanges(const Tolerance& tolerance) : tolerance_(tolerance) {}

  /// What is new in `view`, which counts as reported from now on. kEverything: all keyframes with all they have, for a
  /// reader that knows nothing yet.
  MapNews update(const MapView& view, Extent extent = Extent::kChanges);
  /// Nothing has been reported: the next update is a new session.
  void forget() { *this = MapChanges(tolerance_); }

 private:
  struct Reported {
    MapId map = 0;
    Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
    std::vector<LandmarkId> landmarks;
    std::vector<Eigen::Vector3f> points_m;
    std::vector<KeyframeId> covisible;
  };
  void take_out_removed(const MapView& view, MapNews& news);
  bool has_moved(const Reported& reported, const KeyframeView& now) const;
  enum class PointsNow { kSame, kRefined, kOthers };
  PointsNow compare_points(const Reported& reported, const KeyframeView& now) const;
  void choose_refined(const MapView& view, std::vector<PointsNow>& points);

  Tolerance tolerance_;
  std::optional<std::uint64_t> session_;
  std::map<KeyframeId, Reported> reported_;
  std::vector<KeyframeId> loop_edges_;
  KeyframeId next_refined_ = 0;  ///< in turn
};

}  // namespace rtd::slam
