// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/motion/arrivals.hpp"

namespace rtd::filter {

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

}  // namespace rtd::filter
