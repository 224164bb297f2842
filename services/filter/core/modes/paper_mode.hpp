// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/filter/core/modes/published_mode.hpp"
#include "services/filter/core/motion/static_consensus.hpp"
#include "services/filter/core/motion/view_store.hpp"

namespace rtd::filter {

/// The RTD-SLAM paper's own rules and thresholds, section III: whole boxes without depth masks, nothing remembered.
///
/// | the feature lies in        | it is removed                                   |
/// | a high box (person)        | always                                          |
/// | a medium box (chair, book) | when the multi-view check says moving           |
/// | a low box (tv)             | never                                           |
/// | both a low and a high box  | when the multi-view check says moving           |
/// | no box                     | when the multi-view check says moving           |
class PaperMode final : public PublishedMode {
 public:
  explicit PaperMode(const FilterConfig& config) : config_(config.paper), ego_motion_(config.ego_motion) {}
  PublishedVerdict judge(const PublishedInput& input, std::vector<msg::Feature>& features) override;
  void on_tracking(std::uint64_t seq, const Eigen::Isometry3d& T_world_camera) override {
    views_.correct(seq, T_world_camera);
  }
  void on_keyframe(std::uint64_t seq, const Eigen::Isometry3d& T_world_camera) override {
    views_.mark_keyframe(seq, T_world_camera);
  }
  void forget_keyframe(std::uint64_t seq) override { views_.forget_keyframe(seq); }
  void reset() override { views_.clear(); }

 private:
  RefinedPose find_pose(const PublishedInput& input, const std::vector<msg::Feature>& features,
                        const CellMask& high) const;

  PaperConfig config_;
  EgoMotionConfig ego_motion_;
  ViewStore views_;
};

}  // namespace rtd::filter
