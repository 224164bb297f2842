// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/filter/core/belief/static_probability.hpp"
#include "services/filter/core/modes/mode_judge.hpp"
#include "services/filter/core/motion/dynamic_regions.hpp"
#include "services/filter/core/motion/ego_motion.hpp"
#include "services/filter/core/motion/undecided_surfaces.hpp"

namespace rtd::filter {

/// The rule of this project, for the modes rtd, semantic and geometry, which differ in the techniques that are on.
/// docs/theory/dynamic_points.md.
class RtdJudge final : public ModeJudge {
 public:
  /// `config`: effective_config() of the mode.
  explicit RtdJudge(const FilterConfig& config) : configured_(config), config_(config), movers_(config.movers) {}

  Verdict judge(const Scene& scene, std::vector<msg::Feature> features, StageClock& clock) override;
  void on_pose(const SlamPose& pose) override;
  void on_keyframe(const SlamKeyframe& keyframe) override;
  void set_coarse(bool coarse) override;
  void reset() override;

 private:
  /// What the classes of the objects imply, before any comparison with earlier views.
  struct Foreground {
    DepthClusters clusters;  ///< every object is its own cluster
    CellMask high;           ///< per cell, 1 = on an object of a high level
    CellMask may_move;       ///< the same, without those that are known to rest
  };
  Foreground separate_foreground(const Scene& scene) const;
  UndecidedSurfaces find_undecided(const Scene& scene, const Foreground& foreground,
                                   const std::vector<msg::Feature>& features);
  EgoMotion find_ego_motion(const Scene& scene, const Foreground& foreground, const std::vector<msg::Feature>& features,
                            UndecidedSurfaces& undecided);
  DepthEvidence compare_with_views(const Scene& scene, const Foreground& foreground, const EgoMotion& ego) const;
  DynamicRegions find_regions(const Scene& scene, const Foreground& foreground, const UndecidedSurfaces& undecided,
                              const EgoMotion& ego, const DepthEvidence& evidence) const;
  std::vector<TrackedMover> follow_movers(const Scene& scene, const Foreground& foreground, const EgoMotion& ego,
                                          const DynamicRegions& regions);
  /// What the comparison with earlier views has led to.
  struct Findings {
    const CellMask& in_question;
    const DynamicRegions& regions;
    const DepthEvidence& evidence;
    const EgoMotion& ego;
  };
  std::vector<msg::Feature> weigh(const Scene& scene, const Findings& found, std::vector<msg::Feature> features);
  /// All that moves or may move, grown by masks.dilate_cells.
  CellMask dynamic_cells(const Scene& scene, const Foreground& foreground, const DynamicRegions& regions) const {
    return united(dilate(scene.shape(), regions.hold_cs, config_.masks.dilate_cells), foreground.may_move);
  }
  void remember(const Scene& scene, const EgoMotion& ego, const DynamicRegions& regions, const CellMask& dynamic,
                const std::vector<msg::Feature>& features);

  bool uses_geometry() const { return config_.mode == FilterMode::kGeometry || config_.mode == FilterMode::kRtd; }
  /// There is something to compare this frame with.
  bool compares() const { return uses_geometry() && !views_.empty(); }
  Eigen::Isometry3d predict_pose(const Scene& scene) const;
  CellMask without_known_surfaces(const Scene& scene, CellMask may_move) const;
  CellBeliefs recall_beliefs(const Scene& scene, const Eigen::Isometry3d& T_world_camera,
                             const CellMask* where = nullptr) const;
  void forget_what_is_known_to_rest(const Scene& scene, const Foreground& foreground,
                                    const Eigen::Isometry3d& T_world_camera, CellMask& hold_cs) const;
  RememberedMotion recall_movers(const Scene& scene, const Foreground& foreground,
                                 const Eigen::Isometry3d& T_world_camera) const;

  const FilterConfig configured_;
  FilterConfig config_;    ///< `configured_`, or with less work per frame
  std::uint32_t map_ = 0;  ///< of slam's last pose
  DynamicMemory memory_;
  MoverTracks movers_;
  SurfaceBeliefs beliefs_;
  SurfaceDecisions decisions_;
};

}  // namespace rtd::filter
