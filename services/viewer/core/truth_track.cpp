// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/viewer/core/truth_track.hpp"

#include <algorithm>
#include <cmath>

namespace rtd::viewer {
namespace {

constexpr std::size_t kMaxPoints = 1'000'000, kMaxWaiting = 256, kFewestPairs = 10;

Eigen::Matrix3Xd matrix_of(const std::vector<Eigen::Vector3d>& points) {
  return Eigen::Map<const Eigen::Matrix3Xd>(points.front().data(), 3, static_cast<Eigen::Index>(points.size()));
}

}  // namespace

void TruthTrack::add_truth(std::int64_t stamp_ns, const Eigen::Vector3d& position_m) {
  if (truth_m_.size() >= kMaxPoints || !position_m.allFinite()) return;
  truth_m_.push_back(position_m);
  waiting_truth_.push_back({stamp_ns, position_m});
  pair();
}

void TruthTrack::add_estimate(std::int64_t stamp_ns, const Eigen::Vector3d& position_m) {
  if (paired_truth_m_.size() >= kMaxPoints || !position_m.allFinite()) return;
  waiting_estimates_.push_back({stamp_ns, position_m});
  pair();
}

void TruthTrack::clear() {
  const std::uint64_t revision = revision_;
  *this = TruthTrack();
  revision_ = revision + 1;
}

/// Truth carries the stamp of its frame, as the estimate does.
void TruthTrack::pair() {
  std::erase_if(waiting_estimates_, [this](const Stamped& estimate) {
    const auto truth = std::ranges::find(waiting_truth_, estimate.stamp_ns, &Stamped::stamp_ns);
    if (truth == waiting_truth_.end()) return false;
    paired_truth_m_.push_back(truth->position_m);
    paired_estimate_m_.push_back(estimate.position_m);
    waiting_truth_.erase(truth);
    return true;
  });
  for (auto* waiting : {&waiting_truth_, &waiting_estimates_})
    if (waiting->size() > kMaxWaiting) waiting->pop_front();
}

void TruthTrack::align_if_grown() {
  const std::size_t grown = paired_truth_m_.size() - aligned_pairs_;
  if (paired_truth_m_.size() >= kFewestPairs && grown >= std::clamp<std::size_t>(aligned_pairs_ / 10, 1, 30)) align();
}

void TruthTrack::align() {
  aligned_pairs_ = paired_truth_m_.size();
  const Eigen::Matrix3Xd truth = matrix_of(paired_truth_m_), estimate = matrix_of(paired_estimate_m_);
  const Eigen::Isometry3d aligned(Eigen::umeyama(truth, estimate, false));
  if (!aligned.matrix().allFinite()) return;
  constexpr double kVisible_m = 0.002;
  const double moved_m = ((aligned * truth.col(0)) - (T_map_truth_ * truth.col(0))).norm() +
                         ((aligned * truth.rightCols<1>()) - (T_map_truth_ * truth.rightCols<1>())).norm();
  if (moved_m > kVisible_m) {
    T_map_truth_ = aligned;
    ++revision_;
  }
  ate_m_ = std::sqrt(((aligned * truth) - estimate).colwise().squaredNorm().mean());
}

}  // namespace rtd::viewer
