// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

namespace rtd::eval {

struct AssociationOptions {
  double max_difference_s = 0.02;  ///< pairs must be closer than this
  double offset_s = 0;             ///< added to the stamps of the estimate
};

/// Indices of two poses that belong to the same moment.
struct MatchedPair {
  std::size_t groundtruth = 0;
  std::size_t estimate = 0;
};

/// Pairs stamps as TUM's associate.py does: all candidates closer than max_difference_s, taken greedily by smallest
/// difference (ties: earlier ground truth, then earlier estimate), each stamp used once. Both inputs in increasing
/// order. The result is in order of the ground-truth stamps.
std::vector<MatchedPair> associate(const std::vector<std::int64_t>& groundtruth_ns,
                                   const std::vector<std::int64_t>& estimate_ns,
                                   const AssociationOptions& options = {});

}  // namespace rtd::eval
