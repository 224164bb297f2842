// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/msg/features.hpp"
#include "services/evaluation/core/trajectory/trajectory_error.hpp"
#include "services/slam/core/slam_system.hpp"

namespace rtd::test_support {

/// A source as slam sees it, with the true poses.
struct FeatureClip {
  std::vector<std::shared_ptr<const msg::FeatureFrame>> frames;
  std::vector<std::optional<Eigen::Isometry3d>> T_world_camera;  ///< empty where the truth has none
};

/// ORB features of `count` frames of a source from `first` on; with `masks` without those on moving pixels. The truth's
/// clock shows `truth_offset_s` more than the images' stamps.
FeatureClip record_features(const std::string& source, std::size_t first, std::size_t count, bool masks,
                            double truth_offset_s = 0);

struct PosePair {
  Eigen::Isometry3d estimate, truth;  ///< T_world_camera, each in its own world
};

/// Where the truth has the poses of the estimate. The truth's body (markers of a motion capture) is turned against the
/// camera: R_truth = A R_estimate B; A and B are in turn the means over all poses. Positions alone, millimetres off on
/// some decimetres of a path, leave degrees of A open.
class WorldAlignment {
 public:
  explicit WorldAlignment(const std::vector<PosePair>& pairs);
  double error_m(const PosePair& pair) const;
  double error_deg(const PosePair& pair) const;

 private:
  eval::Alignment positions_;
  Eigen::Matrix3d R_truth_estimate_, R_camera_body_;
};

/// From a run of the whole clip without any loss; its world is that of every run that begins alike.
WorldAlignment align_worlds(const FeatureClip& clip, const slam::SlamConfig& config);

/// The camera maps the frames [0, mapped), sees nothing for `covered` frames, and then what `again` shows from `resume`
/// on. Frames get new stamps, 30 a second.
struct RelocalizationTrial {
  std::size_t mapped = 0, covered = 0, resume = 0, length = 30;
  std::function<void(const slam::FrameResult&, double error_m, double error_deg)> on_frame;  ///< after the cut
};

struct RelocalizationOutcome {
  bool found = false;                             ///< within a second
  double after_s = 0;                             ///< of the first known view
  double error_m = 0, error_deg = 0;              ///< of the first pose given out, in the world of the mapped part
  double worst_error_m = 0, worst_error_deg = 0;  ///< of all after it
  std::size_t wrong = 0;  ///< poses given out that are 10 cm or 5 deg wrong, also before it was found
  std::size_t maps = 0;
  double worst_ms = 0;         ///< longest process() since the cut
  double worst_search_ms = 0;  ///< longest kStageRelocalize
};

RelocalizationOutcome run_relocalization(const FeatureClip& mapped, const FeatureClip& again,
                                         const WorldAlignment& alignment, const RelocalizationTrial& trial,
                                         const slam::SlamConfig& config, slam::MappingMode mode);

}  // namespace rtd::test_support
