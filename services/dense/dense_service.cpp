// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/dense/dense_service.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <filesystem>

#include "common/concurrency/thread_priority.hpp"
#include "common/geometry/trajectory.hpp"
#include "common/io/atomic_file.hpp"
#include "common/io/text.hpp"
#include "common/msg/point_cloud.hpp"
#include "common/msg/transform_eigen.hpp"
#include "common/occupancy/grid_message.hpp"
#include "common/occupancy/octomap_file.hpp"
#include "common/service/config.hpp"
#include "common/service/metric_names.hpp"
#include "common/service/monotonic_clock.hpp"
#include "common/vision/image_codecs.hpp"
#include "common/vision/rgbd_image.hpp"

namespace rtd::dense {
namespace {

constexpr std::uint32_t kMaxSide = 4096;

constexpr std::chrono::milliseconds kStatePeriod{50};
constexpr std::size_t kMovesPerTick = 4;  // kept images that follow a correction while nothing else is to be done
constexpr std::int64_t kMaskPatienceNs = 3'000'000'000;  // for a filter that sends no masks

/// Calls write(); a failure is reported and false.
bool report_file(const std::string& path, const std::string& content, const std::function<void()>& write) {
  try {
    write();
    SPDLOG_INFO("event=file_written path={} {}", path, content);
    return true;
  } catch (const std::exception& error) {
    SPDLOG_ERROR("event=file_not_written path={} cause=\"{}\"", path, error.what());
    return false;
  }
}

/// Three numbers, "x,y,z". Throws service::ConfigError.
Eigen::Vector3d parse_up(const std::string& text) {
  if (text.empty()) return -Eigen::Vector3d::UnitY();
  Eigen::Vector3d up = Eigen::Vector3d::Zero();
  const std::vector<io::TextLine> lines = io::split_lines(text, ",");
  const bool three = lines.size() == 1 && lines[0].fields.size() == 3;
  for (std::size_t i = 0; three && i < 3; ++i) {
    up[static_cast<int>(i)] = io::parse_number(lines[0].fields[i]).value_or(std::nan(""));
  }
  if (three && up.allFinite() && up.norm() > 1e-3) return up;
  throw service::ConfigError("dense.grid.up=" + text + ": must be x,y,z, what points up in the map, e.g. 0,0,1");
}

}  // namespace

std::optional<DynamicMask> from_message(const msg::Image& message) {
  const bool sane = message.encoding == "mono8" && message.width > 0 && message.height > 0 &&
                    message.width <= kMaxSide && message.height <= kMaxSide && message.step >= message.width &&
                    message.data.size() >= std::size_t{message.step} * message.height;
  if (!sane) return std::nullopt;
  DynamicMask mask{static_cast<int>(message.width), static_cast<int>(message.height), {}};
  for (std::uint32_t row = 0; row < message.height; ++row) {
    const auto first = message.data.begin() + static_cast<std::ptrdiff_t>(std::size_t{row} * message.step);
    mask.cells.insert(mask.cells.end(), first, first + message.width);
  }
  return mask;
}

msg::PointCloud2 make_cloud(const std::vector<CloudPoint>& points, std::int64_t stamp_ns,
                            const std::string& map_frame) {
  std::vector<msg::CloudSlot> slots;
  slots.reserve(points.size());
  for (const CloudPoint& point : points) {
    const std::array<std::uint8_t, 4> bgra{to_byte(point.bgr[0]), to_byte(point.bgr[1]), to_byte(point.bgr[2]), 0};
    slots.push_back({point.p_world.x(), point.p_world.y(), point.p_world.z(), std::bit_cast<float>(bgra)});
  }
  return msg::make_cloud(slots, "rgb", stamp_ns, map_frame);
}

std::optional<NavigationMap> make_navigation(const GridConfig& config) {
  const Eigen::Vector3d up = parse_up(config.up);
  if (!config.enabled) return std::nullopt;
  return NavigationMap(config.core, up);
}

DenseService::DenseService(const Config& config, service::Runtime& runtime)
    : config_(config),
      runtime_(runtime),
      map_(config.core),
      navigation_(make_navigation(config.grid)),
      joiner_(std::make_shared<FrameJoiner>(
          FrameJoiner::Options{static_cast<std::uint64_t>(config.every), !config.without_masks})),
      cloud_writer_(runtime.bus.writer(bus::topics::kDensePoints)),
      moving_writer_(runtime.bus.writer(bus::topics::kMovingPoints)),
      grid_writer_(runtime.bus.writer(bus::topics::kOccupancyGrid)),
      camera_(service::follow_source("camera", runtime)),
      filter_(service::follow_source("filter", runtime)),
      slam_(service::follow_source("slam", runtime)) {
  runtime.stop.on_stop([joiner = joiner_] { joiner->close(); });
  keyframe_reader_ = runtime.bus.reader(
      bus::topics::kKeyframes,
      [this](const auto& event) {
        joiner_->put(*event);
        if (!config_.out_dir.empty()) keyframe_masks_.put(*event);
      },
      slam_->callbacks());
  tracking_reader_ = runtime.bus.reader(
      bus::topics::kTracking, [this](const auto& result) { joiner_->put(*result); }, slam_->callbacks());
  mask_reader_ = runtime.bus.reader(
      bus::topics::kDynamicMask,
      [this](const auto& message) {
        auto mask = from_message(*message);
        if (!mask) return;
        const std::int64_t stamp_ns = msg::to_ns(message->header.stamp);
        if (!config_.out_dir.empty()) keyframe_masks_.put(stamp_ns, *mask);
        joiner_->put(stamp_ns, std::move(*mask));
      },
      filter_->callbacks());
  frame_reader_ = bus::FrameReader(
      runtime.bus, [this](std::shared_ptr<const msg::FrameView> frame) { joiner_->put(std::move(frame)); },
      camera_->callbacks());
}

service::ExitCode DenseService::run() {
  while (!runtime_.stop.stop_requested()) {
    runtime_.heartbeat.tick();
    report_state();
    if (const auto joined = joiner_->take(kStatePeriod)) {
      integrate(*joined);
    } else if (navigation_) {
      navigation_->follow_corrections(kMovesPerTick);
    }
    write_masks();
    publish_cloud();
    publish_grid();
    step_back();
  }
  finish();
  return write_files();
}

void DenseService::integrate(const JoinedFrame& joined) {
  const service::TraceSpan span(runtime_.trace, "integrate", joined.result.seq);
  update(joined.updates);
  if (const std::string cause = vision::defect(*joined.frame); !cause.empty()) {
    ++totals_.defective;
    if (defect_log_.pass()) SPDLOG_WARN("event=frame_defective frame={} cause=\"{}\"", joined.result.seq, cause);
    return;
  }
  const vision::RgbdImage image = vision::view_image(*joined.frame);
  const DynamicMask mask = joined.mask.value_or(all_static());
  const Eigen::Isometry3d T_world_camera = msg::to_isometry(joined.result.T_world_camera);
  const FusionReport report = map_.integrate(image, mask, T_world_camera);
  if (report.outcome != FusionReport::Outcome::kFused) {
    ++totals_.defective;
    if (defect_log_.pass()) {
      SPDLOG_WARN("event=frame_not_fused frame={} cause=\"{}\"", joined.result.seq,
                  report.outcome == FusionReport::Outcome::kBadPose ? "pose is not finite" : "image or mask unusable");
    }
    return;
  }
  if (navigation_) navigation_->integrate(image, T_world_camera);
  grid_stale_ = true;
  newest_stamp_ns_ = joined.result.stamp_ns;
  count(report);
}

/// For `rtd export`: a run whose masks cannot be written is complete otherwise.
void DenseService::write_masks() {
  const std::filesystem::path folder = std::filesystem::path(config_.out_dir) / "masks";
  for (const auto& [stamp_ns, mask] : keyframe_masks_.take()) {
    DynamicMask wide = grow(mask, config_.core.fusion.mask_grow_cells);
    const cv::Mat cells(wide.rows, wide.columns, CV_8U, wide.cells.data());
    std::error_code ignored;  // the write names the cause
    std::filesystem::create_directories(folder, ignored);
    try {
      vision::write_image(folder / (geometry::tum_stamp(stamp_ns) + ".png"), cells, {.durable = false});
    } catch (const io::IoError& error) {
      if (mask_log_.pass()) SPDLOG_WARN("event=mask_not_written cause=\"{}\"", error.what());
    }
  }
}

void DenseService::update(const std::vector<KeyframeUpdate>& updates) {
  for (const KeyframeUpdate& update : updates) {
    if (update.new_map) {
      SPDLOG_WARN("event=map_restarted voxels_forgotten={} cause=\"slam was restarted\"", map_.voxels());
      map_.clear();
      if (navigation_) navigation_->clear();
    }
    map_.update(update.event);
    if (navigation_) navigation_->update(update.event);
  }
}

void DenseService::count(const FusionReport& report) {
  ++totals_.frames;
  totals_.points += report.fused;
  totals_.masked += report.masked;
  totals_.refused += report.refused;
  totals_.carved += report.carved;
  if (map_.full() && !full_logged_) {
    full_logged_ = true;
    SPDLOG_WARN(
        "event=map_full voxels={} effect=\"only known surfaces are refined\" fix=\"dense.fusion.max_voxels or "
        "a larger dense.fusion.voxel_m\"",
        map_.voxels());
  }
}

/// Not earlier: on a busy computer people would wait long for their first look at the room.
void DenseService::step_back() {
  if (totals_.frames == 0 || std::exchange(stepped_back_, true)) return;
  concurrency::lower_process_priority(config_.niceness);
}

/// Costs nothing without subscribers.
void DenseService::publish_cloud() {
  const std::int64_t now_ns = service::monotonic_ns();
  const bool due = now_ns - published_ns_ >= std::int64_t{config_.publish_period_ms} * 1'000'000;
  const bool read = cloud_writer_.matched() > 0, moving_read = moving_writer_.matched() > 0;
  if (!due || totals_.frames == 0 || !(read || moving_read)) return;
  published_ns_ = now_ns;
  const std::string frame = runtime_.bus.frame(config_.map_frame);
  const bool shown = !joiner_->elsewhere();  // none in another map: they would be shown where they are not
  const auto most = static_cast<std::size_t>(config_.publish_max_points);
  using Points = std::vector<CloudPoint>;
  if (read) cloud_writer_.write(make_cloud(shown ? map_.cloud(most) : Points(), newest_stamp_ns_, frame));
  if (moving_read) moving_writer_.write(make_cloud(shown ? map_.moving() : Points(), newest_stamp_ns_, frame));
}

/// Costs nothing without subscribers, and nothing while nothing changes.
void DenseService::publish_grid() {
  const std::int64_t now_ns = service::monotonic_ns();
  const bool due = now_ns - grid_published_ns_ >= std::int64_t{config_.grid.publish_period_ms} * 1'000'000;
  if (!navigation_ || !due || grid_writer_.matched() == 0) return;
  if (joiner_->elsewhere()) return forget_published_grid();
  if (!grid_stale_) return;
  const service::TraceSpan span(runtime_.trace, "grid", totals_.frames);
  grid_published_ns_ = now_ns;
  grid_stale_ = !navigation_->follow_corrections(kMovesPerTick);
  std::optional<NavigationGrid> grid = navigation_->grid(map_);
  if (!grid || grid->cells.empty() || *grid == published_grid_) return;
  const std::string frame = runtime_.bus.frame(config_.map_frame);
  grid_writer_.write(make_grid(*grid, navigation_->R_grid_map(), newest_stamp_ns_, frame));
  published_grid_ = std::move(*grid);
}

/// Nothing is known about another map. Readers keep the last plan: it is taken back.
void DenseService::forget_published_grid() {
  constexpr auto is_unknown = [](std::int8_t cell) { return cell == NavigationGrid::kUnknown; };
  if (std::ranges::all_of(published_grid_.cells, is_unknown)) return;
  std::ranges::fill(published_grid_.cells, NavigationGrid::kUnknown);
  grid_writer_.write(
      make_grid(published_grid_, navigation_->R_grid_map(), newest_stamp_ns_, runtime_.bus.frame(config_.map_frame)));
  grid_stale_ = true;
}

/// What has come is worked off, and slam's last corrections are followed.
void DenseService::finish() {
  joiner_->close();
  while (const auto joined = joiner_->take(std::chrono::milliseconds(0))) integrate(*joined);
  write_masks();
  update(joiner_->take_updates());
  report_state();
  const JoinCounters joins = joiner_->counters();
  SPDLOG_INFO(
      "event=summary frames={} voxels={} points_fused={} points_masked={} points_refused={} voxels_carved={} "
      "without_image={} without_mask={} not_tracked={} defective={}",
      totals_.frames, map_.voxels(), totals_.points, totals_.masked, totals_.refused, totals_.carved,
      joins.without_image, joins.without_mask, joins.not_tracked, totals_.defective);
}

/// An older filter sends no masks: that must not keep the camera waiting.
bool DenseService::ready() {
  const bool connected =
      frame_reader_.matched() > 0 && tracking_reader_.matched() > 0 && keyframe_reader_.matched() > 0;
  const std::int64_t now_ns = service::monotonic_ns();
  if (!connected) updated_ns_ = now_ns;
  return connected && (mask_reader_.matched() > 0 || now_ns - updated_ns_ > kMaskPatienceNs);
}

/// Why the service does less than it should; empty when it does not.
std::string DenseService::trouble() {
  const JoinCounters joins = joiner_->counters();
  if (joins.without_mask > 0 && mask_reader_.matched() == 0) {
    if (mask_log_.pass()) SPDLOG_WARN("event=no_masks frames={} fix=\"a newer rtd-filter\"", joins.without_mask);
    return "no masks from the filter: nothing is fused (dense.without_masks: true fuses all)";
  }
  if (map_.full()) return "map full: only known surfaces are refined (dense.fusion.max_voxels)";
  if (navigation_ && navigation_->space().full())
    return "floor plan full: no more space becomes free (dense.grid.max_blocks, dense.grid.max_scans)";
  if (published_grid_.cropped) return "floor plan cropped: it has no room for all (dense.grid.max_cells)";
  return {};
}

void DenseService::report_state() {
  const JoinCounters joins = joiner_->counters();
  service::Heartbeat& heartbeat = runtime_.heartbeat;
  heartbeat.set_metric(service::metric::kFrames, static_cast<double>(totals_.frames));
  heartbeat.set_metric(service::metric::kFramesWithoutImage, static_cast<double>(joins.without_image));
  heartbeat.set_metric(service::metric::kFramesWithoutMask, static_cast<double>(joins.without_mask));
  heartbeat.set_metric(service::metric::kFramesNotTracked, static_cast<double>(joins.not_tracked));
  heartbeat.set_metric(service::metric::kFramesDefective, static_cast<double>(totals_.defective));
  heartbeat.set_metric(service::metric::kVoxels, static_cast<double>(map_.voxels()));
  heartbeat.set_metric(service::metric::kVoxelsCarved, static_cast<double>(totals_.carved));
  heartbeat.set_metric(service::metric::kPointsWithoutRoom, static_cast<double>(totals_.refused));
  const std::string message = trouble();
  if (!message.empty()) return heartbeat.set_state(msg::ServiceState::kDegraded, message);
  if (totals_.frames > 0) return heartbeat.set_state(msg::ServiceState::kRunning);
  const bool all = ready();
  heartbeat.set_state(all ? msg::ServiceState::kReady : msg::ServiceState::kStarting,
                      all ? "" : "waits for a camera, a filter and slam");
}

service::ExitCode DenseService::write_files() {
  if (config_.out_dir.empty()) return service::kOk;
  const std::filesystem::path folder = config_.out_dir;
  std::error_code ignored;  // an existing folder is fine, an impossible one shows when the files are written
  std::filesystem::create_directories(folder, ignored);
  const bool written =
      write_cloud((folder / "static_map.ply").string()) && (!navigation_ || write_navigation_maps(folder.string()));
  return written ? service::kOk : service::kRunFailed;
}

bool DenseService::write_cloud(const std::string& path) {
  const std::vector<CloudPoint> points = map_.cloud();
  return report_file(path, fmt::format("points={}", points.size()),
                     [&] { io::write_file(path, [&](std::ostream& file) { write_ply(file, points); }); });
}

/// No plan is written as long as the floor is unknown, and nothing when no frame was fused.
bool DenseService::write_navigation_maps(const std::string& folder) {
  if (totals_.frames == 0) return true;
  navigation_->follow_corrections();
  const Volume volume = navigation_->volume(map_);
  const auto write = [&folder](const char* name, const std::string& content, const auto& write_to) {
    const std::string path = folder + '/' + name;
    return report_file(path, content, [&] { io::write_file(path, std::function<void(std::ostream&)>(write_to)); });
  };
  const std::string left_out = occupancy::octomap_left_out();
  if (!left_out.empty()) SPDLOG_WARN("event=file_left_out path={}/map.bt cause=\"{}\"", folder, left_out);
  bool written =
      !left_out.empty() || write("map.bt", fmt::format("cell_m={} blocks={}", volume.cell_m, volume.cells.blocks()),
                                 [&](std::ostream& file) { write_octomap(file, volume); });
  const std::optional<NavigationGrid> grid = navigation_->grid(volume);
  if (!grid || grid->cells.empty()) {
    SPDLOG_WARN("event=no_floor_plan cause=\"no floor was seen\" fix=\"dense.grid.find_floor, dense.grid.floor_m\"");
    return written;
  }
  const std::string content =
      fmt::format("columns={} rows={} floor_m={:.3f}", grid->columns, grid->rows, grid->floor_m);
  written = write("map.pgm", content, [&](std::ostream& file) { write_pgm(file, *grid); }) && written;
  return write("map.yaml", content, [&](std::ostream& file) { file << map_yaml(*grid, "map.pgm"); }) && written;
}

}  // namespace rtd::dense
