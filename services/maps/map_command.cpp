// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/maps/map_command.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <functional>
#include <ostream>

#include "common/io/atomic_file.hpp"
#include "common/io/input_file.hpp"
#include "common/map_page/map_page.hpp"
#include "common/occupancy/octomap_file.hpp"
#include "common/service/command_line.hpp"
#include "common/service/exit_code.hpp"
#include "common/service/json_text.hpp"
#include "services/maps/map_report.hpp"

namespace rtd::maps {
namespace {

namespace fs = std::filesystem;

/// An error that the caller can fix; what() says how.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class WriteError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

slam::MapContents read(const std::string& file, std::ostream& err) {
  std::error_code unknown;  // the reader reports errors of the file
  service::Progress progress(err, "reading", fs::is_regular_file(file, unknown) ? fs::file_size(file, unknown) : 0);
  slam::MapReadOptions options;
  options.features = slam::StoredFeatures::kSkip;
  options.on_progress = [&](std::uint64_t bytes) { progress.reach(bytes); };
  return slam::load_map_file(file, options);
}

void print_info(const MapRequest& request, std::ostream& out, std::ostream& err) {
  const slam::MapContents contents = read(request.file, err);
  const MapReport report = report_on(contents, fs::file_size(request.file));
  out << (request.json ? service::json_text(to_json(report, request.file)) + '\n' : to_text(report, request.file));
}

/// The requested map.
const MapPart& choose(const MapReport& report, long long id, std::ostream& err) {
  const auto& maps = report.maps;
  if (id < 0) {
    const auto largest = std::ranges::max_element(maps, {}, &MapPart::keyframes);
    if (maps.size() > 1)
      err << fmt::format(
          "rtd map export: the file has {} maps, each in its own frame; exporting map {}, which has most "
          "keyframes (--map-id chooses another)\n",
          maps.size(), largest->id);
    return *largest;
  }
  const auto found = std::ranges::find_if(maps, [&](const auto& part) { return part.id == id; });
  if (found == maps.end()) throw UsageError(fmt::format("--map-id {}: no such map, 'rtd map info' lists all", id));
  return *found;
}

void write_part(const slam::MapContents& contents, const MapPart& part, const std::string& format, std::ostream& out) {
  if (format == "tum") return geometry::write_tum_trajectory(out, poses_of(contents, part.id));
  if (format == "bt") return occupancy::write_octomap(out, voxels_of(contents, part.id));
  const std::vector<slam::MapPoint> points = points_of(contents, part.id);
  format == "pcd" ? write_pcd(out, points) : slam::write_ply(out, points);
}

/// Writes with write_to(stream); nothing is left of a file that could not be written. Throws WriteError.
void write_file(const std::string& path, const std::function<void(std::ostream&)>& write_to) {
  try {
    io::write_file(path, write_to, {.named_by = io::NamedBy::kOperator});
  } catch (const io::IoError& error) {
    throw WriteError(std::string("cannot write ") + error.what());
  }
}

bool is_octomap(const std::string& path) {
  constexpr std::string_view kBegin = "# Octomap";
  io::InputStream file(path);
  std::string begin(kBegin.size(), '\0');
  return file.read(begin.data(), kBegin.size()) && begin == kBegin;
}

/// The middles of occupied cells.
std::vector<slam::MapPoint> occupied_of(const occupancy::Volume& volume) {
  std::vector<slam::MapPoint> points;
  volume.cells.for_each([&](const Eigen::Vector3i& cell, occupancy::Space space) {
    const Eigen::Vector3d middle = volume.cell_m * (cell.cast<double>().array() + 0.5);
    if (space == occupancy::Space::kOccupied) points.push_back({middle.cast<float>(), 1.0F});
  });
  return points;
}

/// The floor plan of a voxel map, with its YAML file.
void write_plan(const MapRequest& request, const occupancy::Volume& volume, const std::vector<slam::MapPoint>& occupied,
                std::ostream& out) {
  const std::string yaml = fs::path(request.out).replace_extension(".yaml").string();
  if (yaml == request.out || fs::exists(yaml)) throw UsageError(yaml + " exists already: choose another name");
  occupancy::FloorFinder finder;
  for (const slam::MapPoint& point : occupied) finder.add(static_cast<double>(point.position.z()));
  const std::optional<double> floor_m = request.floor_m ? request.floor_m : finder.floor_m(1e9);
  if (!floor_m) throw UsageError(request.file + " has no occupied cell: give the height of the floor with --floor");
  constexpr std::size_t kMaxCells = 100'000'000;
  const occupancy::NavigationGrid grid = occupancy::project(volume, *floor_m, request.heights, kMaxCells);
  if (grid.cells.empty())
    throw UsageError(fmt::format("nothing is known just above the floor at {:.2f} m: --floor names another", *floor_m));
  const auto name = fs::path(request.out).filename().string();
  write_file(request.out, [&](std::ostream& file) { occupancy::write_pgm(file, grid); });
  write_file(yaml, [&](std::ostream& file) { file << occupancy::map_yaml(grid, name); });
  out << fmt::format("{}, {}: {} x {} cells, floor at {:.2f} m\n", request.out, yaml, grid.columns, grid.rows,
                     *floor_m);
}

/// Of a voxel map (.bt).
void export_voxels(const MapRequest& request, std::ostream& out) {
  if (request.format == "tum" || request.format == "bt" || request.format == "html")
    throw UsageError(request.file + " is a voxel map: it is exported as pgm, ply or pcd");
  io::InputStream file(request.file);
  const occupancy::Volume volume = occupancy::read_octomap(file);
  const std::vector<slam::MapPoint> occupied = occupied_of(volume);
  if (request.format == "pgm") return write_plan(request, volume, occupied, out);
  write_file(request.out, [&](std::ostream& to) {
    request.format == "pcd" ? write_pcd(to, occupied) : slam::write_ply(to, occupied);
  });
  out << fmt::format("{}: {} occupied cells\n", request.out, occupied.size());
}

/// Red where a landmark may move, blue where it stays.
map_page::Color color_of(float static_probability) {
  const auto level = static_cast<std::uint8_t>(255 * std::clamp(static_probability, 0.0F, 1.0F));
  return {static_cast<std::uint8_t>(255 - level / 2), 120, level};
}

/// Landmarks, coloured by how certainly they stay, and the path of the keyframes.
void write_page(const MapRequest& request, const slam::MapContents& contents, const MapPart& part, std::ostream& out) {
  map_page::Layer landmarks{.name = "Landmarks"};
  for (const slam::MapPoint& point : points_of(contents, part.id)) {
    landmarks.points_m.push_back(point.position);
    landmarks.colors.push_back(color_of(point.static_probability));
  }
  map_page::Layer path{.name = "Path of the keyframes", .line = true, .color = {63, 208, 127}};
  for (const geometry::StampedPose& pose : poses_of(contents, part.id))
    path.points_m.push_back(pose.T_world_body.translation().cast<float>());
  const map_page::Page page{.title = fs::path(request.file).filename().string(),
                            .facts = {{"Map", std::to_string(part.id)},
                                      {"Keyframes", std::to_string(part.keyframes)},
                                      {"Landmarks", std::to_string(part.landmarks)}},
                            .layers = {std::move(landmarks), std::move(path)}};
  write_file(request.out, [&](std::ostream& file) { file << map_page::html(page); });
  out << fmt::format("{}: {} landmarks of map {}, to open in a browser\n", request.out, part.landmarks, part.id);
}

void write_export(const MapRequest& request, std::ostream& out, std::ostream& err) {
  if (const std::string left_out = occupancy::octomap_left_out(); request.format == "bt" && !left_out.empty())
    throw UsageError(left_out);
  if (fs::exists(request.out)) throw UsageError(request.out + " exists already: choose another name");
  if (is_octomap(request.file)) return export_voxels(request, out);
  if (request.format == "pgm")
    throw UsageError(request.file +
                     " holds landmarks, which are too few for a floor plan: 'rtd run --dense' writes one, "
                     "and map.bt, from which this command makes others");
  const slam::MapContents contents = read(request.file, err);
  const MapReport report = report_on(contents, 0);
  const MapPart& part = choose(report, request.map_id, err);
  if (request.format == "bt")
    err << "rtd map export: surfaces without landmarks are missing in this voxel map; 'rtd run --dense' writes a full "
           "one, map.bt\n";
  if (request.format == "html") return write_page(request, contents, part, out);
  write_file(request.out, [&](std::ostream& file) { write_part(contents, part, request.format, file); });
  out << fmt::format("{}: {} of map {}\n", request.out,
                     request.format == "tum" ? fmt::format("{} keyframe poses", part.keyframes)
                                             : fmt::format("{} landmarks", part.landmarks),
                     part.id);
}

constexpr const char* kExitCodes =
    "Exit code: 0 done, 1 the output cannot be written, 2 the file cannot be read or is not a map of this version, "
    "3 the file is damaged";

}  // namespace

void add_map_commands(CLI::App& app, MapRequest& request) {
  app.require_subcommand(1);
  CLI::App* info = app.add_subcommand("info", "Show keyframes, landmarks, maps, extent, path, time, camera, checksums");
  info->add_option("file", request.file, "Map file")->required();
  info->add_flag("--json", request.json, "Print JSON instead of text");
  info->callback([&request] { request.info = true; });
  info->footer(kExitCodes);
  CLI::App* to_export = app.add_subcommand("export",
                                           "Export landmarks as page, PLY, PCD or OctoMap, keyframe poses in TUM "
                                           "format; voxel maps (.bt) as floor plan, PLY or PCD");
  to_export->add_option("file", request.file, "Map file, or a voxel map of rtd-dense (map.bt)")->required();
  to_export
      ->add_option("--format", request.format,
                   "html (to look at in a browser), ply, pcd (landmarks, occupied cells), tum (keyframe poses), bt "
                   "(OctoMap of the landmarks) or pgm (floor plan of a voxel map, with a YAML file next to it)")
      ->check(CLI::IsMember({"html", "ply", "pcd", "tum", "bt", "pgm"}))
      ->required();
  to_export->add_option("-o,--out", request.out, "New file; nothing is overwritten")->required();
  to_export->add_option("--map-id", request.map_id, "Map of the file (default: the one with most keyframes)")
      ->check(CLI::NonNegativeNumber);
  to_export->add_option("--floor", request.floor_m, "Of pgm: height of the floor, m (default: found)");
  to_export->add_option("--min-height", request.heights.min_height_m, "Of pgm: what is not higher is floor, m")
      ->check(CLI::Range(0.0, 10.0))
      ->capture_default_str();
  to_export->add_option("--max-height", request.heights.max_height_m, "Of pgm: height of the robot, m")
      ->check(CLI::Range(0.0, 100.0))
      ->capture_default_str();
  to_export->callback([&request] { request.to_export = true; });
  to_export->footer(kExitCodes);
}

int run_map(const MapRequest& request, std::ostream& out, std::ostream& err) {
  const std::string name = request.info ? "rtd map info" : "rtd map export";
  return service::report_errors<std::system_error, UsageError>(name, err, [&]() -> int {
    try {
      request.to_export ? write_export(request, out, err) : print_info(request, out, err);
      return service::kOk;
    } catch (const WriteError& error) {
      err << name << ": " << error.what() << '\n';
      return service::kRunFailed;
    } catch (const occupancy::OctomapError& error) {
      err << name << ": " << request.file << ": " << error.what() << "\n";
      return service::kPartialLoss;
    } catch (const slam::MapFileError& error) {
      err << name << ": " << error.what() << "\n";
      return error.defect() == slam::MapFileDefect::kDamaged ? service::kPartialLoss : service::kUsageOrConfig;
    }
  });
}

}  // namespace rtd::maps
