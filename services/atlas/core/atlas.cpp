// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/atlas/core/atlas.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <ranges>

#include "common/geometry/se3.hpp"
#include "common/msg/transform_eigen.hpp"
#include "services/atlas/core/submap.hpp"

namespace rtd::atlas {

using slam::Keyframe;
using slam::kNoKeyframe;
using slam::kNoLandmark;
using slam::Landmark;

namespace {

/// What a robot sees as one of its landmarks lies no farther from it than this, unless the map it belongs to is
/// another.
constexpr double kSameLandmark_m = 0.3;

/// How a robot's map drifts away from the joint map on the way since their last meeting.
constexpr double kDrift = 0.01, kDriftRadPerM = 0.002;

}  // namespace

Atlas::Atlas(AtlasConfig config)
    : config_(std::move(config)),
      vocabulary_(config_.slam.place.vocabulary ? config_.slam.place.vocabulary : slam::built_in_vocabulary()) {}

void Atlas::restore(slam::MapContents contents, const std::map<std::string, std::vector<KeyframeId>>& owners) {
  map_ = slam::Map(std::move(contents));
  for (const MapId component : map_.maps()) worlds_[component] = component;
  for (const auto& [id, keyframe] : map_.keyframes()) {
    places_.add(id, vocabulary_->describe(keyframe.frame->features));
    sources_[id] = {};
    by_stamp_.emplace(keyframe.frame->stamp_ns, id);
  }
  for (const auto& [robot, keyframes] : owners)
    for (const KeyframeId id : keyframes)
      if (const auto source = sources_.find(id); source != sources_.end()) source->second.robot = robot;
  sort_into_cells();
}

slam::MapContents Atlas::contents() const {
  std::vector<KeyframeId> keyframes;
  for (const auto& [id, keyframe] : map_.keyframes())
    if (is_joined(id)) keyframes.push_back(id);
  return take_part(map_, keyframes, KeptFeatures::kAll);
}

std::map<std::string, std::vector<KeyframeId>> Atlas::owners() const {
  std::map<std::string, std::vector<KeyframeId>> owners;
  for (const auto& [id, source] : sources_) owners[source.robot].push_back(id);
  return owners;
}

bool Atlas::is_joined(KeyframeId keyframe) const {
  return !worlds_.empty() && world_of(keyframe) == worlds_.begin()->second;
}

bool Atlas::add(const std::string& name, const msg::KeyframeFeatures& message) {
  const auto found = robots_.find(name);
  if (found == robots_.end() || message.session_ns != found->second.session_ns) return false;
  Robot& robot = found->second;
  const auto own = robot.keyframes.find(message.keyframe_id);
  if (own == robot.keyframes.end() || own->second.stamp_ns != message.stamp_ns) return false;
  Announced& announced = own->second;
  if (map_.find_keyframe(announced.keyframe) != nullptr) return false;
  std::vector<std::uint32_t> kept;
  const slam::FramePtr frame = to_frame(message, kept);
  if (frame == nullptr) {
    ++counters_.broken;
    return false;
  }
  if (settle_claim(name, robot, message.keyframe_id, *frame)) return true;
  const Announced* parent = choose_parent(robot, message.keyframe_id);
  Eigen::Isometry3d T_world_camera = announced.T_robot_camera;
  if (parent != nullptr) {
    const Eigen::Isometry3d T_parent_camera = parent->T_robot_camera.inverse() * announced.T_robot_camera;
    T_world_camera = geometry::normalized(map_.find_keyframe(parent->keyframe)->T_world_camera * T_parent_camera);
    robot.way_m += T_parent_camera.translation().norm();
  }
  announced.keyframe = map_.add_keyframe(frame, T_world_camera, parent == nullptr ? kNoKeyframe : parent->keyframe);
  const Keyframe& keyframe = *map_.find_keyframe(announced.keyframe);
  worlds_.try_emplace(keyframe.map, keyframe.map);
  sources_[keyframe.id] = {name, message.keyframe_id, robot.behind_s};
  robot.here.insert(message.keyframe_id);
  robot.wanted.erase(message.keyframe_id);
  by_stamp_.emplace(message.stamp_ns, keyframe.id);
  places_.add(keyframe.id, vocabulary_->describe(frame->features));
  for (std::uint32_t i = 0; i < kept.size(); ++i)
    see_landmark(robot, keyframe, i, message.features[kept[i]].landmark_id);
  for (const LandmarkId id : keyframe.landmarks)
    if (id != kNoLandmark) map_.refresh_landmark(id);
  forget_landmarks(robot);
  ++counters_.keyframes;
  ++revision_;
  cells_[cell_of(worlds_.at(keyframe.map), T_world_camera)].push_back(keyframe.id);
  look_for_meeting(name, robot, keyframe.id);
  give_way(keyframe.id);
  return true;
}

/// Those that live no more: else an hour of keyframes would leave hundreds of megabytes of them.
void Atlas::forget_landmarks(Robot& robot) const {
  constexpr std::size_t kFew = 10'000;
  if (robot.landmarks.size() < 2 * robot.living_landmarks + kFew) return;
  std::erase_if(robot.landmarks, [&](const auto& entry) { return map_.find_landmark(entry.second) == nullptr; });
  robot.living_landmarks = robot.landmarks.size();
}

void Atlas::see_landmark(Robot& robot, const Keyframe& keyframe, std::uint32_t feature, std::uint32_t robot_id) {
  if (robot_id == msg::kNoId || !(keyframe.frame->features[feature].depth_m > 0)) return;
  const Eigen::Vector3d p_world = keyframe.T_world_camera * keyframe.frame->unproject(feature);
  const auto [it, is_new] = robot.landmarks.try_emplace(robot_id, kNoLandmark);
  const Landmark* landmark = map_.find_landmark(it->second);
  if (landmark != nullptr && (landmark->position - p_world).norm() < kSameLandmark_m) {
    map_.add_observation(it->second, {keyframe.id, feature});
  } else {
    it->second = map_.add_landmark(p_world, {keyframe.id, feature});
    map_.find_landmark(it->second)->witness = true;
  }
}

Atlas::Cell Atlas::cell_of(MapId world, const Eigen::Isometry3d& T_world_camera) const {
  constexpr double kSectors = 8;     // of viewing directions, each way round
  constexpr double kFarthest = 1e9;  // what robots send adds up
  const auto part = [&](double value, double size) {
    return static_cast<int>(std::clamp(std::floor(value / size), -kFarthest, kFarthest));
  };
  const Eigen::Vector3d place = T_world_camera.translation(), view = T_world_camera.linear().col(2);
  constexpr double kSector_rad = 2 * std::numbers::pi / kSectors;
  return {static_cast<int>(world),
          part(place.x(), config_.cell_m),
          part(place.y(), config_.cell_m),
          part(place.z(), config_.cell_m),
          part(std::atan2(view.y(), view.x()), kSector_rad),
          part(std::acos(std::clamp(view.z(), -1.0, 1.0)), kSector_rad)};
}

void Atlas::sort_into_cells() {
  cells_.clear();
  for (const auto& [id, keyframe] : map_.keyframes())
    cells_[cell_of(world_of(id), keyframe.T_world_camera)].push_back(id);
}

/// Of a robot that is there, the last keyframes never go, whoever else comes by: they say where its map is.
bool Atlas::may_go(KeyframeId id) const {
  constexpr std::size_t kLast = 3;
  const auto robot = robots_.find(sources_.at(id).robot);
  return robot == robots_.end() || robot->second.here.size() > kLast;
}

/// Of one place the newest keyframes stay: what was there before has changed, or is said once more.
void Atlas::give_way(KeyframeId newest) {
  const Keyframe& keyframe = *map_.find_keyframe(newest);
  const std::vector<KeyframeId>& cell = cells_[cell_of(worlds_.at(keyframe.map), keyframe.T_world_camera)];
  std::vector<std::pair<double, KeyframeId>> oldest;
  std::size_t too_many = 0;
  const auto most = static_cast<std::size_t>(config_.most_keyframes);
  if (sources_.size() > most) {
    too_many = sources_.size() - most + most / 100;  // at once: to find them takes long
    for (const auto& [id, source] : sources_) oldest.emplace_back(seen_s(id), id);
  } else if (cell.size() > static_cast<std::size_t>(config_.cell_keyframes)) {
    too_many = cell.size() - static_cast<std::size_t>(config_.cell_keyframes);  // more where worlds were joined
    for (const KeyframeId id : cell) oldest.emplace_back(seen_s(id), id);
  }
  std::ranges::sort(oldest);
  for (const auto& [seen_s, id] : oldest) {
    if (too_many == 0) break;
    if (!may_go(id)) continue;
    drop(id);
    --too_many;
    ++counters_.given_way;
  }
}

/// What met a keyframe that goes has met its heir.
void Atlas::hand_on_meetings(std::vector<Meeting>& meetings, KeyframeId id, KeyframeId heir) const {
  Eigen::Isometry3d T_heir_keyframe = Eigen::Isometry3d::Identity();
  if (heir != kNoKeyframe)
    T_heir_keyframe = map_.find_keyframe(heir)->T_world_camera.inverse() * map_.find_keyframe(id)->T_world_camera;
  for (Meeting& meeting : meetings) {
    if (meeting.place == id) {
      meeting.place = heir;
      meeting.T_place_keyframe = T_heir_keyframe * meeting.T_place_keyframe;
    } else if (meeting.keyframe == id) {
      meeting.keyframe = heir;
      const geometry::Matrix6d Ad = geometry::adjoint(T_heir_keyframe);
      meeting.covariance = Ad * meeting.covariance * Ad.transpose();
      meeting.T_place_keyframe = meeting.T_place_keyframe * T_heir_keyframe.inverse();
    }
  }
  std::erase_if(meetings, [](const Meeting& meeting) {
    return meeting.place == kNoKeyframe || meeting.keyframe == kNoKeyframe || meeting.place == meeting.keyframe;
  });
}

void Atlas::drop(KeyframeId id) {
  const Keyframe& keyframe = *map_.find_keyframe(id);
  const KeyframeId heir = !keyframe.is_origin()        ? keyframe.parent
                          : !keyframe.children.empty() ? keyframe.children.front()
                                                       : kNoKeyframe;
  hand_on_meetings(meetings_, id, heir);
  const Source& source = sources_.at(id);
  for (auto& [name, robot] : robots_) {
    hand_on_meetings(robot.undecided, id, heir);
    for (const KeyframeId own : {source.robot == name ? source.id : id, id})
      if (const auto it = robot.keyframes.find(own); it != robot.keyframes.end() && it->second.keyframe == id)
        robot.here.erase(own);
  }
  std::vector<KeyframeId>& cell = cells_[cell_of(world_of(id), keyframe.T_world_camera)];
  std::erase(cell, id);
  const auto [first, last] = by_stamp_.equal_range(keyframe.frame->stamp_ns);
  by_stamp_.erase(std::find_if(first, last, [&](const auto& entry) { return entry.second == id; }));
  ++revision_;
  places_.remove(id);
  sources_.erase(id);
  const MapId component = keyframe.map;
  map_.forget_removed(0);
  map_.remove_keyframe(id);
  if (map_.keyframe_count(component) == 0)
    remove_component(component);  // or the next world would never be that of `map`
}

/// What was joined by way of a component that is gone stays joined.
void Atlas::remove_component(MapId gone) {
  const MapId world = worlds_.at(gone);
  worlds_.erase(gone);
  const auto left = std::ranges::find(worlds_, world, [](const auto& entry) { return entry.second; });
  for (Join& join : joins_)
    for (MapId* end : {&join.older, &join.newer})
      if (*end == gone && left != worlds_.end()) *end = left->first;
  std::erase_if(joins_,
                [&](const Join& join) { return join.older == join.newer || join.older == gone || join.newer == gone; });
}

std::size_t Atlas::forget(const std::string& name) {
  std::vector<KeyframeId> gone;
  for (const auto& [id, source] : sources_)
    if (source.robot == name) gone.push_back(id);
  for (const KeyframeId id : gone) drop(id);
  robots_.erase(name);
  for (auto& [other, robot] : robots_)  // what gave way to its keyframes
    for (const auto& [id, announced] : robot.keyframes)
      if (!robot.here.contains(id)) robot.wanted.insert(id);
  return gone.size();
}

std::optional<msg::Submap> Atlas::locate(const msg::KeyframeFeatures& message) const {
  std::vector<std::uint32_t> kept;
  const slam::FramePtr frame = to_frame(message, kept);
  if (frame == nullptr) return std::nullopt;
  const slam::BagOfWords words = vocabulary_->describe(frame->features);
  const auto meeting = find_place(*frame, words, [&](KeyframeId id) { return is_joined(id); });
  if (!meeting) return std::nullopt;
  const auto twin =
      find_place(*frame, words, [&](KeyframeId id) { return is_joined(id) && !is_near(id, meeting->place); });
  if (twin && !is_same(*meeting, *twin)) return std::nullopt;
  const io::Bytes file =
      to_map_file(take_part(map_, around(meeting->place, meeting->T_world_camera), KeptFeatures::kOfLandmarks));
  msg::Submap submap{message.stamp_ns, msg::to_message(meeting->T_world_camera), {}};
  submap.file.resize(file.size());
  std::ranges::transform(file, submap.file.begin(), [](std::byte byte) { return std::to_integer<std::uint8_t>(byte); });
  return submap;
}

/// The keyframes that see about the same from about there, ascending.
std::vector<KeyframeId> Atlas::around(KeyframeId place, const Eigen::Isometry3d& T_world_camera) const {
  std::vector<std::pair<double, KeyframeId>> near;
  for (const auto& [id, keyframe] : map_.keyframes()) {
    if (!is_joined(id) || id == place) continue;
    const Eigen::Isometry3d T = T_world_camera.inverse() * keyframe.T_world_camera;
    near.emplace_back(T.translation().norm() + geometry::rotation_angle_rad(T), id);
  }
  std::ranges::sort(near);
  std::vector<KeyframeId> keyframes{place};
  for (const auto& [distance, id] : near) {
    if (static_cast<int>(keyframes.size()) == config_.submap_keyframes) break;
    keyframes.push_back(id);
  }
  std::ranges::sort(keyframes);
  return keyframes;
}

std::vector<std::string> Atlas::robots() const {
  std::vector<std::string> names;
  for (const auto& [name, robot] : robots_) names.push_back(name);
  return names;
}

std::vector<slam::MapPoint> Atlas::points() const {
  std::vector<slam::MapPoint> points;
  const std::vector<LandmarkId> landmarks = map_.landmark_ids();
  for (const auto& [component, world] : worlds_)
    if (world == worlds_.begin()->second) slam::append_map_points(map_, component, landmarks, points);
  return points;
}

msg::AtlasState Atlas::state() const {
  std::map<std::string, std::uint32_t> kept;
  for (const auto& [id, source] : sources_) ++kept[source.robot];
  msg::AtlasState state;
  state.corrections = counters_.corrections;
  for (const auto& [name, robot] : robots_) {
    msg::AtlasRobot& entry = state.robots.emplace_back();
    entry.name = name;
    entry.keyframes = kept[name];
    const auto unsettled = std::distance(settled_end(robot), robot.wanted.end());
    entry.missing = static_cast<std::uint32_t>(robot.wanted.size()) - static_cast<std::uint32_t>(unsettled);
    entry.meetings = robot.meetings;
    entry.T_map_robot = entry.T_map_camera = msg::to_message(Eigen::Isometry3d::Identity());
    const Announced* newest = newest_known(robot);
    if (newest == nullptr || !is_joined(newest->keyframe)) continue;
    const Eigen::Isometry3d T_map_robot = fit_map(robot, *newest);
    const Announced& last = robot.keyframes.rbegin()->second;
    entry.met = true;
    entry.stamp_ns = last.stamp_ns;
    entry.T_map_robot = msg::to_message(geometry::normalized(T_map_robot));
    entry.T_map_camera = msg::to_message(geometry::normalized(T_map_robot * last.T_robot_camera));
    const double way_m = robot.way_m - robot.way_at_meeting_m;
    const double sigma_m = config_.meeting_sigma_m + kDrift * way_m;
    const double sigma_rad = config_.meeting_sigma_rad + kDriftRadPerM * way_m;
    for (std::size_t i = 0; i < 6; ++i) entry.covariance[7 * i] = i < 3 ? sigma_m * sigma_m : sigma_rad * sigma_rad;
  }
  return state;
}

}  // namespace rtd::atlas
