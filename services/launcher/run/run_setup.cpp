// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/launcher/run/run_setup.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <sstream>

#include "common/camera/live_uri.hpp"
#include "common/camera/source_factory.hpp"
#include "common/io/atomic_file.hpp"
#include "common/msg/filter_modes.hpp"
#include "common/msg/services.hpp"
#include "common/process/executable.hpp"
#include "common/process/out_folder.hpp"
#include "common/service/bus_config.hpp"
#include "common/service/model_locator.hpp"
#include "common/service/pacer.hpp"

namespace rtd::launcher {
namespace fs = std::filesystem;
using service::ConfigError;
namespace {

/// In realtime no process waits for the detector, so it only gets the processor time that the pose does not need.
constexpr int kRealtimeNiceness = 10;

void check_sections(const std::vector<std::string>& overrides) {
  const std::vector<std::string>& sections = service::config_sections();
  for (const std::string& assignment : overrides) {
    const std::string section = assignment.substr(0, assignment.find_first_of(".="));
    if (std::ranges::count(sections, section) > 0) continue;
    const std::string near = service::nearest_name(section, sections);
    throw ConfigError(fmt::format("--set {}: unknown section '{}'{}", assignment, section,
                                  near.empty() ? "" : fmt::format(", did you mean '{}'?", near)));
  }
}

/// The launcher reads its own sections; the services check theirs when they start.
void load_config(RunSetup& setup) {
  service::BusConfig bus;
  service::ConfigBinder binder;
  binder.section("bus", bus);
  binder.section("launcher", setup.launcher);
  check_sections(setup.overrides);
  service::load_config(binder, setup.bus, {setup.config_file, setup.overrides});
  setup.bus_options = service::to_bus_options(bus, "rtd");
}

/// A service that is not named uses the vendor of --dds.
void choose_vendors(RunSetup& setup) {
  std::vector<std::string> services;
  for (const msg::NamedService& service : msg::kServices) {
    if (service.started_by_run) services.emplace_back(service.name);
  }
  const std::vector<std::string> vendors = bus::dds_vendors();
  for (const std::string& pair : setup.dds_of) {
    const std::size_t equals = pair.find('=');
    const std::string name = pair.substr(0, equals);
    const std::string vendor = equals == std::string::npos ? "" : pair.substr(equals + 1);
    if (std::ranges::count(services, name) == 0 || std::ranges::count(vendors, vendor) == 0) {
      throw ConfigError(fmt::format("--dds-of {}: write SERVICE=VENDOR with a service of {} and a vendor of {}", pair,
                                    fmt::join(services, ", "), fmt::join(vendors, ", ")));
    }
    if (setup.bus_options.security.enabled() && vendor != setup.bus_options.vendor) {
      throw ConfigError(
          fmt::format("--secure with --dds-of {}: {} and {} cannot agree on keys, a secured domain needs one vendor; "
                      "leave out one of the two options",
                      pair, setup.bus_options.vendor, vendor));
    }
    setup.vendors_of[name] = vendor;
  }
}

/// The value of another service's key as that service will see it; empty when neither --set nor the file names it.
std::string peek(const RunOptions& options, const std::string& section, const std::string& key) {
  const std::string prefix = section + "." + key + "=";
  for (auto assignment = options.overrides.rbegin(); assignment != options.overrides.rend(); ++assignment) {
    if (assignment->starts_with(prefix)) return assignment->substr(prefix.size());
  }
  if (options.config_file.empty()) return {};
  try {
    YAML::Node node = YAML::LoadFile(options.config_file)[section];
    if (node[key]) return node[key].as<std::string>();
    std::istringstream parts(key);  // "base.camera" may also be a section of its own
    for (std::string part; std::getline(parts, part, '.');) node.reset(node[part]);
    return node.as<std::string>();
  } catch (const YAML::Exception&) {
    return {};  // the service that owns the key reports the error
  }
}

std::string choose_filter_mode(const RunOptions& options) {
  std::string mode = options.filter_mode.empty() ? peek(options, "filter", "mode") : options.filter_mode;
  if (mode.empty()) mode = "rtd";
  if (msg::find_filter_mode(mode) == nullptr) {
    throw ConfigError(
        fmt::format("--filter: unknown mode '{}', use one of {}", mode, fmt::join(msg::filter_mode_names(), ", ")));
  }
  return mode;
}

std::uint64_t count_frames(const std::string& uri, std::uint64_t limit) {
  if (camera::is_live(uri)) {
    camera::check_live_uri(uri);
    return limit;
  }
  const std::uint64_t frames = camera::make_source(uri)->info().frames;
  if (limit == 0) return frames;
  return frames == 0 ? limit : std::min(frames, limit);
}

void choose_detector(RunSetup& setup) {
  if (setup.replay) {
    setup.detector_note = setup.replay.features ? "off (recorded features)" : "recorded boxes";
    return;
  }
  if (msg::find_filter_mode(setup.filter_mode)->boxes == msg::BoxUse::kNone) {
    setup.detector_note = "off (filter mode " + setup.filter_mode + ")";
    return;
  }
  if (setup.detector == "off") {
    setup.detector_note = "off (as requested)";
    return;
  }
  if (setup.detector == "remote") {
    // A link brings the boxes to a robot whose own domain is limited to its host.
    if (setup.bus_options.network.loopback_only && setup.bus_options.robot.empty())
      throw ConfigError(
          "--detector remote: the bus is limited to this host, add --profile lan or wifi (docs/two-hosts.md), or use "
          "rtd link and --robot NAME (docs/gpu-box.md)");
    setup.remote_detector = true;
    setup.detector_note = "on another host";
    return;
  }
  std::string configured = setup.model.empty() ? peek(setup, "detector", "model") : setup.model;
  if (!setup.model.empty() && fs::is_regular_file(setup.model)) configured = fs::absolute(setup.model).string();
  const service::ModelSearch model = service::find_model(configured, service::process_environment());
  if (!model && !configured.empty()) throw ConfigError(model.message);
  setup.model_path = model.path;
  setup.weights_advice = model.message;
  setup.detector_note = model ? fs::path(model.path).filename().string() : "off (no weights)";
}

ServicePlan plan(const RunSetup& setup, const std::string& name, ServiceRole role,
                 const std::vector<std::string>& own_arguments) {
  ServicePlan plan{name, {process::require_executable("rtd-" + name), "--pace", setup.pace}, role};
  const auto add = [&plan](const std::vector<std::string>& words) {
    plan.command.insert(plan.command.end(), words.begin(), words.end());
  };
  service::BusArguments bus = setup.bus;
  if (const auto own = setup.vendors_of.find(name); own != setup.vendors_of.end()) bus.vendor = own->second;
  add(service::to_command_line(bus));
  if (!setup.config_file.empty()) add({"--config", setup.config_file});
  for (const std::string& assignment : setup.overrides) add({"--set", assignment});
  add(own_arguments);
  return plan;
}

void choose_map(RunSetup& setup) {
  if (!setup.map.empty() && fs::is_directory(setup.map))
    throw ConfigError("--map " + setup.map + ": this is a folder: name a map file in it");
  if (!setup.map.empty() && !fs::is_regular_file(setup.map)) throw ConfigError("--map " + setup.map + ": no such file");
  if (setup.localize_only && setup.map.empty())
    throw ConfigError("--localize-only needs a map: give its file with --map");
  if (setup.localize_only && !setup.save_map.empty())
    throw ConfigError("--save-map " + setup.save_map + ": with --localize-only the map does not change");
  if (setup.save_map.empty()) setup.save_map = peek(setup, "slam", "map.save");
  setup.save_map_asked = !setup.save_map.empty();
  const bool map_stays = setup.localize_only || peek(setup, "slam", "map.localize_only") == "true";
  if (setup.save_map.empty() && !map_stays) setup.save_map = setup.out_dir + "/map.rtdmap";
}

/// A restarted slam continues with the map of its last checkpoint. A file of an earlier run does not count.
std::function<std::vector<std::string>()> load_checkpoint(const std::string& save_map) {
  if (save_map.empty()) return {};
  const auto saved_at = [save_map] {
    std::error_code missing;
    const auto time = fs::last_write_time(save_map, missing);
    return missing ? std::optional<fs::file_time_type>() : time;
  };
  return [save_map, saved_at, before = saved_at()]() -> std::vector<std::string> {
    const auto now = saved_at();
    if (!now || now == before) return {};
    return {"--map", save_map};
  };
}

std::vector<std::string> slam_arguments(const RunSetup& setup) {
  std::vector<std::string> arguments = {"--out", setup.out_dir};
  if (!setup.map.empty()) arguments.insert(arguments.end(), {"--map", setup.map});
  if (!setup.save_map.empty()) arguments.insert(arguments.end(), {"--save-map", setup.save_map});
  if (!setup.maps_dir.empty()) arguments.insert(arguments.end(), {"--maps-dir", setup.maps_dir});
  if (!setup.base_frame.empty()) arguments.insert(arguments.end(), {"--base-frame", setup.base_frame});
  if (!setup.camera_in_base.empty()) arguments.push_back("--camera-in-base=" + setup.camera_in_base);
  if (!setup.gravity.empty()) arguments.insert(arguments.end(), {"--gravity", setup.gravity});
  if (!setup.imu.empty()) arguments.insert(arguments.end(), {"--imu", setup.imu});
  if (!setup.wheel_odometry.empty()) arguments.insert(arguments.end(), {"--wheel-odometry", setup.wheel_odometry});
  if (setup.localize_only) arguments.emplace_back("--localize-only");
  return arguments;
}

/// With the base of the robot slam's map has z up.
std::vector<std::string> dense_arguments(const RunSetup& setup) {
  std::vector<std::string> arguments = {"--out", setup.out_dir};
  const std::string gravity = setup.gravity.empty() ? peek(setup, "slam", "base.gravity") : setup.gravity;
  const bool turned = !gravity.empty() && gravity != "level" && gravity != "told";  // `told`: former name of `level`
  const bool z_up = !setup.camera_in_base.empty() || !peek(setup, "slam", "base.camera").empty() || turned;
  if (z_up && peek(setup, "dense", "grid.up").empty()) arguments.emplace_back("--up=0,0,1");
  return arguments;
}

std::vector<std::string> detector_arguments(const RunSetup& setup) {
  std::vector<std::string> arguments = {"--set", "detector.model=" + setup.model_path};
  if (!setup.engine.empty()) arguments.insert(arguments.end(), {"--engine", setup.engine});
  return arguments;
}

std::vector<std::string> filter_arguments(const RunSetup& setup) {
  std::vector<std::string> arguments = {"--set", "filter.mode=" + setup.filter_mode};
  if (setup.model_path.empty() && !setup.replay.detections && !setup.remote_detector)
    arguments.insert(arguments.end(), {"--set", "filter.detector=off"});
  return arguments;
}

std::vector<std::string> camera_arguments(const RunSetup& setup, const std::vector<std::string>& wait_for) {
  std::vector<std::string> arguments = {"--source",          setup.source,
                                        "--wait-for",        fmt::format("{}", fmt::join(wait_for, ",")),
                                        "--groundtruth-out", setup.groundtruth_path()};
  if (setup.frames > 0) arguments.insert(arguments.end(), {"--frames", std::to_string(setup.frames)});
  return arguments;
}

void check_trace_file(const std::string& path) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) throw ConfigError("--trace " + path + ": this is a folder: name a file in it");
  try {
    const io::AtomicFile begun(path, {.named_by = io::NamedBy::kOperator});
  } catch (const io::IoError& error) {
    throw ConfigError(std::string("--trace ") + error.what());
  }
}

}  // namespace

RunSetup prepare_run(const RunOptions& options) {
  RunSetup setup(options);
  load_config(setup);
  choose_vendors(setup);
  setup.pace = service::to_string(service::parse_pace(setup.pace));
  setup.filter_mode = choose_filter_mode(setup);
  setup.source = camera::complete_uri(setup.source);
  setup.replay = choose_replay(setup, setup.bus_options.robot);
  if (setup.replay) setup.bus.robot = setup.bus_options.robot = setup.replay.robot;
  setup.total_frames = setup.replay ? setup.replay.frames : count_frames(setup.source, setup.frames);
  choose_detector(setup);
  choose_map(setup);
  process::make_out_folder(setup.out_dir);
  if (!setup.trace.empty()) check_trace_file(setup.trace);
  if (fs::exists(setup.record)) throw ConfigError("--record " + setup.record + " exists already: choose another name");
  return setup;
}

void clear_out_dir(const RunSetup& setup) {
  const fs::path out_dir = setup.out_dir;
  io::remove_unfinished(out_dir);
  std::error_code error;
  const fs::path map = out_dir / "map.rtdmap";
  const bool needed = !setup.map.empty() && fs::equivalent(setup.map, map, error);  // --map of an earlier run here
  error.clear();
  if (!needed) fs::remove(map, error);
  for (const char* left : {"logs", "trace", "trajectory.txt", "trajectory_online.txt", "keyframes.txt", "map.ply",
                           "static_map.ply", "map.pgm", "map.yaml", "map.bt", "background.png", "groundtruth.txt",
                           "run.json", "report.json", "report.html"}) {
    if (!error) fs::remove_all(out_dir / left, error);
  }
  if (!error) fs::create_directories(out_dir / "logs", error);
  if (!error && !setup.trace.empty()) fs::create_directories(setup.trace_folder(), error);
  if (error) throw ConfigError("--out " + setup.out_dir + ": cannot be written: " + error.message());
}

std::vector<ServicePlan> plan_services(const RunSetup& setup) {
  std::vector<ServicePlan> plans;
  const bool detector = !setup.model_path.empty(), filter = !setup.replay.features;
  if (!setup.record.empty()) {
    // Restarted, it continues in a second file; an earlier recording is refused before the run starts.
    plans.push_back(plan(setup, "record", ServiceRole::kOptional, {"-o", setup.record, "--beside"}));
    plans.back().ends_last = true;
  }
  if (detector) plans.push_back(plan(setup, "detector", ServiceRole::kOptional, detector_arguments(setup)));
  if (filter) plans.push_back(plan(setup, "filter", ServiceRole::kEssential, filter_arguments(setup)));
  plans.push_back(plan(setup, "slam", ServiceRole::kEssential, slam_arguments(setup)));
  plans.back().when_restarted = load_checkpoint(setup.save_map);
  if (setup.dense) plans.push_back(plan(setup, "dense", ServiceRole::kOptional, dense_arguments(setup)));
  std::vector<std::string> wait_for;
  for (ServicePlan& service : plans) {
    wait_for.push_back(service.name);
    if (setup.pace == "realtime" && (service.name == "detector" || service.name == "dense"))
      service.niceness = kRealtimeNiceness;
  }
  if (setup.viewer) {  // no other service waits for it
    plans.push_back(plan(setup, "viewer", ServiceRole::kOptional, {}));
    plans.back().niceness = kRealtimeNiceness;
    plans.back().ends_last = true;
  }
  // In realtime no service waits for boxes: the run starts with geometry and uses boxes when they arrive.
  if (setup.remote_detector && setup.pace != "realtime") wait_for.emplace_back("detector");
  if (setup.replay) {
    plans.push_back(plan(setup, "replay", ServiceRole::kSource, setup.replay.arguments(wait_for)));
  } else {
    const bool endless = setup.total_frames == 0;
    plans.push_back(
        plan(setup, "camera", endless ? ServiceRole::kLive : ServiceRole::kSource, camera_arguments(setup, wait_for)));
    plans.back().when_restarted = [] { return std::vector<std::string>{"--wait-for", "none"}; };  // the others run
  }
  return plans;
}

}  // namespace rtd::launcher
