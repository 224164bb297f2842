// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/camera/frame_source.hpp"
#include "common/msg/features.hpp"
#include "common/msg/tracking.hpp"
#include "common/service/monotonic_clock.hpp"
#include "services/evaluation/core/removal/removal.hpp"
#include "services/evaluation/core/trajectory/integrity.hpp"
#include "services/evaluation/core/trajectory/trajectory_error.hpp"
#include "services/filter/core/dynamic_filter.hpp"
#include "services/slam/core/slam_system.hpp"
#include "tests/support/image_faults.hpp"
#include "tests/support/imu_of_truth.hpp"
#include "tests/support/simulated_detector.hpp"

namespace rtd::test_support {

/// The features of one frame and what they cost.
struct FrontEndOutput {
  std::vector<msg::Feature> features;
  std::map<std::string, double> stage_ms;  ///< by name, e.g. "detector", "filter.extract"
  filter::GridShape cells;                 ///< shape of `motion`; 0x0 when nothing was judged
  std::vector<filter::CellMotion> motion;  ///< what the filter says of each cell
};

/// What turns an image into features, and listens to what slam says of them.
class FrontEnd {
 public:
  virtual ~FrontEnd() = default;
  virtual FrontEndOutput process(const camera::SourceFrame& frame) = 0;
  virtual void listen(const slam::SlamOutput& /*output*/) {}
};

struct FrontEndOptions {
  /// off        every ORB feature is used
  /// true-mask  features on the source's own mask of moving pixels, grown by 3 px, are removed
  /// others     the dynamic filter in the mode of this name (filter.mode); all but geometry with the detector
  std::string mode = "off";
  DetectorOptions detector;
  std::vector<std::string> filter_settings;  ///< "filter.KEY=VALUE", as on rtd-filter's command line
  std::vector<ImageFault> image_faults;      ///< the detector sees their effect; whoever makes the frames applies them
};
/// Throws service::ConfigError for other names and settings, std::invalid_argument when a model is missing.
std::unique_ptr<FrontEnd> make_front_end(const FrontEndOptions& options);

struct OfflineOptions {
  std::string source;  ///< URI, e.g. "tum:/data/walk_xyz?masks=1"
  FrontEndOptions front_end;
  /// An IMU made of the source's ground truth, for sources without one. For filter and slam, or the filter alone.
  std::optional<ImuOfTruth::Options> imu_of_truth;
  std::uint64_t imu_seed = 1;
  bool imu_for_slam = true;
  std::size_t first_frame = 0;  ///< so many frames of the source are passed over
  std::size_t frame_step = 1;   ///< only one of so many frames is used, as from a slower camera
  std::size_t max_frames = 0;   ///< 0 = all
  slam::SlamConfig slam;
  slam::MappingMode mapping = slam::MappingMode::kSynchronous;
  double min_period_s = 0;  ///< a frame at most so often, as from a live camera; 0: as fast as it goes
  slam::Clock now_ns = service::monotonic_ns;             ///< for slam's stage times
  std::function<void(slam::SlamSystem&)> on_start;        ///< before the first frame: may restore a map; may be empty
  std::function<void(slam::SlamSystem&)> on_end;          ///< mapping has ended; may be empty
  std::function<void(const slam::SlamOutput&)> on_frame;  ///< called after each frame; may be empty
  /// Called with what the front end makes of each frame; may be empty.
  std::function<void(const camera::SourceFrame&, const std::vector<msg::Feature>&)> on_features;
};

/// A loop that was closed, and how far the motion between its keyframes is from the true one.
struct ClosedLoop {
  slam::LoopClosure closure;
  double error_m = 0, error_rad = 0;  ///< NaN without ground truth
};

/// The whole system in one thread without transport: what lockstep computes.
struct OfflineReport {
  std::size_t frames = 0, doubtful_frames = 0, keyframes = 0, landmarks = 0;
  std::string trajectory_tum;  ///< as rtd-slam writes trajectory.txt
  eval::Trajectory trajectory, groundtruth;
  double ate_rmse_m = 0;         ///< of the final trajectory; NaN without ground truth
  double online_ate_rmse_m = 0;  ///< of the poses as they were published
  double nees = 0;  ///< mean of the published poses and covariances, 6 when they are true; NaN without ground truth
  double rpe_trans_rmse_m = 0, rpe_rot_rmse_deg = 0;  ///< per second
  eval::Integrity integrity;                          ///< of all poses as they were published
  eval::Drift drift;                                  ///< of the measured ones in the first map
  std::size_t frames_left_out = 0;                    ///< the source had them; of a source that is played as a whole
  double coverage = 0;                                ///< share of the frames of the source that `trajectory` has
  std::size_t predicted_frames = 0;                   ///< in the trajectory by IMU or wheels
  double predicted_nees = 0;  ///< mean of those as they were published, 6 when their covariances are true
  double disparity_px_m = 0, readout_s = 0;  ///< of the sensor, as slam knows it at the end
  std::vector<ClosedLoop> loops;
  eval::RemovalQuality removal;                         ///< after the first second; of sources with masks
  std::map<std::string, std::vector<double>> stage_ms;  ///< per frame, by name
};
OfflineReport run_offline(const OfflineOptions& options);

/// The features of one image as the message that slam takes.
std::unique_ptr<msg::FeatureFrame> make_feature_frame(const vision::RgbdImage& image,
                                                      const std::vector<msg::Feature>& features);

}  // namespace rtd::test_support
