// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/bus/commands.hpp"
#include "common/bus/robot_finder.hpp"
#include "common/io/atomic_file.hpp"
#include "common/io/named_files.hpp"
#include "common/service/config.hpp"
#include "common/service/exit_code.hpp"
#include "common/service/log.hpp"
#include "common/service/runtime.hpp"
#include "services/atlas/core/atlas.hpp"
#include "services/atlas/floor_plans.hpp"

namespace CLI {
class App;
}

namespace rtd::atlas {

/// Section `atlas` of the configuration.
struct ServiceConfig {
  AtlasConfig core;
  std::string map_file;
  std::string maps_folder;
  std::string map_frame = "map";
  std::vector<std::string> robots;
  int checkpoint_s = 60;
  int request_keyframes = 10;

  void bind(auto& binder) {
    core.bind(binder);
    binder.section("loop", core.slam.loop);
    binder.field("map", map_file, "map of the building: loaded if it is there, saved while it grows; empty: none")
        .option("--map");
    binder.field("maps_dir", maps_folder, "folder of the maps that atlas/save and atlas/load may name; empty: none")
        .option("--maps-dir");
    binder.field("map_frame", map_frame, "frame of the joint map");
    binder.field("robots", robots, "names of the robots whose maps are joined; empty: all in the domain")
        .option("--robots");
    binder.field("checkpoint_s", checkpoint_s, {1, 86'400}, "between two saves of a map that grows");
    binder.field("request_keyframes", request_keyframes, {1, 1000}, "asked of a robot at a time");
  }
};

/// Joins the maps of the robots of a domain, which it finds by their rtd/map: docs/atlas.md. Nothing waits for it.
/// Each robot sends it what it maps and learns from it where it is. One worker; messages wait in a bounded queue, of
/// which those that can be asked for again are dropped first.
class AtlasService {
 public:
  static constexpr const char* kName = "atlas";
  static constexpr const char* kDescription = "Joins the maps of several robots in one building";
  static constexpr std::uint32_t kShmSegmentMib = bus::kSmallSegmentMib;
  using Config = ServiceConfig;
  static void add_options(CLI::App& app, std::vector<service::GivenOption>&);

  AtlasService(const Config& config, service::Runtime& runtime);
  ~AtlasService();
  AtlasService(const AtlasService&) = delete;
  AtlasService& operator=(const AtlasService&) = delete;
  service::ExitCode run();

 private:
  using Update = std::shared_ptr<const msg::MapUpdate>;
  using Features = std::shared_ptr<const msg::KeyframeFeatures>;
  using Plan = std::shared_ptr<const msg::OccupancyGrid>;
  using Message = std::variant<Update, Features, Plan>;
  struct Arrival {
    std::string robot;
    Message message;
  };
  /// The topics of one robot.
  struct Lane {
    std::shared_ptr<bus::Bus> bus;
    bus::Writer<msg::KeyframeRequest> requests;
    bus::Writer<msg::Submap> submaps;
    bus::Reader<msg::MapUpdate> updates;
    bus::Reader<msg::KeyframeFeatures> features;
    bus::Reader<msg::OccupancyGrid> plans;  ///< while that of all has a reader
    std::int64_t asked_ns = 0;              ///< last time
    std::size_t waiting_for = 0;
  };

  void push(const std::string& robot, Message message);
  std::deque<Arrival> take_arrivals();
  void take(const Arrival& arrival);
  void find_robots();
  void open_lane(const std::string& robot);
  void ask(const std::string& robot, Lane& lane);
  void answer_query(const std::string& robot, Lane& lane, const msg::KeyframeFeatures& query);
  void straighten();
  void report_refusal(const char* cause);
  void publish();
  void publish_transforms(const msg::AtlasState& state);
  void publish_points();
  void read_floor_plan(const std::string& robot, Lane& lane, bool wanted);
  void publish_floor_plan();
  void report(const msg::AtlasState& state);
  static io::NamedFiles maps_in(const std::string& folder);
  void load_at_start();
  void load(const std::string& file);
  bus::CommandAnswer save(const std::string& file, io::NamedBy named_by);
  bus::CommandAnswer save_by_command(const std::string& name);
  bus::CommandAnswer load_by_command(const std::string& name);
  bus::CommandAnswer forget(const std::string& robot);
  void checkpoint();
  void save_changes();
  void remove_map();
  service::ExitCode finish();

  const Config config_;
  service::Runtime& runtime_;
  std::optional<Atlas> atlas_;
  std::mutex mutex_;  ///< guards arrivals_ and dropped_
  std::deque<Arrival> arrivals_;
  std::uint64_t dropped_ = 0;
  const io::NamedFiles maps_;
  std::optional<bus::RobotFinder> finder_;  ///< unless the robots are named
  bus::Writer<msg::AtlasState> state_writer_;
  bus::Writer<msg::PoseArray> poses_writer_;
  bus::Writer<msg::PointCloud2> points_writer_;
  bus::Writer<msg::OccupancyGrid> plan_writer_;
  bus::Writer<msg::TFMessage> tf_writer_;
  bus::Writer<msg::TransformStamped> jumps_writer_;
  std::map<std::string, Lane> lanes_;
  std::set<std::string> forgotten_;                   ///< robots that are not listened to any more
  std::map<std::string, msg::Transform> transforms_;  ///< T_map_robot as published
  FloorPlans floor_plans_;
  std::uint64_t located_ = 0, asked_where_ = 0, refused_ = 0;
  std::uint64_t saved_ = 0;             ///< Atlas::revision() of what the file holds
  std::optional<std::uint64_t> shown_;  ///< the same of the published points
  std::int64_t published_ns_ = 0, checkpoint_ns_ = 0, points_ns_ = 0, plan_ns_ = 0, straightened_ns_ = 0;
  std::string trouble_;  ///< why the last save failed
  service::RateLimit robot_log_{std::chrono::seconds(1)}, query_log_{std::chrono::seconds(1)};
  std::optional<bus::CommandServer> server_;  // last: it uses the others
};

}  // namespace rtd::atlas
