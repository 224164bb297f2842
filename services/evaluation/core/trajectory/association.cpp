// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/trajectory/association.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <tuple>

namespace rtd::eval {
namespace {

struct Candidate {
  std::int64_t difference_ns = 0;
  MatchedPair pair;
};

std::vector<Candidate> close_pairs(const std::vector<std::int64_t>& groundtruth_ns,
                                   const std::vector<std::int64_t>& estimate_ns, const AssociationOptions& options) {
  const std::int64_t max_difference_ns = std::llround(options.max_difference_s * 1e9);
  const std::int64_t offset_ns = std::llround(options.offset_s * 1e9);
  std::vector<Candidate> candidates;
  for (std::size_t i = 0; i < estimate_ns.size(); ++i) {
    const std::int64_t stamp_ns = estimate_ns[i] + offset_ns;
    auto it = std::upper_bound(groundtruth_ns.begin(), groundtruth_ns.end(), stamp_ns - max_difference_ns);
    for (; it != groundtruth_ns.end() && *it < stamp_ns + max_difference_ns; ++it) {
      candidates.push_back({std::abs(*it - stamp_ns), {static_cast<std::size_t>(it - groundtruth_ns.begin()), i}});
    }
  }
  return candidates;
}

}  // namespace

std::vector<MatchedPair> associate(const std::vector<std::int64_t>& groundtruth_ns,
                                   const std::vector<std::int64_t>& estimate_ns, const AssociationOptions& options) {
  std::vector<Candidate> candidates = close_pairs(groundtruth_ns, estimate_ns, options);
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return std::tie(a.difference_ns, a.pair.groundtruth, a.pair.estimate) <
           std::tie(b.difference_ns, b.pair.groundtruth, b.pair.estimate);
  });
  std::vector<bool> groundtruth_used(groundtruth_ns.size()), estimate_used(estimate_ns.size());
  std::vector<MatchedPair> matches;
  for (const auto& [difference_ns, pair] : candidates) {
    if (groundtruth_used[pair.groundtruth] || estimate_used[pair.estimate]) continue;
    groundtruth_used[pair.groundtruth] = estimate_used[pair.estimate] = true;
    matches.push_back(pair);
  }
  std::sort(matches.begin(), matches.end(),
            [](const MatchedPair& a, const MatchedPair& b) { return a.groundtruth < b.groundtruth; });
  return matches;
}

}  // namespace rtd::eval
