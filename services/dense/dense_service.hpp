// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/frame_topics.hpp"
#include "common/msg/ros.hpp"
#include "common/occupancy/navigation_grid.hpp"
#include "common/service/exit_code.hpp"
#include "common/service/log.hpp"
#include "common/service/runtime.hpp"
#include "common/service/topic_source.hpp"
#include "services/dense/core/dense_config.hpp"
#include "services/dense/core/depth_view.hpp"
#include "services/dense/core/navigation_map.hpp"
#include "services/dense/core/static_map.hpp"
#include "services/dense/frame_joiner.hpp"

namespace rtd::dense {

/// The filter's mask of what moves; empty when encoding, size or length is wrong.
std::optional<DynamicMask> from_message(const msg::Image& message);

/// x y z and rgb (packed as usual in ROS), all float32.
msg::PointCloud2 make_cloud(const std::vector<CloudPoint>& points, std::int64_t stamp_ns, const std::string& map_frame);

/// Maps for navigation: the floor plan and the voxel map.
struct GridConfig {
  bool enabled = true;
  std::string up;
  int publish_period_ms = 1000;
  NavigationConfig core;

  void bind(auto& binder) {
    binder.field("enabled", enabled, "make a floor plan on rt/map and, at the end, map.pgm, map.yaml and map.bt");
    binder
        .field("up", up,
               "what points up in the map: x,y,z; 0,0,1 where slam knows the base of the robot. Empty: 0,-1,0, up in "
               "the first image")
        .option("--up");
    binder.field("publish_period_ms", publish_period_ms, {100, 600'000}, "between two plans on rt/map");
    core.bind(binder);
  }
};

/// Empty when it is not enabled. Throws service::ConfigError for an `up` that is no direction.
std::optional<NavigationMap> make_navigation(const GridConfig& config);

/// Section `dense` of the configuration.
struct ServiceConfig {
  std::string out_dir;
  int every = 5;
  bool without_masks = false;
  std::string map_frame = "map";
  int publish_period_ms = 1000;
  int publish_max_points = 200000;
  int niceness = 0;
  GridConfig grid;
  DenseConfig core;

  void bind(auto& binder) {
    binder
        .field("out", out_dir,
               "folder for static_map.ply, map.pgm, map.yaml and map.bt, written at the end, and masks of keyframes; "
               "empty: none")
        .option("--out");
    binder.field("every", every, {1, 10000}, "one frame in so many is fused, and each keyframe");
    binder.field("without_masks", without_masks,
                 "also fuse frames without a mask from the filter: moving objects leave ghosts");
    binder.field("map_frame", map_frame, "frame of the published cloud");
    binder.field("publish_period_ms", publish_period_ms, {100, 600'000}, "between two clouds on rt/dense/points");
    binder.field("publish_max_points", publish_max_points, {100, 500'000},
                 "of a published cloud, 16 bytes each; for more points the cells get larger");
    binder.field("niceness", niceness, {0, 19},
                 "how far it steps back behind other programs once the first frame is fused and shown");
    binder.section("grid", grid);
    core.bind(binder);
  }
};

/// Images, the filter's masks and slam's poses in, a dense static cloud out. No other service ever waits for
/// it; frames that it has no time for are counted. Writes static_map.ply when it is asked to stop,
/// and the maps for navigation.
class DenseService {
 public:
  static constexpr const char* kName = "dense";
  static constexpr const char* kDescription = "Fuses depth images without what moves into a dense static map";
  using Config = ServiceConfig;

  DenseService(const Config& config, service::Runtime& runtime);
  DenseService(const DenseService&) = delete;
  DenseService& operator=(const DenseService&) = delete;
  service::ExitCode run();

 private:
  void integrate(const JoinedFrame& joined);
  void update(const std::vector<KeyframeUpdate>& updates);
  void write_masks();
  void count(const FusionReport& report);
  void publish_cloud();
  void publish_grid();
  void step_back();
  void forget_published_grid();
  void finish();
  bool ready();
  std::string trouble();
  void report_state();
  service::ExitCode write_files();
  bool write_cloud(const std::string& path);
  bool write_navigation_maps(const std::string& folder);

  const Config config_;
  service::Runtime& runtime_;
  StaticMap map_;
  std::optional<NavigationMap> navigation_;
  std::shared_ptr<FrameJoiner> joiner_;
  KeyframeMasks keyframe_masks_;
  bus::Writer<msg::PointCloud2> cloud_writer_;
  bus::Writer<msg::PointCloud2> moving_writer_;
  bus::Writer<msg::OccupancyGrid> grid_writer_;
  const std::shared_ptr<bus::SourceGate> camera_, filter_, slam_;
  bus::Reader<msg::KeyframeEvent> keyframe_reader_;
  bus::Reader<msg::TrackingResult> tracking_reader_;
  bus::Reader<msg::Image> mask_reader_;
  bus::FrameReader frame_reader_;

  struct Totals {
    std::uint64_t frames = 0, defective = 0, points = 0, masked = 0, refused = 0, carved = 0;
  } totals_;
  bool stepped_back_ = false;
  std::int64_t newest_stamp_ns_ = 0, published_ns_ = 0, updated_ns_ = 0, grid_published_ns_ = 0;
  NavigationGrid published_grid_;
  bool full_logged_ = false, grid_stale_ = false;
  service::RateLimit defect_log_{std::chrono::seconds(1)}, mask_log_{std::chrono::seconds(5)};
};

}  // namespace rtd::dense
