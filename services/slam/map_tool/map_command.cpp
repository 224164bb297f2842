// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/map_tool/map_command.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <ostream>

#include "common/service/command_line.hpp"
#include "common/service/exit_code.hpp"
#include "common/service/json_text.hpp"
#include "services/slam/map_file.hpp"
#include "services/slam/map_tool/map_report.hpp"

namespace rtd::map_tool {
namespace {

namespace fs = std::filesystem;

/// An error that the caller can fix; what() says how.
class UsageError : public std::runtime_error {
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
          "rtd map export: the file has {} maps, each in a frame of its own; exporting map {}, which has most "
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
  const std::vector<slam::MapPoint> points = points_of(contents, part.id);
  format == "pcd" ? write_pcd(out, points) : slam::write_ply(out, points);
}

/// Returns the exit code.
int write_export(const MapRequest& request, std::ostream& out, std::ostream& err) {
  if (fs::exists(request.out)) throw UsageError(request.out + " exists already: choose another name");
  const slam::MapContents contents = read(request.file, err);
  const MapReport report = report_on(contents, 0);
  const MapPart& part = choose(report, request.map_id, err);
  std::ofstream file(request.out);
  write_part(contents, part, request.format, file);
  file.close();
  if (!file) {
    std::error_code ignored;
    fs::remove(request.out, ignored);
    err << "rtd map export: cannot write " << request.out << ": check the folder and the free space\n";
    return service::kRunFailed;
  }
  out << fmt::format("{}: {} of map {}\n", request.out,
                     request.format == "tum" ? fmt::format("{} keyframe poses", part.keyframes)
                                             : fmt::format("{} landmarks", part.landmarks),
                     part.id);
  return service::kOk;
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
  CLI::App* to_export = app.add_subcommand("export", "Export landmarks as PLY or PCD, keyframe poses in TUM format");
  to_export->add_option("file", request.file, "Map file")->required();
  to_export->add_option("--format", request.format, "ply, pcd (landmarks) or tum (keyframe poses)")
      ->check(CLI::IsMember({"ply", "pcd", "tum"}))
      ->required();
  to_export->add_option("-o,--out", request.out, "New file; nothing is overwritten")->required();
  to_export->add_option("--map-id", request.map_id, "Map of the file (default: the one with most keyframes)")
      ->check(CLI::NonNegativeNumber);
  to_export->callback([&request] { request.to_export = true; });
  to_export->footer(kExitCodes);
}

int run_map(const MapRequest& request, std::ostream& out, std::ostream& err) {
  const std::string name = request.info ? "rtd map info" : "rtd map export";
  return service::report_errors<std::system_error, UsageError>(name, err, [&]() -> int {
    try {
      if (request.to_export) return write_export(request, out, err);
      print_info(request, out, err);
      return service::kOk;
    } catch (const slam::MapFileError& error) {
      err << name << ": " << error.what() << "\n";
      return error.defect() == slam::MapFileDefect::kDamaged ? service::kPartialLoss : service::kUsageOrConfig;
    }
  });
}

}  // namespace rtd::map_tool
