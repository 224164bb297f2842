// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <deque>
#include <vector>

namespace rtd::viewer {

/// Ground truth beside the tracked positions, aligned to them by the rigid motion with the smallest squared error
/// (Umeyama 1991), as docs/evaluation.md does it after the run. One thread.
class TruthTrack {
 public:
  void add_truth(std::int64_t stamp_ns, const Eigen::Vector3d& position_m);
  void add_estimate(std::int64_t stamp_ns, const Eigen::Vector3d& position_m);
  void clear();

  /// Counts alignments that differ visibly from the one before: all points are to be drawn again.
  std::uint64_t revision() const { return revision_; }
  const std::vector<Eigen::Vector3d>& positions_m() const { return truth_m_; }
  Eigen::Vector3d aligned(std::size_t place) const { return T_map_truth_ * truth_m_[place]; }
  /// Frames with both, and the absolute trajectory error (root mean square) over them; 0 before there are ten.
  std::size_t pairs() const { return paired_truth_m_.size(); }
  double ate_m() const { return ate_m_; }
  /// Aligns again when the number of pairs has grown by a tenth, or by 30.
  void align_if_grown();

 private:
  void pair();
  void align();

  struct Stamped {
    std::int64_t stamp_ns;
    Eigen::Vector3d position_m;
  };
  std::vector<Eigen::Vector3d> truth_m_;
  std::deque<Stamped> waiting_truth_, waiting_estimates_;
  std::vector<Eigen::Vector3d> paired_truth_m_, paired_estimate_m_;
  Eigen::Isometry3d T_map_truth_ = Eigen::Isometry3d::Identity();
  std::size_t aligned_pairs_ = 0;
  double ate_m_ = 0;
  std::uint64_t revision_ = 0;
};

}  // namespace rtd::viewer
