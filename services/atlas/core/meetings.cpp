// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// Where the maps of robots meet, and the joint map that follows: docs/atlas.md.
#include <algorithm>
#include <cmath>
#include <ranges>
#include <set>

#include "common/geometry/se3.hpp"
#include "services/atlas/core/atlas.hpp"

namespace rtd::atlas {

using slam::Keyframe;
using slam::kNoKeyframe;

/// Of one robot: more are forgotten, the oldest first.
static constexpr std::size_t kMostUndecided = 50;

namespace {

/// Views that differ by less may show the same things.
constexpr double kNear_m = 2, kNear_rad = 1;
/// Keyframes of which it is asked whether they bear out a meeting of two worlds, and how far from a keyframe there.
constexpr std::size_t kMostAsked = 20;
constexpr double kBorneOut_m = 0.15, kBorneOut_rad = 0.1;
constexpr double kLookedAt_m = 0.75, kLookedAt_rad = 0.5;

bool is_near(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b, double most_m, double most_rad) {
  const Eigen::Isometry3d T = a.inverse() * b;
  return T.translation().norm() < most_m && geometry::rotation_angle_rad(T) < most_rad;
}

}  // namespace

bool Atlas::is_near(KeyframeId a, KeyframeId b) const {
  return world_of(a) == world_of(b) && atlas::is_near(map_.find_keyframe(a)->T_world_camera,
                                                      map_.find_keyframe(b)->T_world_camera, kNear_m, kNear_rad);
}

/// The first place among those admitted that the keyframe is found at, and can say where from.
std::optional<slam::PlaceMeeting> Atlas::find_place(const slam::Frame& frame, const slam::BagOfWords& words,
                                                    const std::function<bool(KeyframeId)>& admitted) const {
  slam::PlaceQuery query;
  query.admitted = admitted;
  query.max_candidates = static_cast<std::size_t>(config_.slam.place.candidates);
  for (const slam::PlaceCandidate& candidate : slam::find_places(places_, map_, words, query))
    if (auto meeting = slam::meet_place(map_, frame, candidate.keyframe, config_.slam);
        meeting && geometry::largest_sigma(meeting->covariance.topLeftCorner<3, 3>()) <= config_.place_sigma_m)
      return meeting;
  return std::nullopt;
}

std::optional<slam::PlaceMeeting> Atlas::meet(const std::string& name, const Robot& robot, KeyframeId id) {
  const MapId here = world_of(id);
  const Keyframe& keyframe = *map_.find_keyframe(id);
  const slam::BagOfWords& words = *places_.find(id);
  const auto is_others = [&](KeyframeId other) { return sources_.at(other).robot != name || world_of(other) != here; };
  auto meeting = find_place(*keyframe.frame, words, is_others);
  if (!meeting) return std::nullopt;
  ++counters_.met;
  if (!is_plausible(id, *meeting, robot.way_m - robot.way_at_meeting_m)) {
    ++counters_.implausible;
    doubt_meetings_at(meeting->place);
    return std::nullopt;
  }
  // A place that is there twice says nothing: among those of others, or on the robot's own way.
  const KeyframeId place = meeting->place;
  const auto twin = find_place(*keyframe.frame, words, [&](KeyframeId other) {
    return !is_near(other, place) && !is_near(other, id) &&
           world_of(other) == (is_others(other) ? world_of(place) : here);
  });
  if (!twin ||
      (world_of(twin->place) == world_of(place) ? is_same(*meeting, *twin) : is_plausible(id, *twin, robot.way_m)))
    return meeting;
  ++counters_.alike;
  doubt_meetings_at(place);
  doubt_meetings_at(twin->place);
  return std::nullopt;
}

/// Whether two places of one world that a frame was found at are one, seen from two sides.
bool Atlas::is_same(const slam::PlaceMeeting& meeting, const slam::PlaceMeeting& other) const {
  const slam::LoopConfig& loop = config_.slam.loop;
  return atlas::is_near(meeting.T_world_camera, other.T_world_camera, loop.max_offset_m, loop.max_offset_rad);
}

/// Meetings near a place that was found elsewhere too. Enough such finds, and they are taken back.
void Atlas::doubt_meetings_at(KeyframeId place) {
  std::set<std::uint64_t> doubted;
  for (const Meeting& meeting : meetings_)
    if (is_near(meeting.place, place) || is_near(meeting.keyframe, place)) doubted.insert(meeting.number);
  for (const std::uint64_t number : doubted)
    if (++doubts_[number] >= config_.slam.loop.confirmations) take_back(number);
}

/// Between two worlds nothing is known. In one, the correction must be one that drift since the last meeting explains.
bool Atlas::is_plausible(KeyframeId id, const slam::PlaceMeeting& meeting, double way_m) const {
  if (world_of(id) != world_of(meeting.place)) return true;
  const Eigen::Isometry3d T = map_.find_keyframe(id)->T_world_camera.inverse() * meeting.T_world_camera;
  return slam::drift_explains(T, way_m, config_.slam.loop);
}

Atlas::Meeting Atlas::meeting_of(KeyframeId id, const slam::PlaceMeeting& met) const {
  const geometry::Matrix6d R_camera_world = geometry::block_rotation(met.T_world_camera.linear().transpose());
  const double doubt2 = config_.meeting_doubt * config_.meeting_doubt;
  return {.place = met.place,
          .keyframe = id,
          .T_place_keyframe = map_.find_keyframe(met.place)->T_world_camera.inverse() * met.T_world_camera,
          .covariance = doubt2 * R_camera_world * met.covariance * R_camera_world.transpose(),
          .T_new_old = met.T_world_camera * map_.find_keyframe(id)->T_world_camera.inverse()};
}

/// A meeting counts once enough keyframes of the robot ask for the same, wherever they are.
void Atlas::look_for_meeting(const std::string& name, Robot& robot, KeyframeId id) {
  const bool met = robot.meetings > 0 && is_joined(id);
  if (met && robot.undecided.empty() && ++robot.since_look < config_.look_every) return;
  robot.since_look = 0;
  const std::optional<slam::PlaceMeeting> met_place = meet(name, robot, id);
  if (!met_place) return;
  const Eigen::Isometry3d T_world_keyframe = map_.find_keyframe(id)->T_world_camera;
  const Meeting meeting = meeting_of(id, *met_place);
  std::vector<Meeting> agreeing{meeting};
  for (const Meeting& other : robot.undecided)
    if (world_of(other.place) == world_of(meeting.place) && world_of(other.keyframe) == world_of(id) &&
        slam::agree(meeting.T_new_old, other.T_new_old, T_world_keyframe, config_.slam.loop))
      agreeing.push_back(other);
  robot.undecided.push_back(meeting);
  if (robot.undecided.size() > kMostUndecided) robot.undecided.erase(robot.undecided.begin());
  if (world_of(id) != world_of(meeting.place) && !bear_out(name, meeting, agreeing)) return;
  if (static_cast<int>(agreeing.size()) >= config_.slam.loop.confirmations)
    accept(name, robot, meeting, std::move(agreeing));
}

/// Between two worlds: of the robot's keyframes that look at what the other world has seen too, half must find it.
/// Those that do agree with the meeting as well.
bool Atlas::bear_out(const std::string& name, const Meeting& meeting, std::vector<Meeting>& agreeing) const {
  const MapId here = world_of(meeting.keyframe), there = world_of(meeting.place);
  std::size_t looked = 0, found = 0;
  for (const auto& [id, keyframe] : map_.keyframes() | std::views::reverse) {
    if (looked == kMostAsked) break;
    if (sources_.at(id).robot != name || world_of(id) != here) continue;
    const Eigen::Isometry3d T_there_camera = meeting.T_new_old * keyframe.T_world_camera;
    const KeyframeId place = nearest_view(there, T_there_camera);
    if (place == kNoKeyframe) continue;
    ++looked;
    const auto met = slam::look_again(map_, *keyframe.frame, place, T_there_camera, config_.slam);
    if (!met || !atlas::is_near(met->T_world_camera, T_there_camera, kBorneOut_m, kBorneOut_rad)) continue;
    ++found;
    if (std::ranges::count(agreeing, id, &Meeting::keyframe) > 0) continue;
    agreeing.push_back(meeting_of(id, *met));
  }
  return 2 * found >= looked;
}

/// kNoKeyframe where the world has none that looks at about the same from about there.
KeyframeId Atlas::nearest_view(MapId world, const Eigen::Isometry3d& T_world_camera) const {
  KeyframeId nearest = kNoKeyframe;
  double least = 1;
  for (const auto& [id, keyframe] : map_.keyframes()) {
    if (worlds_.at(keyframe.map) != world) continue;
    const Eigen::Isometry3d T = T_world_camera.inverse() * keyframe.T_world_camera;
    const double apart =
        std::max(T.translation().norm() / kLookedAt_m, geometry::rotation_angle_rad(T) / kLookedAt_rad);
    if (apart < least) {
      least = apart;
      nearest = id;
    }
  }
  return nearest;
}

void Atlas::accept(const std::string& name, Robot& robot, const Meeting& last, std::vector<Meeting> agreeing) {
  ++last_meeting_;
  for (Meeting& meeting : agreeing) {
    meeting.number = last_meeting_;
    meetings_.push_back(meeting);
  }
  robot.undecided.clear();
  robot.way_at_meeting_m = robot.way_m;
  ++robot.meetings;
  ++counters_.meetings;
  const MapId here = world_of(last.keyframe), there = world_of(last.place);
  const auto [older, newer] =
      std::minmax({map_.find_keyframe(last.place)->map, map_.find_keyframe(last.keyframe)->map});
  if (older != newer) joins_.push_back({older, newer, last_meeting_});
  if (there < here) join_worlds(there, here, last.T_new_old);
  if (here < there) join_worlds(here, there, last.T_new_old.inverse());
  crooked_[std::min(here, there)] = name;
}

void Atlas::join_worlds(MapId kept, MapId joined, const Eigen::Isometry3d& T_kept_joined) {
  for (auto& [component, world] : worlds_) {
    if (world != joined) continue;
    slam::move_component(map_, component, T_kept_joined);
    world = kept;
  }
  crooked_.erase(joined);
  for (auto& [name, robot] : robots_) robot.undecided.clear();  // they spoke of other worlds
  ++counters_.corrections;
  ++revision_;
  sort_into_cells();
}

/// As the robot that made both has it; empty where no robot here has it.
std::optional<Eigen::Isometry3d> Atlas::motion_by_robot(KeyframeId from, KeyframeId to) const {
  const Source& source = sources_.at(to);
  const auto robot = robots_.find(source.robot);
  if (robot == robots_.end()) return std::nullopt;
  const Announced *a = nullptr, *b = nullptr;
  const auto& known = robot->second.keyframes;
  if (const auto it = known.find(source.id); it != known.end() && it->second.keyframe == to) b = &it->second;
  // The other one is of the same robot, or of the map that it was given.
  const Source& other = sources_.at(from);
  for (const KeyframeId id : {other.robot == source.robot ? other.id : from, from})
    if (const auto it = known.find(id); it != known.end() && it->second.keyframe == from) a = &it->second;
  if (a == nullptr || b == nullptr || a->map != b->map) return std::nullopt;
  return a->T_robot_camera.inverse() * b->T_robot_camera;
}

slam::PoseGraph Atlas::make_graph(MapId world, std::vector<KeyframeId>& nodes) const {
  slam::PoseGraph graph;
  std::map<KeyframeId, std::uint32_t> index;
  for (const auto& [id, keyframe] : map_.keyframes()) {
    if (worlds_.at(keyframe.map) != world) continue;
    index[id] = static_cast<std::uint32_t>(nodes.size());
    nodes.push_back(id);
    graph.nodes.push_back({keyframe.T_world_camera, nodes.size() == 1});
  }
  const auto add_motion = [&](KeyframeId from, KeyframeId to, int shared) {
    const Eigen::Isometry3d T_present =
        map_.find_keyframe(from)->T_world_camera.inverse() * map_.find_keyframe(to)->T_world_camera;
    graph.edges.push_back(slam::motion_edge(index.at(from), index.at(to), motion_by_robot(from, to).value_or(T_present),
                                            std::max(shared, 1)));
  };
  constexpr int kStrong = 100;  // landmarks in common
  for (const KeyframeId id : nodes) {
    const Keyframe& keyframe = *map_.find_keyframe(id);
    if (!keyframe.is_origin()) {
      const auto shared = keyframe.covisible.find(keyframe.parent);
      add_motion(keyframe.parent, id, shared == keyframe.covisible.end() ? 0 : shared->second);
    }
    for (const auto& [other, shared] : keyframe.covisible)
      if (other < id && other != keyframe.parent && shared >= kStrong) add_motion(other, id, shared);
  }
  for (const Meeting& meeting : meetings_)
    if (index.contains(meeting.place) && index.contains(meeting.keyframe))
      graph.edges.push_back({index.at(meeting.place), index.at(meeting.keyframe), meeting.T_place_keyframe,
                             config_.meeting_sigma_m, config_.meeting_sigma_rad, meeting.covariance});
  return graph;
}

/// Whether motions of other robots are no longer what those measured, or their meetings no longer what they can be.
bool Atlas::bends_others(const slam::PoseGraph& graph, const std::vector<KeyframeId>& nodes,
                         const std::string& robot) const {
  return std::ranges::any_of(graph.edges, [&](const slam::PoseGraphEdge& edge) {
    const std::string &from = sources_.at(nodes[edge.from]).robot, &to = sources_.at(nodes[edge.to]).robot;
    if (from == robot || to == robot) return false;
    const Eigen::Isometry3d T_now = graph.nodes[edge.from].T_world_node.inverse() * graph.nodes[edge.to].T_world_node;
    const double bend_m = (T_now.translation() - edge.T_from_to.translation()).norm();
    double most_m = config_.most_bend_m + config_.most_bend_share * edge.T_from_to.translation().norm();
    if (from != to)
      most_m += 3 * std::hypot(edge.sigma_m, geometry::largest_sigma(edge.covariance.topLeftCorner<3, 3>()));
    return bend_m > most_m;
  });
}

/// The last one of a robot; false when it has none.
bool Atlas::take_back_last(const std::string& robot) {
  const auto last = std::ranges::find_if(meetings_.rbegin(), meetings_.rend(), [&](const Meeting& meeting) {
    return sources_.at(meeting.keyframe).robot == robot;
  });
  if (last == meetings_.rend()) return false;
  take_back(last->number);
  return true;
}

void Atlas::take_back(std::uint64_t number) {
  std::erase_if(meetings_, [&](const Meeting& meeting) { return meeting.number == number; });
  doubts_.erase(number);
  ++counters_.refused;
  // Of the same two, meetings that nothing is left of do not outlive it.
  const std::set<std::uint64_t> left = meeting_numbers();
  std::set<std::pair<MapId, MapId>> doubted;
  for (const Join& join : joins_)
    if (join.meeting == number) doubted.emplace(join.older, join.newer);
  const auto ended = [&](const Join& join) {
    return join.meeting == number || (doubted.contains({join.older, join.newer}) && !left.contains(join.meeting));
  };
  if (std::erase_if(joins_, ended) > 0) separate_worlds();
}

/// Components that no meeting joins any more are worlds of their own again.
void Atlas::separate_worlds() {
  std::map<MapId, MapId> worlds;
  for (const auto& [component, world] : worlds_) worlds[component] = component;
  for (bool changed = true; std::exchange(changed, false);)
    for (const Join& join : joins_) {
      MapId &a = worlds.at(join.older), &b = worlds.at(join.newer);
      changed = changed || a != b;
      a = b = std::min(a, b);
    }
  if (worlds == worlds_) return;
  for (const auto& [component, world] : worlds)
    if (world != worlds_.at(component)) crooked_.try_emplace(world);
  worlds_ = std::move(worlds);
  for (auto& [name, robot] : robots_) robot.undecided.clear();
  ++revision_;
  sort_into_cells();
}

/// `robot` is the cause. What it says must not bend the maps of others: else its last meeting is taken back.
bool Atlas::straighten_world(MapId world, const std::string& robot) {
  slam::PoseGraphOptions options;
  options.max_iterations = config_.slam.loop.graph_iterations;
  do {
    std::vector<KeyframeId> nodes;
    slam::PoseGraph graph = make_graph(world, nodes);
    if (nodes.empty() || !slam::optimize_pose_graph(graph, options).usable) return false;
    if (bends_others(graph, nodes, robot)) continue;
    slam::KeyframePoses poses;
    for (std::size_t i = 0; i < nodes.size(); ++i) poses[nodes[i]] = graph.nodes[i].T_world_node;
    slam::move_keyframes(map_, poses);
    return true;
  } while (take_back_last(robot));
  return false;
}

/// Of what a keyframe has met, the newest count: more of them say the same, and meetings would grow with time.
void Atlas::trim_meetings() {
  constexpr int kMost = 10;
  std::map<KeyframeId, int> newer;
  const auto count = [&](const Meeting& meeting) {
    const int at_place = newer[meeting.place]++, at_keyframe = newer[meeting.keyframe]++;
    return std::min(at_place, at_keyframe) < kMost;
  };
  std::vector<Meeting> kept;
  std::ranges::copy_if(meetings_ | std::views::reverse, std::back_inserter(kept), count);
  meetings_.assign(kept.rbegin(), kept.rend());
  const std::set<std::uint64_t> left = meeting_numbers();
  std::set<std::pair<MapId, MapId>> joined;
  std::vector<Join> newest;
  for (const Join& join : joins_ | std::views::reverse)
    if (joined.emplace(join.older, join.newer).second || left.contains(join.meeting)) newest.push_back(join);
  joins_.assign(newest.rbegin(), newest.rend());
  std::erase_if(doubts_, [&](const auto& doubt) { return !left.contains(doubt.first); });
}

std::set<std::uint64_t> Atlas::meeting_numbers() const {
  std::set<std::uint64_t> numbers;
  for (const Meeting& meeting : meetings_) numbers.insert(meeting.number);
  return numbers;
}

bool Atlas::straighten() {
  bool moved = false;
  if (!crooked_.empty()) trim_meetings();
  for (const auto& [world, robot] : std::exchange(crooked_, {})) moved = straighten_world(world, robot) || moved;
  if (!moved) return false;
  ++counters_.corrections;
  ++revision_;
  sort_into_cells();
  return true;
}

/// Where the map of the robot that its newest keyframe is in lies in its world, by the newest there: each of them alone
/// is less certain.
Eigen::Isometry3d Atlas::fit_map(const Robot& robot, const Announced& newest) const {
  const MapId world = world_of(newest.keyframe);
  constexpr int kKeyframes = 10;
  std::vector<std::pair<const Eigen::Isometry3d*, const Eigen::Isometry3d*>> poses;  // here, of the robot
  for (const KeyframeId id : robot.here | std::views::reverse) {
    const Announced& announced = robot.keyframes.at(id);
    const Keyframe& keyframe = *map_.find_keyframe(announced.keyframe);
    if (announced.map != newest.map || worlds_.at(keyframe.map) != world) continue;
    poses.emplace_back(&keyframe.T_world_camera, &announced.T_robot_camera);
    if (poses.size() == kKeyframes) break;
  }
  const Eigen::Quaterniond first(poses.front().first->linear() * poses.front().second->linear().transpose());
  Eigen::Vector4d sum = Eigen::Vector4d::Zero();  // of quaternions that are near one another
  for (const auto& [here, own] : poses) {
    const Eigen::Quaterniond q(here->linear() * own->linear().transpose());
    sum += q.dot(first) < 0 ? -q.coeffs() : q.coeffs();
  }
  Eigen::Isometry3d T_world_robot = Eigen::Isometry3d::Identity();
  T_world_robot.linear() = Eigen::Quaterniond(sum).normalized().toRotationMatrix();
  for (const auto& [here, own] : poses)
    T_world_robot.translation() +=
        (here->translation() - T_world_robot.linear() * own->translation()) / static_cast<double>(poses.size());
  return T_world_robot;
}

}  // namespace rtd::atlas
