// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <deque>
#include <iosfwd>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "common/msg/tracking.hpp"
#include "services/dense/core/dense_config.hpp"
#include "services/dense/core/depth_view.hpp"
#include "services/dense/core/voxel_map.hpp"

namespace rtd::dense {

/// A point of the published map.
struct CloudPoint {
  Eigen::Vector3f p_world = Eigen::Vector3f::Zero();  ///< m
  std::array<float, 3> bgr{};                         ///< 0..255
  float weight = 0;                                   ///< in points seen at 1 m
};

/// Weighted means of the points of each cube of `cell_m`; in the order of each cube's first point.
std::vector<CloudPoint> merge_by_cell(const std::vector<CloudPoint>& points, double cell_m);

/// A colour as it is written: whole numbers, 0..255.
std::uint8_t to_byte(float value);

/// Binary PLY: x y z (float, m, world frame) red green blue (uchar) weight (float).
void write_ply(std::ostream& out, const std::vector<CloudPoint>& points);

/// Where slam's keyframes are now, and how far they have moved since the map last followed them.
class KeyframePoses {
 public:
  /// A removed keyframe: its points follow another one from now on.
  struct Removed {
    AnchorId keyframe = kNoAnchor, follows = kNoAnchor;
  };
  /// So many live keyframes are followed, 30 MB: those of a day and more. Later ones are as if they were none.
  static constexpr std::size_t kMax = 100'000;
  /// Applies one event of slam. Poses that are not finite are ignored.
  std::optional<Removed> update(const msg::KeyframeEvent& event);
  /// The keyframe that new points move with: the newest; kNoAnchor before the first.
  AnchorId newest() const { return newest_; }
  /// T_world_keyframe by the last event; nullptr for an unknown one.
  const Eigen::Isometry3d* pose(AnchorId keyframe) const;
  /// What the corrections since the last call do to points in the world, by keyframe: T_new * T_old^-1.
  std::map<AnchorId, Eigen::Isometry3f> take_motions();
  void clear() { *this = {}; }

 private:
  struct Poses {
    std::int64_t stamp_ns = 0;
    Eigen::Isometry3d T_world_keyframe, T_world_applied;  ///< by the last event; as applied to the map's points
  };
  AnchorId nearest_in_time(std::int64_t stamp_ns) const;

  std::map<AnchorId, Poses> keyframes_;
  std::set<std::pair<std::int64_t, AnchorId>> by_time_;  ///< stamps of the same keyframes
  AnchorId newest_ = kNoAnchor;
};

/// What one frame did to the map.
struct FusionReport {
  enum class Outcome { kFused, kBadPose, kBadImage };
  Outcome outcome = Outcome::kFused;
  std::uint64_t fused = 0;    ///< points that went in
  std::uint64_t masked = 0;   ///< points left out because they move, may move or are unknown
  std::uint64_t refused = 0;  ///< points that found no room
  std::uint64_t carved = 0;   ///< voxels that vanished because they were seen through
};

/// The dense static map: depth images without what moves, fused into voxels; what later turns out to be empty space
/// vanishes. Points belong to slam's keyframes and move with them. docs/theory/dense_map.md. Deterministic in the order
/// of calls, never throws for the content of a frame. One thread.
class StaticMap {
 public:
  explicit StaticMap(const DenseConfig& config);

  void update(const msg::KeyframeEvent& event);
  /// Carves, then fuses. `mask` as it came from the filter; T_world_camera in slam's world as of the events so far.
  FusionReport integrate(const vision::RgbdImage& image, const DynamicMask& mask,
                         const Eigen::Isometry3d& T_world_camera);
  /// Forgets everything, e.g. when slam has begun a new map.
  void clear();

  /// What is believed, after the corrections so far; in cells of the voxel size or, to keep to `max_points`,
  /// larger ones.
  std::vector<CloudPoint> cloud(std::size_t max_points = SIZE_MAX);
  /// Some of the points that were left out because they move, as they were seen: of the newest frames, kMovingKept at
  /// most.
  std::vector<CloudPoint> moving();
  static constexpr std::size_t kMovingKept = 60'000;
  /// Calls visit(voxel) for each voxel that is believed, after the corrections so far.
  template <class Visit>
  void for_each_believed(Visit visit) {
    follow_corrections();
    for (const Voxel& voxel : map_.voxels()) {
      if (believed(voxel)) visit(voxel);
    }
  }
  std::size_t voxels() const { return map_.voxels().size(); }
  bool full() const { return map_.full(); }
  const KeyframePoses& keyframes() const { return keyframes_; }

 private:
  void follow_corrections();
  std::uint64_t carve(const DepthView& view, const Eigen::Isometry3f& T_camera_world);
  void fuse(const DepthView& view, const Eigen::Isometry3f& T_world_camera, FusionReport& report);
  void keep_moving(const Eigen::Vector3f& p_world, const std::array<std::uint8_t, 3>& bgr, AnchorId anchor);
  bool believed(const Voxel& voxel) const;
  float sigma_m(float depth_m) const { return static_cast<float>(config_.noise.sigma_m(static_cast<double>(depth_m))); }

  struct MovingPoint {
    CloudPoint point;
    AnchorId anchor = kNoAnchor;
  };
  DenseConfig config_;
  VoxelMap map_;
  std::deque<MovingPoint> moving_;
  KeyframePoses keyframes_;
  PixelTable table_;
  std::uint32_t frame_ = 0;
};

}  // namespace rtd::dense
