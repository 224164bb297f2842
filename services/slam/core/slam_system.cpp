// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/slam_system.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "common/msg/stamps.hpp"

namespace rtd::slam {

SlamSystem::SlamSystem(const SlamConfig& config, MappingMode mode, Clock now_ns,
                       std::function<void()> on_mapping_thread)
    : config_(config),
      now_ns_(std::move(now_ns)),
      localize_only_(config.localize_only),
      mapping_(config, mode, std::move(on_mapping_thread)),
      odometry_(config.loop) {
  if (config.prior.given()) prior_.emplace(config);
  start_tracker();
}

void SlamSystem::start_tracker() {
  if (prior_) prior_->forget_world();
  tracker_.emplace(
      config_, now_ns_,
      [this](const FramePtr& frame, std::size_t attempt) { return mapping_.places_like(frame, attempt); },
      prior_ ? &*prior_ : nullptr);
}

void SlamSystem::add(const inertial::ImuSample& sample) {
  if (prior_) prior_->add(sample);
}

void SlamSystem::add(const WheelSample& sample) {
  if (prior_) prior_->add(sample);
}

void SlamSystem::reset() {
  odometry_.correct(tracker_->T_world_camera(), config_.first_pose);  // another world, the same odometry
  mapping_.restart();
  start_tracker();
  unknown_view_.reset();
  readout_ = {};
  depth_weight_ = DepthWeightEstimator();
  shutter_ = {};
  had_pose_ = false;
  placed_ = true;
  map_ = 0;
  frames_.clear();
  deferred_ = {};
  leave_odometry();
  frames_tracked_ = 0;
  changes_ = {};
  event_count_ = 0;
  loops_reported_ = 0;
  requested_centre_ = kNoKeyframe;
  frames_without_up_ = 0;
}

void SlamSystem::load_map(MapContents contents) {
  reset();
  restore(std::move(contents));
  placed_ = false;
}

void SlamSystem::restore(MapContents contents) {
  if (!contents.keyframes.empty()) {
    const Frame& last = *contents.keyframes.back().frame;
    depth_weight_ = DepthWeightEstimator(last.camera.disparity_px_m);
    readout_ = ReadoutEstimator(last.readout_s);
  }
  mapping_.restore(std::move(contents));
  tracker_->await_relocalization();
}

SlamOutput SlamSystem::process(const msg::FeatureFrame& message) {
  const std::int64_t start_ns = now_ns_();
  SlamOutput output;
  watch_source(message);
  shutter_ = shutter_motion();
  SensorConfig sensor = config_.sensor;
  sensor.disparity_px_m = disparity_px_m();
  const FrameInput input = make_frame(message, sensor, shutter_);
  output.invalid_features = input.invalid;
  evidence_ = {};
  const TrackOutcome outcome = mapping_.snapshot() == nullptr ? initialize(input, output) : track(input, output);
  evidence_.raster_scale = msg::feature_scale(message.width, message.height);
  had_pose_ = msg::has_pose(outcome.state);
  if (outcome.map != nullptr) map_ = outcome.map->map;
  output.settling = outcome.settling;
  collect_events(output);
  output.T_map_odom = odometry_.T_map_odom();
  output.result = result_of(message, input, outcome);
  output.result.stage_ms[msg::kStageSlamTotal] = to_ms(now_ns_() - start_ns);
  return output;
}

/// A source that starts again, or another camera, shows in seq, stamp or intrinsics.
void SlamSystem::watch_source(const msg::FeatureFrame& message) {
  if (last_seq_ &&
      (message.seq <= *last_seq_ || message.stamp_ns <= last_stamp_ns_ || message.intrinsics != last_intrinsics_)) {
    ++source_restarts_;
    tracker_->forget_motion();
    if (prior_) prior_->restart();
    if (message.intrinsics != last_intrinsics_) {  // another camera, or another mode of the same
      readout_ = {};
      depth_weight_ = DepthWeightEstimator();
    }
  }
  last_seq_ = message.seq;
  last_stamp_ns_ = message.stamp_ns;
  last_intrinsics_ = message.intrinsics;
  frame_readout_s_ = msg::is_sensor_time(message.readout_s) ? message.readout_s : 0;
}

TrackOutcome SlamSystem::initialize(const FrameInput& input, SlamOutput& output) {
  if (input.frame == nullptr) {
    output.problem = input.error;
    return {};
  }
  if (localize_only_) {
    output.problem = "initializing: localize_only is on and there is no map: load one, or switch it off";
    return {};
  }
  if (!tracker_->can_initialize(*input.frame)) {
    output.problem =
        "initializing: fewer than " + std::to_string(config_.tracker.min_initial_points) + " features with depth";
    return {};
  }
  if (waits_for_up(*input.frame)) {
    output.problem = "initializing: looks for what is up";
    return {};
  }
  return begin_map(input, output);
}

/// Only the first map waits: later ones begin at once, with what their first frame shows.
bool SlamSystem::waits_for_up(const Frame& frame) {
  if (config_.gravity == Gravity::kLevel || frames_without_up_ >= config_.gravity_wait_frames || find_up(frame))
    return false;
  ++frames_without_up_;
  return true;
}

/// What is up in the camera; the height above the floor only where a floor shows it.
std::optional<FloorPlane> SlamSystem::find_up(const Frame& frame) const {
  if (config_.gravity == Gravity::kImu) {
    const auto up_camera = prior_ ? prior_->up_in_camera() : std::nullopt;
    if (!up_camera) return std::nullopt;
    return FloorPlane{*up_camera, 0, config_.imu.accel_bias_m_s2 / config_.imu.gravity_m_s2};
  }
  return find_floor(frame.unproject_all(), config_.first_pose.linear().transpose() * Eigen::Vector3d::UnitZ(),
                    config_.sensor.calibration_error);
}

/// T_world_camera of the first frame of a map.
Eigen::Isometry3d SlamSystem::align_to_gravity(const std::optional<FloorPlane>& floor, SlamOutput& output) {
  output.up = UpFound{floor.has_value(), 0, 0, 0, frames_without_up_};
  if (!floor) return config_.first_pose;
  const Eigen::AngleAxisd turn(
      Eigen::Quaterniond::FromTwoVectors(config_.first_pose.linear() * floor->up_camera, Eigen::Vector3d::UnitZ()));
  output.up->turned_rad = turn.angle();
  output.up->sigma_rad = floor->sigma_rad;
  output.up->height_m = floor->height_m;
  return turn * config_.first_pose;
}

TrackOutcome SlamSystem::begin_map(const FrameInput& input, SlamOutput& output) {
  const std::int64_t start_ns = now_ns_();
  Eigen::Isometry3d first_pose = config_.first_pose;
  if (config_.gravity != Gravity::kLevel) {
    first_pose = align_to_gravity(find_up(*input.frame), output);
    tracker_->set_first_pose(first_pose);
  }
  KeyframeProposal first;
  first.frame = input.frame;
  first.landmarks.assign(input.frame->features.size(), kNoLandmark);
  first.T_reference_camera = first_pose;
  const bool first_map = mapping_.snapshot() == nullptr;
  const Eigen::Isometry3d given_or_found = std::exchange(begun_, true) ? config_.first_pose : first_pose;
  const Eigen::Isometry3d before = first_map ? given_or_found : tracker_->T_world_camera();
  TrackOutcome outcome = tracker_->initialize(input.frame, mapping_.begin_map(std::move(first)));
  odometry_.correct(before, tracker_->T_world_camera());  // another world, the same odometry
  leave_odometry();
  output.problem = problem_of(outcome, config_.tracker.min_inliers);
  requested_centre_ = outcome.tracked.reference;
  unknown_view_.reset();
  outcome.stage_ms[msg::kStageMapping] = to_ms(now_ns_() - start_ns);
  record(outcome);
  return outcome;
}

TrackOutcome SlamSystem::track(const FrameInput& input, SlamOutput& output) {
  if (input.frame == nullptr) {
    output.problem = input.error;
    TrackOutcome outcome;
    outcome.state = tracker_->located() ? msg::TrackingState::kRecentlyLost : msg::TrackingState::kRelocalizing;
    return outcome;
  }
  const LocalMapPtr snapshot = mapping_.snapshot();
  follow_map(*snapshot);
  const Eigen::Isometry3d before = tracker_->T_world_camera();
  TrackOutcome outcome = tracker_->track(input.frame, snapshot);
  if (wants_new_map(*input.frame, outcome)) return begin_map(input, output);
  output.problem = problem_of(outcome, config_.tracker.min_inliers);
  join(outcome);
  if (outcome.at_place()) {
    follow_reference(outcome);
    return outcome;
  }
  if (!msg::is_measured(outcome.state)) {
    if (outcome.tracked.frame != nullptr) record(outcome);
    return outcome;
  }
  evidence_ = {outcome.tracked.frame, outcome.tracked.T_world_camera, outcome.inliers, std::move(outcome.rejected)};
  record(outcome);
  deferred_.add(outcome.tracked, *outcome.map, {config_, now_ns_}, frames_);
  if (prior_) correct_frames(prior_->take_corrections(), frames_);
  if (!std::exchange(placed_, true)) {
    odometry_.correct(config_.first_pose, tracker_->T_world_camera());  // which reset() has tied it to
  } else if (!had_pose_ && outcome.map->map != map_) {
    odometry_.correct(before, tracker_->T_world_camera());
  }
  observe_sensor(*outcome.map, outcome);
  maybe_insert_keyframe(outcome);
  // This very frame may have closed a loop: its pose is then that in the corrected map.
  if (const LocalMapPtr corrected = mapping_.snapshot(); follow_map(*corrected)) {
    outcome.tracked.T_world_camera = tracker_->T_world_camera();
    outcome.map = corrected;
  }
  return outcome;
}

/// Odometry continues next to an old map, or has just met it again, or is over.
void SlamSystem::join(const TrackOutcome& outcome) {
  using State = msg::TrackingState;
  const bool found = outcome.at_place() || (msg::is_measured(outcome.state) && !outcome.apart);
  if (found && outcome.T_world_expected && outcome.map->map == map_)
    meeting_ = Meeting{*outcome.T_world_expected, outcome.tracked.T_world_camera};
  if (outcome.apart) stretch_.add(outcome.tracked.frame->seq, outcome.tracked.T_world_camera);
  if (outcome.apart || outcome.at_place() || outcome.state == State::kPredicted) return;
  if (meeting_ && msg::is_measured(outcome.state)) {
    correct_frames(stretch_.spread(meeting_->T_world_expected, meeting_->T_world_found), frames_);
    odometry_.correct(meeting_->T_world_expected, meeting_->T_world_found);
  }
  leave_odometry();
}

void SlamSystem::leave_odometry() {
  stretch_.clear();
  meeting_.reset();
}

void SlamSystem::record(const TrackOutcome& outcome) {
  constexpr std::size_t kMaxFrames = 200'000;  // two hours at 30 Hz, 32 MB
  constexpr std::size_t kTidyEvery = 20'000;   // frames
  ++frames_tracked_;
  thin_out(frames_, kMaxFrames);
  if (frames_tracked_ % kTidyEvery == 0) {
    mapping_.forget_removed([this](const Map& map) { tie_to_living(frames_, map); });
  }
  const TrackedFrame& tracked = outcome.tracked;
  frames_.push_back({tracked.frame->seq, tracked.frame->stamp_ns, tracked.reference, tracked.T_reference_camera,
                     outcome.state == msg::TrackingState::kDoubtful});
}

/// The configured value wins; 0 when neither configuration nor frame says.
double SlamSystem::given_readout_s() const {
  return config_.sensor.readout_s != 0 ? config_.sensor.readout_s : frame_readout_s_;
}

/// The motion during the next frame, as the last ones let expect.
ShutterMotion SlamSystem::shutter_motion() const {
  if (!config_.techniques.rolling_shutter || !tracker_->motion()) return {};
  return {tracker_->motion()->velocity_per_s, readout_given() ? given_readout_s() : readout_.readout_s()};
}

double SlamSystem::disparity_px_m() const {
  return config_.sensor.disparity_px_m > 0 ? config_.sensor.disparity_px_m : depth_weight_.disparity_px_m();
}

void SlamSystem::observe_sensor(const LocalMap& map, const TrackOutcome& outcome) {
  const bool wants_weight = config_.sensor.disparity_px_m == 0;
  const bool wants_readout =
      config_.techniques.rolling_shutter && !readout_given() && !shutter_.velocity_per_s.isZero(0);
  if (!wants_weight && !wants_readout) return;
  std::vector<Association> points;
  for (std::uint32_t i = 0; i < outcome.tracked.landmarks.size(); ++i) {
    const LandmarkId id = outcome.tracked.landmarks[i];
    const LocalLandmark* landmark = id == kNoLandmark ? nullptr : map.find_landmark(id);
    if (landmark != nullptr) points.push_back({i, id, landmark->position});
  }
  const TrackedFrame& tracked = outcome.tracked;
  if (wants_weight) depth_weight_.add(*tracked.frame, tracked.T_world_camera, points);
  if (wants_readout) readout_.add(*tracked.frame, tracked.T_world_camera, points, map, shutter_);
}

/// Lost for long, with unknown views: the camera continues in a new map.
bool SlamSystem::wants_new_map(const Frame& frame, const TrackOutcome& outcome) {
  if (localize_only_ || msg::has_pose(outcome.state) || outcome.at_place()) {
    unknown_view_.reset();
    return false;
  }
  const double unknown_s = unknown_view_.observe(frame.stamp_ns, tracker_->can_initialize(frame));
  return config_.place.new_map_after_s > 0 && unknown_s >= config_.place.new_map_after_s;
}

void SlamSystem::maybe_insert_keyframe(TrackOutcome& outcome) {
  const std::int64_t start_ns = now_ns_();
  const KeyframeSituation situation = tracker_->keyframe_situation(*outcome.map, mapping_.idle());
  const bool insert = !localize_only_ && wants_keyframe(situation, config_.keyframe) && mapping_.room();
  outcome.stage_ms[msg::kStageKeyframe] = to_ms(now_ns_() - start_ns);
  const std::int64_t mapping_start_ns = now_ns_();
  if (insert) {
    mapping_.insert(tracker_->propose_keyframe());
    requested_centre_ = kNoKeyframe;
  } else {
    follow_reference(outcome);
  }
  outcome.stage_ms[msg::kStageMapping] = to_ms(now_ns_() - mapping_start_ns);
}

/// Snapshots are to be taken around the keyframe that the camera is near.
void SlamSystem::follow_reference(const TrackOutcome& outcome) {
  const KeyframeId reference = outcome.tracked.reference;
  const bool followed = reference == mapping_.snapshot()->keyframes.front().id;
  if (followed || reference == requested_centre_) return;
  requested_centre_ = reference;
  mapping_.recentre(reference);
}

/// The map may have been corrected under the camera: the jump is added to map -> odom. True when there was one.
bool SlamSystem::follow_map(const LocalMap& map) {
  const Eigen::Isometry3d before = tracker_->T_world_camera();
  tracker_->adopt(map);
  return odometry_.correct(before, tracker_->T_world_camera());
}

void SlamSystem::collect_events(SlamOutput& output) {
  constexpr std::size_t kMaxChanges = 48;  // of one frame; readers of rtd/keyframes keep 64
  output.loops = mapping_.loops(loops_reported_);
  loops_reported_ += output.loops.size();
  changes_.add(mapping_.take_changes());
  output.changes = changes_.take(kMaxChanges);
  event_count_ += output.changes.size();
}

FrameResult SlamSystem::result_of(const msg::FeatureFrame& message, const FrameInput& input,
                                  const TrackOutcome& outcome) const {
  FrameResult result;
  result.seq = message.seq;
  result.stamp_ns = message.stamp_ns;
  if (msg::has_pose(outcome.state)) result.T_world_camera = outcome.tracked.T_world_camera;
  result.covariance = outcome.covariance;
  result.event_count = event_count_;
  result.state = outcome.state;
  result.inliers = static_cast<std::uint32_t>(outcome.inliers);
  if (msg::is_measured(outcome.state)) result.agreement = outcome.consistency;
  result.features_static = input.frame == nullptr ? 0 : static_cast<std::uint32_t>(input.frame->features.size());
  result.features_removed = input.removed;
  result.stage_ms = outcome.stage_ms;
  if (const LocalMapPtr map = mapping_.snapshot()) {
    result.keyframes = static_cast<std::uint32_t>(map->map_keyframes);
    result.landmarks = static_cast<std::uint32_t>(map->map_landmarks);
    result.map_id = (outcome.map != nullptr ? outcome.map : map)->map;
    result.maps = static_cast<std::uint32_t>(map->components);
  }
  return result;
}

std::vector<MapPoint> SlamSystem::map_points(MapId id) const {
  constexpr std::size_t kPortion = 20'000;  // 2 ms: the mapper waits no longer
  const std::vector<LandmarkId> ids = read_map([](const Map& map) { return map.landmark_ids(); });
  std::vector<MapPoint> points;
  points.reserve(ids.size());
  for (std::size_t begin = 0; begin < ids.size(); begin += kPortion) {
    const auto portion = std::span(ids).subspan(begin, std::min(kPortion, ids.size() - begin));
    read_map([&](const Map& map) { append_map_points(map, id, portion, points); });
  }
  return points;
}

MapView SlamSystem::map_view() const {
  while (true) {
    const std::uint64_t session = map_session();
    MapView view = copy_view([this](const auto& look) { read_map(look); });
    view.session = session;
    if (map_session() == session) return view;  // else it may be of two maps
  }
}

}  // namespace rtd::slam
