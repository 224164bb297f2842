// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <functional>
#include <vector>

#include "common/msg/features.hpp"
#include "common/vision/rgbd_image.hpp"
#include "services/filter/core/boxes/mover_tracks.hpp"
#include "services/filter/core/motion/ego_motion.hpp"
#include "services/filter/core/motion/view_store.hpp"
#include "services/filter/core/surfaces/object_masks.hpp"

namespace rtd::filter {

/// Milliseconds by msg::FilterStage.
using StageTimes = std::array<float, msg::kFilterStages>;

/// Measures consecutive stages with an injected clock.
class StageClock {
 public:
  explicit StageClock(const std::function<std::int64_t()>& now_ns) : now_ns_(now_ns), last_ns_(now_ns()) {}
  /// Adds the time since construction or the last call to this stage.
  void finish(msg::FilterStage stage) {
    const std::int64_t before_ns = last_ns_;
    last_ns_ = now_ns_();
    times_ms_[stage] += static_cast<float>(last_ns_ - before_ns) * 1e-6F;
  }
  const StageTimes& times_ms() const { return times_ms_; }

 private:
  const std::function<std::int64_t()>& now_ns_;
  std::int64_t last_ns_;
  StageTimes times_ms_{};
};

/// The frame in cells of the depth grid.
struct Surfaces {
  DepthGrid grid;
  DepthClusters clusters;
  const std::vector<Eigen::Vector3f>& rays;  ///< viewing rays of the cells at z = 1, kept by the sampler
};

/// One frame, prepared for the judgement of any mode.
struct Scene {
  const vision::RgbdImage& image;
  const Surfaces& surfaces;
  const std::vector<SceneObject>& objects;
  bool detector_active = false;  ///< a detector looks for objects: what has no box is not an object of a known class
  const Gyroscope* gyroscope = nullptr;  ///< with the samples up to this frame; may be none
  const GridShape& shape() const { return surfaces.grid.shape; }
};

/// What is known about the motion of a grid cell; the values are grey values of the published mask.
enum class CellMotion : std::uint8_t {
  kStatic = 0,
  kUnknown = 128,  ///< nothing that may move covers the cell, but nothing shows that it is at rest either
  kDynamic = 255,  ///< moves, or belongs to an object of a high level; grown by masks.dilate_cells
};
/// `others_rest`: cells that are not dynamic were found to be at rest.
std::vector<CellMotion> to_cell_motion(const CellMask& dynamic, bool others_rest);

/// The verdict of a mode on one frame.
struct Verdict {
  std::vector<msg::Feature> features;                                ///< flagged and weighed, removed ones included
  std::vector<CellMotion> motion;                                    ///< per cell; empty in mode off
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();  ///< the quick estimate, if the mode makes one
  bool pose_reliable = false;                                        ///< geometry had a pose to compare views with
  std::uint32_t dynamic_clusters = 0;  ///< depth clusters that geometry found moving, with or without a class
  std::vector<TrackedMover> movers;    ///< without a class, in view or expected to come back
};

/// slam's pose of an earlier frame. Poses of two maps cannot be compared.
struct SlamPose {
  std::uint64_t seq = 0;
  std::uint32_t map_id = 0;
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
};

/// An earlier frame became a keyframe, slam corrected its pose, or slam removed it.
struct SlamKeyframe {
  std::uint64_t seq = 0;
  bool removed = false;
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
};

/// The rule by which a mode decides which features move. Features, surfaces and objects come before it and are the same
/// for all modes (modes/mode_table.hpp), so that a comparison of two modes compares the rules.
class ModeJudge {
 public:
  virtual ~ModeJudge() = default;
  /// Judges the features of the next frame; frames come in order of time.
  virtual Verdict judge(const Scene& scene, std::vector<msg::Feature> features, StageClock& clock) = 0;
  /// Corrects the pose of an earlier frame.
  virtual void on_pose(const SlamPose& pose) { views_.correct(pose.seq, pose.T_world_camera); }
  virtual void on_keyframe(const SlamKeyframe& keyframe);
  /// Whether to spend less time on a frame: for a computer that cannot keep up. A mode may ignore it.
  virtual void set_coarse(bool) {}
  /// Forgets all earlier frames.
  virtual void reset() { views_.clear(); }
  /// Earlier frames; none in a mode that does not compare with them.
  const ViewStore& views() const { return views_; }

 protected:
  ViewStore views_;
};

/// Marks a feature by a rule that knows only static and moving.
void mark(msg::Feature& feature, bool moving);

}  // namespace rtd::filter
