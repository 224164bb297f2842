// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/dynamic_regions.hpp"

#include <algorithm>

namespace rtd::filter {
namespace {

constexpr double kMinRememberedShare = 0.4;
constexpr int kMinCompact = 6;  // of the 9 cells around one

/// The counts by which a cluster is judged.
struct ClusterEvidence {
  int stated = 0, violating = 0, remembered = 0;
  std::uint8_t frames_left = 0;
};

std::vector<ClusterEvidence> gather(const DepthClusters& clusters, const DepthEvidence& evidence,
                                    const std::vector<std::uint8_t>& remembered) {
  std::vector<ClusterEvidence> gathered(clusters.cells.size());
  for (std::size_t cell = 0; cell < clusters.label.size(); ++cell) {
    if (clusters.label[cell] < 0) continue;
    ClusterEvidence& cluster = gathered[static_cast<std::size_t>(clusters.label[cell])];
    cluster.violating += evidence.violated[cell] > 0 ? 1 : 0;
    cluster.stated += evidence.violated[cell] > 0 || evidence.consistent[cell] > 0 ? 1 : 0;
    cluster.remembered += remembered[cell] > 0 ? 1 : 0;
    cluster.frames_left = std::max(cluster.frames_left, remembered[cell]);
  }
  return gathered;
}

bool violates(const ClusterEvidence& cluster, const GeometryConfig& config) {
  return cluster.violating >= config.min_region_cells / 2 && cluster.stated >= config.min_cluster_statements &&
         cluster.violating >= config.min_violated_share * cluster.stated;
}

std::uint8_t one_less(std::uint8_t frames) {
  return frames > 0 ? static_cast<std::uint8_t>(frames - 1) : frames;
}

/// Cells most of whose 3x3 neighbourhood is set: noise along depth edges is one cell wide and vanishes.
std::vector<std::uint8_t> compact(const GridShape& shape, const std::vector<std::uint8_t>& cells) {
  std::vector<std::uint8_t> result(cells.size(), 0);
  for (int row = 1; row + 1 < shape.rows; ++row) {
    for (int column = 1; column + 1 < shape.columns; ++column) {
      int set = 0;
      for (int y = row - 1; y <= row + 1; ++y) {
        for (int x = column - 1; x <= column + 1; ++x)
          set += cells[static_cast<std::size_t>(shape.index(x, y))] > 0 ? 1 : 0;
      }
      const auto i = static_cast<std::size_t>(shape.index(column, row));
      if (set >= kMinCompact) result[i] = cells[i];
    }
  }
  return result;
}

/// Removes connected regions (4 neighbours) of less than `min_cells` cells.
void drop_small_regions(const GridShape& shape, std::vector<std::uint8_t>& cells, int min_cells) {
  std::vector<char> visited(cells.size(), 0);
  std::vector<int> region;
  for (int start = 0; start < shape.size(); ++start) {
    if (cells[static_cast<std::size_t>(start)] == 0 || visited[static_cast<std::size_t>(start)] != 0) continue;
    region.assign(1, start);
    visited[static_cast<std::size_t>(start)] = 1;
    const auto visit = [&](int cell) {
      if (cells[static_cast<std::size_t>(cell)] == 0 || visited[static_cast<std::size_t>(cell)] != 0) return;
      visited[static_cast<std::size_t>(cell)] = 1;
      region.push_back(cell);
    };
    for (std::size_t i = 0; i < region.size(); ++i) {
      const int cell = region[i], column = cell % shape.columns;
      if (column > 0) visit(cell - 1);
      if (column + 1 < shape.columns) visit(cell + 1);
      if (cell >= shape.columns) visit(cell - shape.columns);
      if (cell + shape.columns < shape.size()) visit(cell + shape.columns);
    }
    if (static_cast<int>(region.size()) >= min_cells) continue;
    for (const int cell : region) cells[static_cast<std::size_t>(cell)] = 0;
  }
}

/// Most of the cluster's features are at their place: more than the mover belongs to it.
bool mostly_resting(const ClusterVotes& votes, std::size_t cluster) {
  return cluster < votes.resting.size() && votes.resting[cluster] > votes.moving[cluster];
}

/// Large parts that have lasted: the floor on which a walker stands belongs to his depth cluster but not to him.
std::vector<std::uint8_t> resting_part(const DepthClusters& clusters, const DepthEvidence& evidence,
                                       const GeometryConfig& config) {
  std::vector<std::uint8_t> lasting = compact(clusters.shape, evidence.lasting);
  drop_small_regions(clusters.shape, lasting, config.min_resting_cells);
  return lasting;
}

}  // namespace

DynamicRegions find_dynamic_regions(const DepthClusters& clusters, const DepthEvidence& evidence,
                                    const ClusterVotes& votes, const std::vector<std::uint8_t>& remembered,
                                    const GeometryConfig& config) {
  const auto full_memory = static_cast<std::uint8_t>(config.memory_frames);
  const auto loose_memory = static_cast<std::uint8_t>(config.loose_memory_frames);
  const std::vector<ClusterEvidence> gathered = gather(clusters, evidence, remembered);
  std::vector<std::uint8_t> cluster_frames(gathered.size(), 0);
  DynamicRegions regions{true, std::vector<std::uint8_t>(clusters.label.size(), 0), 0};
  for (std::size_t i = 0; i < gathered.size(); ++i) {
    if (violates(gathered[i], config) || (i < votes.moving.size() && votes.moves(i, config))) {
      cluster_frames[i] = full_memory;
    } else if (gathered[i].remembered >= kMinRememberedShare * clusters.cells[i]) {
      cluster_frames[i] = one_less(gathered[i].frames_left);
    }
    regions.clusters += cluster_frames[i] > 0 ? 1 : 0;
  }
  const std::vector<std::uint8_t> at_rest = resting_part(clusters, evidence, config);
  std::vector<std::uint8_t> loose(clusters.label.size(),
                                  0);  // evidence inside clusters that are not dynamic as a whole
  for (std::size_t cell = 0; cell < loose.size(); ++cell) {
    const std::int32_t label = clusters.label[cell];
    if (label >= 0 && cluster_frames[static_cast<std::size_t>(label)] > 0 &&
        (at_rest[cell] == 0 || !mostly_resting(votes, static_cast<std::size_t>(label)))) {
      regions.frames_left[cell] = cluster_frames[static_cast<std::size_t>(label)];
    } else {
      loose[cell] = evidence.violated[cell] > 0 ? loose_memory : std::min(loose_memory, one_less(remembered[cell]));
    }
  }
  std::vector<std::uint8_t> groups = compact(clusters.shape, loose);
  drop_small_regions(clusters.shape, groups, config.min_region_cells);
  int dynamic = 0;
  for (std::size_t cell = 0; cell < groups.size(); ++cell) {
    regions.frames_left[cell] = std::max(regions.frames_left[cell], groups[cell]);
    dynamic += regions.frames_left[cell] > 0 ? 1 : 0;
  }
  if (dynamic > config.max_dynamic_share * clusters.shape.size()) {
    return {false, std::vector<std::uint8_t>(clusters.label.size(), 0), 0};
  }
  return regions;
}

std::vector<std::uint8_t> dilate(const GridShape& shape, const std::vector<std::uint8_t>& cells, int radius) {
  std::vector<std::uint8_t> wide(cells), result(cells);
  for (int row = 0; row < shape.rows; ++row) {
    for (int column = 0; column < shape.columns; ++column) {
      std::uint8_t& value = wide[static_cast<std::size_t>(shape.index(column, row))];
      for (int x = std::max(0, column - radius); x <= std::min(shape.columns - 1, column + radius); ++x) {
        value = std::max(value, cells[static_cast<std::size_t>(shape.index(x, row))]);
      }
    }
  }
  for (int row = 0; row < shape.rows; ++row) {
    for (int column = 0; column < shape.columns; ++column) {
      std::uint8_t& value = result[static_cast<std::size_t>(shape.index(column, row))];
      for (int y = std::max(0, row - radius); y <= std::min(shape.rows - 1, row + radius); ++y) {
        value = std::max(value, wide[static_cast<std::size_t>(shape.index(column, y))]);
      }
    }
  }
  return result;
}

}  // namespace rtd::filter
