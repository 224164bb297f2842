// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/motion/dynamic_regions.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace rtd::filter {
namespace {

/// Smaller moving regions are noise: depth cameras see thin structures now and then.
constexpr int kMinRegionCells = 40;
constexpr int kMinClusterStatements = 30;  ///< cells with a statement before a cluster is judged
constexpr double kMinViolatedShare = 0.2;  ///< of them violated: the cluster is dynamic
constexpr int kMinRestingCells = 400;      ///< a part of a moving surface may rest from this size on
constexpr double kMaxDynamicShare = 0.75;  ///< if more of the image is dynamic, the pose is wrong: no statement

constexpr double kMinRememberedShare = 0.4;
constexpr int kForgetFaster = 4;  // a surface at rest is forgotten so many times faster

/// The counts by which a cluster is judged.
struct ClusterEvidence {
  int seen = 0;  ///< cells with a statement, or that were there a while ago even if they counted as dynamic then
  int stated = 0, violating = 0, remembered = 0;
  std::uint8_t hold_cs = 0;
};

std::vector<ClusterEvidence> gather(const DepthClusters& clusters, const DepthEvidence& evidence,
                                    const CellMask& remembered) {
  std::vector<ClusterEvidence> gathered(clusters.cells.size());
  for (std::size_t cell = 0; cell < clusters.label.size(); ++cell) {
    if (clusters.label[cell] < 0) continue;
    ClusterEvidence& cluster = gathered[static_cast<std::size_t>(clusters.label[cell])];
    cluster.violating += evidence.violated[cell] > 0 ? 1 : 0;
    cluster.stated += evidence.violated[cell] > 0 || evidence.consistent[cell] > 0 ? 1 : 0;
    cluster.seen += evidence.violated[cell] > 0 || evidence.consistent[cell] > 0 || evidence.lasting[cell] > 0 ? 1 : 0;
    cluster.remembered += remembered[cell] > 0 ? 1 : 0;
    cluster.hold_cs = std::max(cluster.hold_cs, remembered[cell]);
  }
  return gathered;
}

bool violates(const ClusterEvidence& cluster) {
  return cluster.violating >= kMinRegionCells / 2 && cluster.stated >= kMinClusterStatements &&
         cluster.violating >= kMinViolatedShare * cluster.stated;
}

std::uint8_t what_is_left(int hold_cs, int elapsed_cs) {
  return static_cast<std::uint8_t>(std::max(0, hold_cs - elapsed_cs));
}

int vote_count(const std::vector<int>& per_cluster, std::size_t cluster) {
  return cluster < per_cluster.size() ? per_cluster[cluster] : 0;
}

/// Slow votes count where they are more than a few of the surface's features: one wrong match in a repeated texture
/// brings its neighbours along.
bool creeps(const MotionVotes& votes, std::size_t cluster, const GeometryConfig& config) {
  constexpr int kLeastOfQuick = 6;  // one slow vote for so many quick ones
  const int quick = vote_count(votes.quick.moving, cluster) + vote_count(votes.quick.resting, cluster);
  return votes.slow.cluster_creeps(cluster, config) && kLeastOfQuick * vote_count(votes.slow.moving, cluster) >= quick;
}

/// Depth and features both show that it rests: it was taken for dynamic wrongly, or it has stopped.
bool rests(const ClusterEvidence& cluster, const MotionVotes& votes, std::size_t index, const GeometryConfig& config) {
  const auto at_place = [&](const FeatureVotes& cast) {
    return vote_count(cast.resting, index) >= config.min_resting_ratio * vote_count(cast.moving, index);
  };
  return cluster.seen >= kMinClusterStatements && cluster.violating <= config.max_unsettled_share * cluster.seen &&
         votes.quick.cluster_rests(index, config) && at_place(votes.slow);
}

/// Per cluster: for how many 1/100 s it counts as dynamic, 0 = not.
std::vector<std::uint8_t> judge_clusters(const DepthClusters& clusters, const DepthEvidence& evidence,
                                         const MotionVotes& votes, const RememberedMotion& remembered,
                                         const GeometryConfig& config) {
  const std::vector<ClusterEvidence> gathered = gather(clusters, evidence, remembered.hold_cs);
  std::vector<std::uint8_t> hold_cs(gathered.size(), 0);
  for (std::size_t i = 0; i < gathered.size(); ++i) {
    if (violates(gathered[i]) || votes.quick.cluster_moves(i, config) || creeps(votes, i, config)) {
      hold_cs[i] = to_cs(config.memory_s);
    } else if (gathered[i].remembered >= kMinRememberedShare * clusters.cells[i]) {
      const int faster = rests(gathered[i], votes, i, config) ? kForgetFaster : 1;
      hold_cs[i] = what_is_left(gathered[i].hold_cs, faster * remembered.elapsed_cs);
    }
  }
  return hold_cs;
}

/// Votes on the cells of a region: at their place, displaced.
std::pair<int, int> sum_votes(const VotesByCell& votes, const std::vector<int>& region) {
  std::pair<int, int> total{0, 0};
  for (const int cell : region) {
    total.first += votes.resting[static_cast<std::size_t>(cell)];
    total.second += votes.moving[static_cast<std::size_t>(cell)];
  }
  return total;
}

/// Large parts that have lasted and whose features are at their place: the floor under a walker belongs to the walker's
/// depth cluster but not to the walker. The inside of a slow mover lasts too, but its features have moved.
CellMask resting_parts(const DepthClusters& clusters, const DepthEvidence& evidence, const MotionVotes& votes,
                       const GeometryConfig& config) {
  const std::size_t cells = clusters.label.size();
  const VotesByCell quick = by_cell(votes.quick, cells), slow = by_cell(votes.slow, cells);
  const auto rests = [&](const std::vector<int>& region) {
    if (static_cast<int>(region.size()) < kMinRestingCells) return false;
    const auto [at_place, displaced] = sum_votes(quick, region);
    const auto [long_at_place, long_displaced] = sum_votes(slow, region);
    return at_place >= config.min_moving_features && at_place >= config.min_resting_ratio * displaced &&
           long_at_place >= config.min_resting_ratio * long_displaced;
  };
  return keep_regions(clusters.shape, compact(clusters.shape, evidence.lasting), rests);
}

}  // namespace

std::uint8_t to_cs(double time_s) {
  return static_cast<std::uint8_t>(std::min(255L, std::lround(100 * time_s)));
}

DepthEvidence accept_arrivals(DepthEvidence evidence, const DepthClusters& clusters, const FeatureVotes& quick,
                              const FeatureVotes& old, const GeometryConfig& config) {
  std::vector<int> seen_through(clusters.cells.size(), 0), settled(clusters.cells.size(), 0);
  for (std::size_t cell = 0; cell < clusters.label.size(); ++cell) {
    if (clusters.label[cell] < 0) continue;
    const auto cluster = static_cast<std::size_t>(clusters.label[cell]);
    settled[cluster] += evidence.settled[cell];
    seen_through[cluster] += evidence.violated[cell] != 0 && evidence.settled[cell] == 0 ? 1 : 0;
  }
  std::vector<char> accepted(clusters.cells.size(), 0);
  for (std::size_t i = 0; i < accepted.size(); ++i) {
    accepted[i] = settled[i] > 0 && seen_through[i] <= config.max_unsettled_share * clusters.cells[i] &&
                  quick.cluster_rests(i, config) && old.cluster_rests(i, config);
  }
  for (std::size_t cell = 0; cell < clusters.label.size(); ++cell) {
    if (clusters.label[cell] < 0 || evidence.settled[cell] == 0) continue;
    if (accepted[static_cast<std::size_t>(clusters.label[cell])] == 0) continue;
    evidence.violated[cell] = 0;
    evidence.lasting[cell] = 1;
  }
  return evidence;
}

DynamicRegions find_dynamic_regions(const DepthClusters& clusters, const DepthEvidence& evidence,
                                    const MotionVotes& votes, const RememberedMotion& remembered,
                                    const GeometryConfig& config) {
  const std::uint8_t loose_memory_cs = to_cs(config.loose_memory_s);
  const std::vector<std::uint8_t> of_cluster = judge_clusters(clusters, evidence, votes, remembered, config);
  const CellMask resting = resting_parts(clusters, evidence, votes, config);
  const CellMask none(clusters.label.size(), 0);
  DynamicRegions regions{true, none, 0};
  CellMask loose(none);  // evidence inside clusters that are not dynamic as a whole
  for (std::size_t cell = 0; cell < none.size(); ++cell) {
    const std::int32_t label = clusters.label[cell];
    const std::uint8_t hold_cs = label < 0 ? std::uint8_t{0} : of_cluster[static_cast<std::size_t>(label)];
    const std::uint8_t left_cs = what_is_left(remembered.hold_cs[cell], remembered.elapsed_cs);
    if (hold_cs > 0) {  // resting parts are left out, but what has moved is released slowly
      regions.hold_cs[cell] = resting[cell] == 0 ? hold_cs : std::min(hold_cs, left_cs);
    } else {
      loose[cell] = evidence.violated[cell] > 0 ? loose_memory_cs : std::min(loose_memory_cs, left_cs);
    }
  }
  const CellMask groups = keep_regions(clusters.shape, compact(clusters.shape, loose), [&](const auto& region) {
    return static_cast<int>(region.size()) >= kMinRegionCells;
  });
  for (std::size_t cell = 0; cell < none.size(); ++cell) {
    regions.hold_cs[cell] = std::max(regions.hold_cs[cell], groups[cell]);
  }
  const auto dynamic = std::count_if(regions.hold_cs.begin(), regions.hold_cs.end(), [](int n) { return n > 0; });
  const auto measured =
      std::count_if(clusters.label.begin(), clusters.label.end(), [](int label) { return label >= 0; });
  if (static_cast<double>(dynamic) > kMaxDynamicShare * static_cast<double>(measured)) return {false, none, 0};
  regions.clusters = static_cast<int>(std::count_if(of_cluster.begin(), of_cluster.end(), [](int n) { return n > 0; }));
  return regions;
}

void DynamicMemory::store(const DepthGrid& grid, const std::vector<Eigen::Vector3f>& rays,
                          const std::vector<std::uint8_t>& hold_cs) {
  points_.clear();
  for (std::size_t cell = 0; cell < hold_cs.size(); ++cell) {
    if (hold_cs[cell] > 0 && grid.depth_m[cell] > 0)
      points_.push_back({rays[cell] * grid.depth_m[cell], hold_cs[cell]});
  }
}

std::vector<std::uint8_t> DynamicMemory::recall(const DepthGrid& grid, const geometry::CameraModel& camera,
                                                const Eigen::Isometry3d& T_current_last, double elapsed_s) const {
  constexpr double kOwnDepthM = 0.1, kFastMS = 3, kMaxOwnDepthM = 0.4;
  const auto own_depth_m = static_cast<float>(std::min(kMaxOwnDepthM, kOwnDepthM + kFastMS * elapsed_s));
  constexpr float kNearestM = 0.1F;
  const Eigen::Matrix3f rotation = T_current_last.linear().cast<float>();
  const Eigen::Vector3f translation = T_current_last.translation().cast<float>();
  const auto& p = camera.parameters();
  const auto fx = static_cast<float>(p.fx), fy = static_cast<float>(p.fy);
  const auto cx = static_cast<float>(p.cx), cy = static_cast<float>(p.cy);
  const auto cell_px = static_cast<float>(grid.shape.cell_px);
  std::vector<std::uint8_t> hold_cs(static_cast<std::size_t>(grid.shape.size()), 0);
  for (const Point& point : points_) {
    const Eigen::Vector3f p_current = rotation * point.p_camera + translation;
    if (p_current.z() < kNearestM) continue;
    // Two by two cells: no holes when things come nearer.
    const auto left = static_cast<int>(std::floor((fx * p_current.x() / p_current.z() + cx) / cell_px - 0.5F));
    const auto top = static_cast<int>(std::floor((fy * p_current.y() / p_current.z() + cy) / cell_px - 0.5F));
    for (int row = std::max(top, 0); row <= std::min(top + 1, grid.shape.rows - 1); ++row) {
      for (int column = std::max(left, 0); column <= std::min(left + 1, grid.shape.columns - 1); ++column) {
        const auto i = static_cast<std::size_t>(grid.shape.index(column, row));
        if (std::abs(grid.depth_m[i] - p_current.z()) < own_depth_m) hold_cs[i] = std::max(hold_cs[i], point.hold_cs);
      }
    }
  }
  return hold_cs;
}

}  // namespace rtd::filter
