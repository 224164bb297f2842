// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "common/msg/features.hpp"
#include "common/msg/tracking.hpp"
#include "common/service/monotonic_clock.hpp"
#include "services/camera/core/frame_source.hpp"
#include "services/launcher/core/evaluation/trajectory.hpp"
#include "services/slam/core/slam_system.hpp"

namespace rtd::test_support {

/// The features of one frame and what they cost.
struct FrontEndOutput {
  std::vector<msg::Feature> features;
  std::map<std::string, double> stage_ms;  ///< by name, e.g. "detector", "filter.extract"
};

/// What turns an image into features, and listens to what slam says of them.
class FrontEnd {
 public:
  virtual ~FrontEnd() = default;
  virtual FrontEndOutput process(const camera::SourceFrame& frame) = 0;
  virtual void listen(const slam::SlamOutput& /*output*/) {}
};

/// The front end of a mode:
///   off        every ORB feature is used
///   true-mask  features on the source's own mask of moving pixels, grown by 3 px, are removed
///   semantic, geometry, rtd   the dynamic filter; semantic and rtd with the detector model in RTD_MODEL_DIR
/// Throws std::invalid_argument for other names and when a model is missing.
std::unique_ptr<FrontEnd> make_front_end(const std::string& mode);

struct OfflineOptions {
  std::string source;  ///< URI, e.g. "tum:/data/walk_xyz?masks=1"
  std::string mode = "off";
  std::size_t max_frames = 0;  ///< 0 = all
  slam::SlamConfig slam;
  slam::MappingMode mapping = slam::MappingMode::kSynchronous;
  slam::Clock now_ns = service::monotonic_ns;             ///< for slam's stage times
  std::function<void(const slam::SlamOutput&)> on_frame;  ///< called after each frame; may be empty
};

/// The whole system in one thread without transport: what lockstep computes.
struct OfflineReport {
  std::size_t frames = 0, tracked = 0, keyframes = 0, landmarks = 0;
  std::string trajectory_tum;  ///< as rtd-slam writes trajectory.txt
  eval::Trajectory trajectory, groundtruth;
  double ate_rmse_m = 0;                                ///< NaN without ground truth
  double rpe_trans_rmse_m = 0, rpe_rot_rmse_deg = 0;    ///< per second
  double coverage = 0;                                  ///< tracked / frames
  std::map<std::string, std::vector<double>> stage_ms;  ///< per frame, by name
};
OfflineReport run_offline(const OfflineOptions& options);

/// The features of one image as the message that slam takes.
std::unique_ptr<msg::FeatureFrame> make_feature_frame(const vision::RgbdImage& image,
                                                      const std::vector<msg::Feature>& features);

}  // namespace rtd::test_support
