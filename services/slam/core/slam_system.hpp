// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <optional>
#include <string>
#include <vector>

#include "common/msg/features.hpp"
#include "common/msg/tracking.hpp"
#include "services/slam/core/corrections.hpp"
#include "services/slam/core/floor_plane.hpp"
#include "services/slam/core/map/map_changes.hpp"
#include "services/slam/core/map/trajectory.hpp"
#include "services/slam/core/mapping/mapping_worker.hpp"
#include "services/slam/core/tracking/disagreement.hpp"
#include "services/slam/core/tracking/readout_estimator.hpp"
#include "services/slam/core/tracking/tracker.hpp"

namespace rtd::slam {

/// What SLAM found out about one frame.
struct FrameResult {
  std::uint64_t seq = 0;
  std::int64_t stamp_ns = 0;
  msg::TrackingState state = msg::TrackingState::kInitializing;
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();  ///< valid where msg::has_pose(state)
  geometry::Matrix6d covariance = geometry::Matrix6d::Zero();        ///< (x y z rx ry rz), m and rad, world frame
  std::uint64_t event_count = 0;               ///< keyframe changes up to and including this frame
  std::uint32_t inliers = 0;                   ///< landmarks that the pose agrees with
  double agreement = 0;                        ///< of a measured pose: Consistency::value()
  std::uint32_t features_static = 0;           ///< offered to tracking
  std::uint32_t features_removed = 0;          ///< left out because the filter judged them dynamic
  std::uint32_t keyframes = 0, landmarks = 0;  ///< size of the whole map
  MapId map_id = 0;                            ///< component of the pose
  std::uint32_t maps = 0;                      ///< components
  std::array<float, msg::kSlamStages> stage_ms{};
};

/// How the world of a new map was turned.
struct UpFound {
  bool found = false;     ///< false: nothing showed it, first_pose is taken to be right
  double turned_rad = 0;  ///< away from first_pose
  double sigma_rad = 0;   ///< 0 where not known
  double height_m = 0;    ///< of the camera above the floor, 0 where not known
  int frames = 0;         ///< that were waited for
};

/// What one frame led to.
struct SlamOutput {
  FrameResult result;
  std::vector<KeyframeChange> changes;                           ///< to be published before the result
  Eigen::Isometry3d T_map_odom = Eigen::Isometry3d::Identity();  ///< takes up the jumps of a corrected map
  std::vector<LoopClosure> loops;                                ///< closed since the last frame
  std::optional<UpFound> up;                                     ///< a map began with it; only if it was looked for
  std::uint32_t invalid_features = 0;  ///< left out because a value is not finite or out of range
  bool settling = false;               ///< TrackOutcome::settling
  std::string problem;                 ///< one line for people when the frame is not tracked; else empty
};

/// RGB-D SLAM on features: tracking, keyframes, local mapping. docs/theory/{tracking,mapping}.md.
/// process(), reset(), load_map() and the writers: one thread. map_points(), map_view(), read_map(),
/// set_localize_only(): any.
class SlamSystem {
 public:
  /// `on_mapping_thread` runs first in the mapper's thread (kThreaded only), e.g. to lower its priority.
  SlamSystem(const SlamConfig& config, MappingMode mode, Clock now_ns, std::function<void()> on_mapping_thread = {});

  /// Continues with a map that was saved, before the first frame: relocalizing until a frame is found in it.
  void restore(MapContents contents);
  /// Begins again, as after a start: the next frame makes a new map, in whose frame the poses are from then on. The
  /// odometry continues. Keyframes that were announced are removed in the next outputs, whose events count from 0
  /// again. Waits for the keyframe in work and gives up a global adjustment.
  void reset();
  /// reset(), then restore(): replaces the map while running.
  void load_map(MapContents contents);
  /// No new keyframes, landmarks, loops or maps while on; keyframes that wait for the mapper are finished. Takes effect
  /// with the next frame.
  void set_localize_only(bool on) { localize_only_ = on; }
  bool localize_only() const { return localize_only_; }
  /// Never throws for the content of the message. Frames are expected in order; a seq that jumps back means a
  /// source that started again: motion is forgotten, the map stays.
  SlamOutput process(const msg::FeatureFrame& message);
  /// What IMU and wheels measured up to the next frame, where SlamConfig::prior has them; else without effect.
  void add(const inertial::ImuSample& sample);
  void add(const WheelSample& sample);
  /// Of IMU and wheels; null where there are none.
  const MotionPrior* prior() const { return prior_ ? &*prior_ : nullptr; }
  /// Ends mapping: everything queued is worked off. The trajectories are final after it.
  /// `pending`: what happens to a global adjustment that is under way.
  void finish(PendingAdjustment pending = PendingAdjustment::kAwait) { mapping_.finish(pending); }

  /// Of one map: each has its own world frame.
  std::vector<StampedPose> trajectory(MapId id = 0) const {
    return mapping_.read([&](const Map& map) { return compose_trajectory(map, frames_, id); });
  }
  std::vector<StampedPose> keyframes(MapId id = 0) const {
    return mapping_.read([&](const Map& map) { return keyframe_trajectory(map, id); });
  }
  std::vector<MapPoint> map_points(MapId id = 0) const;
  /// What viewers show of all maps.
  MapView map_view() const;
  /// MapView::session of the map that read_map() shows. Any thread.
  std::uint64_t map_session() const { return mapping_.session(); }
  /// Of the last frame. The thread of process().
  const PoseEvidence& evidence() const { return evidence_; }
  std::vector<MapId> maps() const {
    return mapping_.read([](const Map& map) { return map.maps(); });
  }
  /// What `look` finds in the whole map: may wait for a bundle adjustment, and the mapper waits until it is done.
  auto read_map(const auto& look) const { return mapping_.read(look); }
  std::vector<LoopClosure> loops() const { return mapping_.loops(); }
  std::size_t frames_tracked() const { return frames_tracked_; }
  std::uint64_t source_restarts() const { return source_restarts_; }
  /// Of the camera, as it is undone now; 0: rows are taken to be exposed at once.
  double readout_s() const { return shutter_.readout_s; }
  /// Whether it is given, by slam.sensor.readout_s or by the frames, and not estimated.
  bool readout_given() const { return given_readout_s() != 0; }
  /// The weight of depth of the next frame, px*m: slam.sensor.disparity_px_m, or the estimate.
  double disparity_px_m() const;

 private:
  void start_tracker();
  void watch_source(const msg::FeatureFrame& message);
  TrackOutcome initialize(const FrameInput& input, SlamOutput& output);
  std::optional<FloorPlane> find_up(const Frame& frame) const;
  bool waits_for_up(const Frame& frame);
  TrackOutcome begin_map(const FrameInput& input, SlamOutput& output);
  Eigen::Isometry3d align_to_gravity(const std::optional<FloorPlane>& floor, SlamOutput& output);
  bool wants_new_map(const Frame& frame, const TrackOutcome& outcome);
  TrackOutcome track(const FrameInput& input, SlamOutput& output);
  void join(const TrackOutcome& outcome);
  void leave_odometry();
  void record(const TrackOutcome& outcome);
  double given_readout_s() const;
  ShutterMotion shutter_motion() const;
  void observe_sensor(const LocalMap& map, const TrackOutcome& outcome);
  void maybe_insert_keyframe(TrackOutcome& outcome);
  void follow_reference(const TrackOutcome& outcome);
  bool follow_map(const LocalMap& map);
  void collect_events(SlamOutput& output);
  FrameResult result_of(const msg::FeatureFrame& message, const FrameInput& input, const TrackOutcome& outcome) const;

  SlamConfig config_;
  Clock now_ns_;
  std::atomic<bool> localize_only_;
  MappingWorker mapping_;
  std::optional<MotionPrior> prior_;
  std::optional<Tracker> tracker_;  ///< another one after reset()
  UnknownViewClock unknown_view_;
  ReadoutEstimator readout_;
  DepthWeightEstimator depth_weight_;
  ShutterMotion shutter_;  ///< what the features of the frame in work were corrected with
  OdometryFrame odometry_;
  OdometryStretch stretch_;
  /// Where the place that was recognised after it shows a frame, and where odometry expected that frame.
  struct Meeting {
    Eigen::Isometry3d T_world_expected, T_world_found;
  };
  std::optional<Meeting> meeting_;
  int frames_without_up_ = 0;
  bool begun_ = false;     ///< a map, ever
  bool had_pose_ = false;  ///< the last frame
  bool placed_ = true;     ///< false: a map was taken over while running, and the camera not found in it yet
  MapId map_ = 0;          ///< component that it was tracked in
  KeyframeChangeQueue changes_;
  std::vector<FrameRecord> frames_;  ///< all of the last hours (thin_out())
  std::size_t frames_tracked_ = 0;
  DeferredFrames deferred_;
  std::uint64_t event_count_ = 0;
  std::size_t loops_reported_ = 0;
  std::uint64_t source_restarts_ = 0;
  std::optional<std::uint64_t> last_seq_;
  std::int64_t last_stamp_ns_ = 0;
  std::array<double, 4> last_intrinsics_{};
  double frame_readout_s_ = 0;  ///< of the frame in work; 0 when it does not say
  KeyframeId requested_centre_ = kNoKeyframe;
  PoseEvidence evidence_;
};

}  // namespace rtd::slam
