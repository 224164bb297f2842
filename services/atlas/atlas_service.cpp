// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/atlas/atlas_service.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "common/geometry/se3.hpp"
#include "common/msg/transform_eigen.hpp"
#include "common/service/config.hpp"
#include "common/service/metric_names.hpp"
#include "common/service/monotonic_clock.hpp"
#include "services/slam/slam_messages.hpp"

namespace rtd::atlas {
namespace {

namespace metric = service::metric;

constexpr std::chrono::milliseconds kTick{20};
constexpr std::int64_t kSecondNs = 1'000'000'000, kPublishNs = kSecondNs / 2, kPointsNs = 2 * kSecondNs,
                       kStraightenNs = kSecondNs / 2;
constexpr std::int64_t kAskAgainNs = 2 * kSecondNs;  ///< what was asked for and has not come
constexpr std::size_t kMostWaiting = 4096, kMostRobots = 200;

/// Whether a transform that has changed by so much is the same.
bool is_same(const Eigen::Isometry3d& T) {
  constexpr double kSame_m = 0.001, kSame_rad = 0.0005;
  return T.translation().norm() < kSame_m && geometry::rotation_angle_rad(T) < kSame_rad;
}

}  // namespace

void AtlasService::add_options(CLI::App& app, std::vector<service::GivenOption>&) {
  app.footer(
      "Robots need names: --robot NAME of their services. 'rtd atlas status' shows who is where.\n"
      "Commands: rtd call /atlas/save [NAME], /atlas/load NAME, /atlas/forget ROBOT.\n"
      "Example: rtd atlas --map building.rtdmap --profile lan");
}

AtlasService::AtlasService(const Config& config, service::Runtime& runtime)
    : config_(config),
      runtime_(runtime),
      atlas_(config.core),
      maps_(maps_in(config.maps_folder)),
      state_writer_(runtime.bus.writer(bus::topics::kAtlas)),
      poses_writer_(runtime.bus.writer(bus::topics::kAtlasRobots)),
      points_writer_(runtime.bus.writer(bus::topics::kAtlasPoints)),
      plan_writer_(runtime.bus.writer(bus::topics::kAtlasFloorPlan)),
      tf_writer_(runtime.bus.writer(bus::topics::kTfStatic)),
      jumps_writer_(runtime.bus.writer(bus::topics::kAtlasMapJumps)),
      server_(std::in_place, runtime.bus) {
  load_at_start();
  if (config_.robots.empty()) finder_.emplace(runtime.bus_options, bus::topics::kMap);
  for (const std::string& robot : config_.robots) bus::require_robot_name(robot);
  using bus::CommandKind;
  using bus::CommandRequest;
  server_->offer("atlas/save", CommandKind::kText,
                 [this](const CommandRequest& r) { return save_by_command(r.argument); });
  server_->offer("atlas/load", CommandKind::kText,
                 [this](const CommandRequest& r) { return load_by_command(r.argument); });
  server_->offer("atlas/forget", CommandKind::kText, [this](const CommandRequest& r) { return forget(r.argument); });
}

/// Readers end first: their callbacks use the rest.
AtlasService::~AtlasService() {
  server_.reset();
  lanes_.clear();
}

service::ExitCode AtlasService::run() {
  checkpoint_ns_ = service::monotonic_ns();
  while (!runtime_.stop.wait_for(kTick)) {
    runtime_.heartbeat.tick();
    find_robots();
    for (const Arrival& arrival : take_arrivals()) take(arrival);
    straighten();
    for (auto& [robot, lane] : lanes_) ask(robot, lane);
    server_->serve();
    publish();
    checkpoint();
  }
  return finish();
}

void AtlasService::push(const std::string& robot, Message message) {
  const std::lock_guard lock(mutex_);
  if (arrivals_.size() >= kMostWaiting) {
    ++dropped_;
    if (!std::holds_alternative<Update>(message)) return;  // it is asked for again, or comes again
    arrivals_.pop_front();
  }
  arrivals_.push_back({robot, std::move(message)});
}

std::deque<AtlasService::Arrival> AtlasService::take_arrivals() {
  const std::lock_guard lock(mutex_);
  return std::exchange(arrivals_, {});
}

void AtlasService::find_robots() {
  const std::set<std::string> robots =
      finder_ ? finder_->robots() : std::set<std::string>(config_.robots.begin(), config_.robots.end());
  for (const std::string& robot : robots) {
    if (lanes_.contains(robot) || forgotten_.contains(robot) || lanes_.size() >= kMostRobots) continue;
    try {
      open_lane(robot);
      SPDLOG_INFO("event=robot_found robot=\"{}\"", robot);
    } catch (const bus::BusError& error) {
      if (robot_log_.pass()) SPDLOG_WARN("event=robot_refused robot=\"{}\" cause=\"{}\"", robot, error.what());
    }
  }
}

void AtlasService::open_lane(const std::string& robot) {
  Lane lane;
  lane.bus = runtime_.bus.of_robot(robot);
  lane.requests = lane.bus->writer(bus::topics::kKeyframeRequest);
  lane.submaps = lane.bus->writer(bus::topics::kSubmap);
  lane.features = lane.bus->reader(bus::topics::kKeyframeFeatures,
                                   [this, robot](Features message) { push(robot, std::move(message)); });
  lane.updates =
      lane.bus->reader(bus::topics::kMap, [this, robot](Update message) { push(robot, std::move(message)); });
  lanes_.emplace(robot, std::move(lane));
}

/// What a robot sent before it was forgotten does not count any more.
void AtlasService::take(const Arrival& arrival) {
  const auto lane = lanes_.find(arrival.robot);
  if (lane == lanes_.end()) return;
  if (const auto* update = std::get_if<Update>(&arrival.message)) {
    atlas_->follow(arrival.robot, **update, service::realtime_ns());
    return;
  }
  if (const auto* plan = std::get_if<Plan>(&arrival.message)) {
    floor_plans_.take(arrival.robot, *plan);
    return;
  }
  const msg::KeyframeFeatures& features = *std::get<Features>(arrival.message);
  if (features.keyframe_id == msg::kNoId) {
    answer_query(arrival.robot, lane->second, features);
    return;
  }
  const std::uint64_t meetings = atlas_->counters().meetings;
  if (atlas_->add(arrival.robot, features) && lane->second.waiting_for > 0) --lane->second.waiting_for;
  if (atlas_->counters().meetings > meetings) SPDLOG_INFO("event=meeting robot=\"{}\"", arrival.robot);
  report_refusal("the place is there twice");
}

/// Meetings that were taken back since the last call.
void AtlasService::report_refusal(const char* cause) {
  const std::uint64_t before = std::exchange(refused_, atlas_->counters().refused);
  if (refused_ > before) SPDLOG_WARN("event=meeting_refused cause=\"{}\"", cause);
}

/// More only once the last have come, or do not come.
void AtlasService::ask(const std::string& robot, Lane& lane) {
  const std::int64_t now_ns = service::monotonic_ns();
  if (now_ns - lane.asked_ns < (lane.waiting_for > 0 ? kAskAgainNs : kPublishNs)) return;
  lane.asked_ns = now_ns;
  const msg::KeyframeRequest request = atlas_->missing(robot, static_cast<std::size_t>(config_.request_keyframes));
  lane.waiting_for = request.keyframe_ids.size();
  if (lane.waiting_for > 0) lane.requests.write(request);
}

void AtlasService::answer_query(const std::string& robot, Lane& lane, const msg::KeyframeFeatures& query) {
  ++asked_where_;
  const std::optional<msg::Submap> submap = atlas_->locate(query);
  if (!submap) return;
  ++located_;
  lane.submaps.write(*submap);
  if (query_log_.pass()) SPDLOG_INFO("event=located robot=\"{}\" submap_bytes={}", robot, submap->file.size());
}

void AtlasService::straighten() {
  const std::int64_t now_ns = service::monotonic_ns();
  if (now_ns - straightened_ns_ < kStraightenNs) return;
  atlas_->straighten();
  straightened_ns_ = service::monotonic_ns();
  report_refusal("it contradicts what other robots have measured");
}

void AtlasService::publish() {
  const std::int64_t now_ns = service::monotonic_ns();
  if (now_ns - published_ns_ < kPublishNs) return;
  published_ns_ = now_ns;
  msg::AtlasState state = atlas_->state();
  state.stamp_ns = service::realtime_ns();
  state_writer_.write(state);
  msg::PoseArray poses;
  poses.header = {msg::to_time(state.stamp_ns), config_.map_frame};
  for (const msg::AtlasRobot& robot : state.robots) {
    if (robot.met) poses.poses.push_back(slam::to_pose(robot.T_map_camera));
  }
  poses_writer_.write(poses);
  publish_transforms(state);
  publish_points();
  publish_floor_plan();
  report(state);
}

/// One message with all of them whenever one changes: a late reader gets the newest message. A robot that has not met,
/// or no more, as its map is another, has none.
void AtlasService::publish_transforms(const msg::AtlasState& state) {
  bool changed = false;
  for (const msg::AtlasRobot& robot : state.robots) {
    if (robot.name.empty()) continue;
    if (!robot.met) {
      changed = transforms_.erase(robot.name) > 0 || changed;
      continue;
    }
    const auto before = transforms_.find(robot.name);
    if (before != transforms_.end()) {
      const Eigen::Isometry3d T_map_robot = msg::to_isometry(robot.T_map_robot);
      const Eigen::Isometry3d T_robot_before = msg::to_isometry(before->second).inverse();
      if (is_same(T_robot_before * T_map_robot)) continue;
      jumps_writer_.write(slam::make_transform(state.stamp_ns, config_.map_frame,
                                               bus::frame_of_robot("map", robot.name),
                                               msg::to_message(geometry::normalized(T_map_robot * T_robot_before))));
    }
    transforms_[robot.name] = robot.T_map_robot;
    changed = true;
  }
  if (!changed) return;
  msg::TFMessage message;
  for (const auto& [robot, T_map_robot] : transforms_)
    message.transforms.push_back(
        slam::make_transform(state.stamp_ns, config_.map_frame, bus::frame_of_robot("map", robot), T_map_robot));
  tf_writer_.write(message);
}

void AtlasService::publish_points() {
  const std::int64_t now_ns = service::monotonic_ns();
  if (points_writer_.matched() == 0 || now_ns - points_ns_ < kPointsNs || shown_ == atlas_->revision()) return;
  points_ns_ = now_ns;
  shown_ = atlas_->revision();
  points_writer_.write(slam::make_cloud(atlas_->points(), service::realtime_ns(), config_.map_frame));
}

/// Robots make theirs only while there is a reader.
void AtlasService::read_floor_plan(const std::string& robot, Lane& lane, bool wanted) {
  if (wanted == static_cast<bool>(lane.plans)) return;
  lane.plans = {};
  if (!wanted) return;
  try {
    lane.plans =
        lane.bus->reader(bus::topics::kOccupancyGrid, [this, robot](Plan plan) { push(robot, std::move(plan)); });
  } catch (const bus::BusError& error) {  // a keystore of an earlier version
    if (robot_log_.pass()) SPDLOG_WARN("event=no_floor_plan robot=\"{}\" cause=\"{}\"", robot, error.what());
  }
}

void AtlasService::publish_floor_plan() {
  const bool wanted = plan_writer_.matched() > 0;
  for (auto& [robot, lane] : lanes_) read_floor_plan(robot, lane, wanted);
  const std::int64_t now_ns = service::monotonic_ns();
  if (!wanted || now_ns - plan_ns_ < kPointsNs) return;
  plan_ns_ = now_ns;
  if (const auto plan = floor_plans_.join(transforms_, service::realtime_ns(), config_.map_frame))
    plan_writer_.write(*plan);
}

void AtlasService::report(const msg::AtlasState& state) {
  const auto met = std::ranges::count_if(state.robots, &msg::AtlasRobot::met);
  service::Heartbeat& heartbeat = runtime_.heartbeat;
  heartbeat.set_metric(metric::kRobots, static_cast<double>(state.robots.size()));
  heartbeat.set_metric(metric::kRobotsMet, static_cast<double>(met));
  heartbeat.set_metric(metric::kKeyframes, static_cast<double>(atlas_->map().keyframes().size()));
  heartbeat.set_metric(metric::kLandmarks, static_cast<double>(atlas_->map().landmark_count()));
  heartbeat.set_metric(metric::kMeetings, static_cast<double>(atlas_->counters().meetings));
  heartbeat.set_metric(metric::kMeetingsRefused, static_cast<double>(atlas_->counters().refused));
  heartbeat.set_metric(metric::kCorrections, static_cast<double>(atlas_->counters().corrections));
  heartbeat.set_metric(metric::kLocated, static_cast<double>(located_));
  heartbeat.set_metric(metric::kAskedWhere, static_cast<double>(asked_where_));
  const std::string message = fmt::format("{} of {} robots in the joint map", met, state.robots.size());
  if (!trouble_.empty()) {
    heartbeat.set_state(msg::ServiceState::kDegraded, trouble_);
  } else {
    heartbeat.set_state(state.robots.empty() ? msg::ServiceState::kReady : msg::ServiceState::kRunning, message);
  }
}

bus::CommandAnswer AtlasService::forget(const std::string& robot) {
  const std::size_t gone = atlas_->forget(robot);
  if (gone == 0) return {false, "no keyframe of a robot \"" + robot + "\" is in the joint map"};
  lanes_.erase(robot);
  transforms_.erase(robot);
  floor_plans_.forget(robot);
  forgotten_.insert(robot);
  SPDLOG_INFO("event=robot_forgotten robot=\"{}\" keyframes={}", robot, gone);
  return {true, fmt::format("{} keyframes of {} forgotten; it is ignored until atlas is started again", gone, robot)};
}

service::ExitCode AtlasService::finish() {
  server_->close();
  save_changes();
  const AtlasCounters& counters = atlas_->counters();
  SPDLOG_INFO("event=summary keyframes={} meetings={} refused={} corrections={} located={} dropped={}",
              counters.keyframes, counters.meetings, counters.refused, counters.corrections, located_, dropped_);
  return trouble_.empty() ? service::kOk : service::kRunFailed;
}

}  // namespace rtd::atlas
