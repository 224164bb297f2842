// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/msg/features.hpp"
#include "services/slam/core/slam_system.hpp"

namespace rtd::test_support {

/// A source as slam sees it, with the true poses.
struct FeatureClip {
  std::vector<std::shared_ptr<const msg::FeatureFrame>> frames;
  std::vector<std::optional<Eigen::Isometry3d>> T_world_camera;  ///< empty where the truth says nothing
};

/// ORB features of `count` frames of a source from `first` on; with `masks` without those on moving pixels.
FeatureClip record_features(const std::string& source, std::size_t first, std::size_t count, bool masks);

/// The camera maps the frames [0, mapped), sees nothing for `covered` frames, and then what `again` shows from `resume`
/// on. Frames are stamped anew, 30 a second.
struct RelocalizationTrial {
  std::size_t mapped = 0, covered = 0, resume = 0, length = 30;
  std::function<void(const msg::TrackingResult&, double error_m, double error_deg)> on_frame;  ///< after the cut
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
                                         const RelocalizationTrial& trial, const slam::SlamConfig& config,
                                         slam::MappingMode mode);

}  // namespace rtd::test_support
