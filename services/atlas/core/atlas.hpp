// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include "common/msg/atlas.hpp"
#include "common/msg/map_update.hpp"
#include "services/slam/core/loop/essential_graph.hpp"
#include "services/slam/core/loop/loop_detector.hpp"
#include "services/slam/core/map/trajectory.hpp"

namespace rtd::atlas {

using slam::KeyframeId;
using slam::LandmarkId;
using slam::MapId;

/// Section `atlas.core` of the configuration.
struct AtlasConfig {
  slam::SlamConfig slam;  ///< `loop`: when two places are one
  double cell_m = 0.75;
  int cell_keyframes = 6;
  int most_keyframes = 20'000;
  int look_every = 1;
  int settled_after = 5;
  int submap_keyframes = 12;
  double place_sigma_m = 0.015;
  double meeting_sigma_m = 0.01, meeting_sigma_rad = 0.003;
  double meeting_doubt = 3;
  double most_bend_m = 0.05, most_bend_share = 0.05;

  void bind(auto& binder) {
    binder.field("cell_m", cell_m, {0.1, 10.0}, "keyframes so near that look the same way show one place");
    binder.field("cell_keyframes", cell_keyframes, {1, 100}, "of one place, the newest so many stay");
    binder.field("most_keyframes", most_keyframes, {100, 1'000'000}, "of the joint map: beyond, the oldest go");
    binder.field("look_every", look_every, {1, 1000}, "keyframes of a robot that has met the joint map, per search");
    binder.field("settled_after", settled_after, {0, 100}, "later keyframes, before one is asked for");
    binder.field("submap_keyframes", submap_keyframes, {1, 50}, "sent to a robot that asks where it is");
    binder.field("place_sigma_m", place_sigma_m, {1e-4, 1.0}, "a place is found if its position is known so well");
    binder.field("meeting_sigma_m", meeting_sigma_m, {1e-4, 1.0},
                 "of a place that two keyframes share, besides what slam says: standard deviation of its position");
    binder.field("meeting_sigma_rad", meeting_sigma_rad, {1e-4, 1.0}, "the same for its rotation");
    binder.field("meeting_doubt", meeting_doubt, {0.0, 100.0},
                 "factor on the standard deviations that slam has: landmarks are wrong together, as their map is");
    binder.field("most_bend_m", most_bend_m, {0.0, 10.0},
                 "a meeting that changes another robot's motion by more than this and ...");
    binder.field("most_bend_share", most_bend_share, {0.0, 1.0}, "... this share of that motion is refused");
  }
};

/// What became of what came in; for diagnostics and tests.
struct AtlasCounters {
  std::uint64_t keyframes = 0;    ///< taken
  std::uint64_t broken = 0;       ///< refused: no keyframe can be so
  std::uint64_t met = 0;          ///< keyframes found at a place of others
  std::uint64_t implausible = 0;  ///< of those, too far from where the joint map has them
  std::uint64_t alike = 0;        ///< of those, at places that there are twice
  std::uint64_t meetings = 0;     ///< confirmed by enough of them
  std::uint64_t refused = 0;  ///< of these, taken back: they bent the map of another robot, or the place is there twice
  std::uint64_t corrections = 0;  ///< of the joint map
  std::uint64_t given_way = 0;    ///< keyframes that newer ones of the same place replaced
};

/// The maps of several robots in one: which keyframes each has, where they meet, and the poses that contradict all of
/// it least. docs/atlas.md. A robot's keyframes and landmarks stay its own: nothing is fused, so that it can be taken
/// out again. Data from outside: never throws for its content. Knows no clocks; same order of calls, same map. Not
/// thread-safe.
class Atlas {
 public:
  explicit Atlas(AtlasConfig config);

  /// Continues with a joint map that was saved, before anything else. `owners`: as owners() gave them.
  void restore(slam::MapContents contents, const std::map<std::string, std::vector<KeyframeId>>& owners);
  /// The joint map as one map; empty without keyframes.
  slam::MapContents contents() const;
  /// Whose keyframes those of contents() are.
  std::map<std::string, std::vector<KeyframeId>> owners() const;

  /// Which keyframes a robot has and where they are in its own map. `now_ns`: when this came, by one clock for all:
  /// those of robots may be days wrong, and which keyframe is newer must not depend on them.
  void follow(const std::string& robot, const msg::MapUpdate& update, std::int64_t now_ns);
  /// Those whose features are wanted, the newest first; at most `limit`. What has given way, to newer ones of its place
  /// or because there is too much, is not wanted again until a robot is forgotten.
  msg::KeyframeRequest missing(const std::string& robot, std::size_t limit);
  /// The features of one of them; looks whether it meets the map of another robot. True when it was taken
  /// or is here already.
  bool add(const std::string& robot, const msg::KeyframeFeatures& message);
  /// Where in the joint map a frame is, with the map around it; empty when it is not recognised.
  std::optional<msg::Submap> locate(const msg::KeyframeFeatures& message) const;
  /// Puts the joint map right after meetings and corrections by the robots. True when something moved.
  bool straighten();
  /// Takes a robot out with everything it brought. Returns how many keyframes went.
  std::size_t forget(const std::string& robot);

  std::vector<std::string> robots() const;
  msg::AtlasState state() const;
  /// The landmarks of the joint map.
  std::vector<slam::MapPoint> points() const;
  const AtlasCounters& counters() const { return counters_; }
  /// Counts the changes of the map; what was restored is 0.
  std::uint64_t revision() const { return revision_; }
  const slam::Map& map() const { return map_; }
  /// Whether a keyframe is in the frame `map`: of the world that began first.
  bool is_joined(KeyframeId keyframe) const;

 private:
  static constexpr double kUnknown_s = std::numeric_limits<double>::infinity();
  /// A keyframe that a robot has.
  struct Announced {
    Eigen::Isometry3d T_robot_camera = Eigen::Isometry3d::Identity();  ///< in the robot's own map
    std::int64_t stamp_ns = 0;
    MapId map = 0;  ///< of the robot
    std::vector<KeyframeId> covisible;
    KeyframeId keyframe = slam::kNoKeyframe;  ///< here, or where it was until it gave way
  };
  /// Two keyframes that show the same place.
  struct Meeting {
    KeyframeId place = slam::kNoKeyframe, keyframe = slam::kNoKeyframe;
    Eigen::Isometry3d T_place_keyframe = Eigen::Isometry3d::Identity();
    geometry::Matrix6d covariance = geometry::Matrix6d::Zero();   ///< as of PoseGraphEdge
    std::uint64_t number = 0;                                     ///< of the confirmed meeting that it belongs to
    Eigen::Isometry3d T_new_old = Eigen::Isometry3d::Identity();  ///< what it does to the world of the keyframe
  };
  /// Two components of the map that share a frame because of a meeting.
  struct Join {
    MapId older = 0, newer = 0;
    std::uint64_t meeting = 0;
  };
  struct Robot {
    std::int64_t session_ns = 0;
    double behind_s = kUnknown_s;                             ///< that its clock is behind, at most
    std::map<KeyframeId, Announced> keyframes;                ///< by its own ids
    std::set<KeyframeId> here, wanted;                        ///< of these; the others have given way
    std::map<KeyframeId, KeyframeId> claimed;                 ///< of what is wanted: which ones here they may be
    std::unordered_map<std::uint32_t, LandmarkId> landmarks;  ///< by its own ids
    std::size_t living_landmarks = 0;                         ///< of these, when they were last checked
    std::vector<Meeting> undecided;                           ///< that too few others agree with
    int since_look = 0;
    double way_m = 0, way_at_meeting_m = 0;
    std::uint32_t meetings = 0;
  };
  struct Source {
    std::string robot;
    KeyframeId id = slam::kNoKeyframe;  ///< of the robot
    double behind_s = kUnknown_s;       ///< Robot::behind_s when it came; unknown for what was restored
  };
  using Cell = std::array<int, 6>;  ///< world, place, viewing direction

  KeyframeId find_known(const std::string& robot, KeyframeId id, std::int64_t stamp_ns) const;
  void follow(const std::string& name, Robot& robot, const msg::MapKeyframe& entry);
  bool settle_claim(const std::string& name, Robot& robot, KeyframeId id, const slam::Frame& frame);
  void withdraw(const std::string& name, Robot& robot, KeyframeId id);
  const Announced* choose_parent(const Robot& robot, KeyframeId id) const;
  static const Announced* newest_known(const Robot& robot);
  std::set<KeyframeId>::const_iterator settled_end(const Robot& robot) const;
  Eigen::Isometry3d fit_map(const Robot& robot, const Announced& newest) const;
  double seen_s(KeyframeId keyframe) const;
  bool is_wanted(const Robot& robot, const Announced& announced, const Eigen::Isometry3d& T_world_robot,
                 MapId world) const;
  void forget_landmarks(Robot& robot) const;
  void see_landmark(Robot& robot, const slam::Keyframe& keyframe, std::uint32_t feature, std::uint32_t robot_id);
  void look_for_meeting(const std::string& name, Robot& robot, KeyframeId keyframe);
  std::optional<slam::PlaceMeeting> meet(const std::string& name, const Robot& robot, KeyframeId keyframe);
  std::optional<slam::PlaceMeeting> find_place(const slam::Frame& frame, const slam::BagOfWords& words,
                                               const std::function<bool(KeyframeId)>& admitted) const;
  bool is_near(KeyframeId a, KeyframeId b) const;
  bool is_plausible(KeyframeId keyframe, const slam::PlaceMeeting& meeting, double way_m) const;
  bool is_same(const slam::PlaceMeeting& meeting, const slam::PlaceMeeting& other) const;
  Meeting meeting_of(KeyframeId id, const slam::PlaceMeeting& met) const;
  bool bear_out(const std::string& name, const Meeting& meeting, std::vector<Meeting>& agreeing) const;
  KeyframeId nearest_view(MapId world, const Eigen::Isometry3d& T_world_camera) const;
  void doubt_meetings_at(KeyframeId place);
  void accept(const std::string& name, Robot& robot, const Meeting& last, std::vector<Meeting> agreeing);
  void join_worlds(MapId kept, MapId joined, const Eigen::Isometry3d& T_kept_joined);
  MapId world_of(KeyframeId keyframe) const { return worlds_.at(map_.find_keyframe(keyframe)->map); }
  Cell cell_of(MapId world, const Eigen::Isometry3d& T_world_camera) const;
  void sort_into_cells();
  std::vector<KeyframeId> around(KeyframeId place, const Eigen::Isometry3d& T_world_camera) const;
  bool may_go(KeyframeId keyframe) const;
  void give_way(KeyframeId newest);
  void drop(KeyframeId keyframe);
  void trim_meetings();
  void hand_on_meetings(std::vector<Meeting>& meetings, KeyframeId id, KeyframeId heir) const;
  bool straighten_world(MapId world, const std::string& robot);
  bool bends_others(const slam::PoseGraph& graph, const std::vector<KeyframeId>& nodes, const std::string& robot) const;
  bool take_back_last(const std::string& robot);
  void take_back(std::uint64_t meeting);
  std::set<std::uint64_t> meeting_numbers() const;
  void separate_worlds();
  void remove_component(MapId gone);
  slam::PoseGraph make_graph(MapId world, std::vector<KeyframeId>& nodes) const;
  std::optional<Eigen::Isometry3d> motion_by_robot(KeyframeId from, KeyframeId to) const;

  AtlasConfig config_;
  std::shared_ptr<const slam::Vocabulary> vocabulary_;
  slam::Map map_;  ///< a component for each map of each robot; those of one world share its frame
  slam::KeyframeDatabase places_;
  std::map<MapId, MapId> worlds_;  ///< component -> the oldest one that it shares a frame with
  std::map<KeyframeId, Source> sources_;
  std::multimap<std::int64_t, KeyframeId> by_stamp_;  ///< of the robot's clock
  std::map<Cell, std::vector<KeyframeId>> cells_;
  std::map<std::string, Robot> robots_;
  std::vector<Meeting> meetings_;
  std::vector<Join> joins_;
  std::map<std::uint64_t, int> doubts_;   ///< of meetings: finds of the same place elsewhere
  std::uint64_t last_meeting_ = 0;        ///< Meeting::number
  std::map<MapId, std::string> crooked_;  ///< worlds that are to be straightened, and the robot that is the cause
  AtlasCounters counters_;
  std::uint64_t revision_ = 0;
};

}  // namespace rtd::atlas
