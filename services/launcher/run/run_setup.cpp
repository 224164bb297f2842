// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/launcher/run/run_setup.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <random>

#include "common/bus/port_check.hpp"
#include "common/camera/open/source_factory.hpp"
#include "common/io/atomic_file.hpp"
#include "common/io/printable.hpp"
#include "common/io/text.hpp"
#include "common/msg/services.hpp"
#include "common/process/executable.hpp"
#include "common/process/out_folder.hpp"
#include "common/service/model_locator.hpp"
#include "common/service/patience.hpp"

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
    const std::string near = io::nearest_name(section, sections);
    throw ConfigError(fmt::format("--set {}: unknown section '{}'{}", io::abridged(assignment), io::abridged(section),
                                  near.empty() ? "" : fmt::format(", did you mean '{}'?", near)));
  }
}

void choose_pace(RunSetup& setup) {
  const service::Pace pace = service::parse_pace(setup.pace.empty() ? usual_pace(setup) : setup.pace);
  setup.pace = service::to_string(pace);
  setup.launcher.hung_after_ms = service::patience_of(pace).silent_ms;
}

/// The launcher reads its own sections; the services check theirs when they start.
void load_config(RunSetup& setup) {
  service::BusConfig bus;
  bus.options.shm_segment_mib = bus::kSmallSegmentMib;
  service::ConfigBinder binder;
  binder.section("bus", bus);
  binder.section("launcher", setup.launcher);
  setup.services.bind(binder);
  check_sections(setup.config.overrides);
  service::load_config(binder, setup.config);
  setup.bus_options = service::to_bus_options(bus, "rtd");
  setup.bus_options.uses_rings = false;  // what a library asserts of one would end this process, and with it the run
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

/// The paper's network for the paper's mode, where it is there; else empty: the usual one.
std::string model_of_mode(const RunSetup& setup) {
  const bool of_the_paper = msg::find_filter_mode(setup.services.filter_mode)->mode == msg::FilterMode::kRtdPaper;
  if (!of_the_paper) return {};
  return service::find_model(service::kPaperModel, service::process_environment()).path;
}

/// A name that is a file from here, by its whole path.
std::string absolute_file(const std::string& name) {
  return !name.empty() && fs::is_regular_file(name) ? fs::absolute(name).string() : name;
}

void choose_masks(RunSetup& setup) {
  const service::MaskSettings& masks = setup.services.masks;
  setup.mask_model_path =
      service::find_mask_model(masks.use, absolute_file(masks.model), service::process_environment()).path;
  if (!setup.mask_model_path.empty())
    setup.detector_note += "; masks: " + service::describe_model(setup.mask_model_path);
}

void choose_detector(RunSetup& setup) {
  if (setup.replay) {
    setup.detector_note = setup.replay.features ? "off (recorded features)" : "recorded boxes";
    return;
  }
  if (msg::find_filter_mode(setup.services.filter_mode)->boxes == msg::BoxUse::kNone) {
    setup.detector_note = "off (filter mode " + setup.services.filter_mode + ")";
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
  const std::string configured =
      absolute_file(setup.services.model.empty() ? model_of_mode(setup) : setup.services.model);
  const service::ModelSearch model = service::find_model(configured, service::process_environment());
  if (!model && !configured.empty()) throw ConfigError(model.message);
  setup.model_path = model.path;
  setup.weights_advice = model.message;
  setup.detector_note = model ? service::describe_model(model.path) : "off (no weights)";
  if (model) choose_masks(setup);
}

ServicePlan plan(const RunSetup& setup, const std::string& name, ServiceRole role,
                 const std::vector<std::string>& own_arguments) {
  ServicePlan plan{name, {process::require_executable("rtd-" + name), "--pace", setup.pace}, role};
  const auto add = [&plan](const std::vector<std::string>& words) {
    plan.command.insert(plan.command.end(), words.begin(), words.end());
  };
  add(service::to_command_line(setup.config));
  if (const auto own = setup.vendors_of.find(name); own != setup.vendors_of.end()) add({"--dds", own->second});
  add(service::to_command_line(setup.config.given, name));
  add(own_arguments);
  return plan;
}

void choose_map(RunSetup& setup) {
  service::MapFileConfig& map = setup.services.map;
  if (!map.load.empty() && fs::is_directory(map.load))
    throw ConfigError("--map " + map.load + ": this is a folder: name a map file in it");
  if (!map.load.empty() && !fs::is_regular_file(map.load)) throw ConfigError("--map " + map.load + ": no such file");
  if (setup.services.localize_only && map.load.empty())
    throw ConfigError("--localize-only needs a map: give its file with --map");
  if (setup.services.localize_only && !map.save.empty())
    throw ConfigError("--save-map " + map.save + ": with --localize-only the map does not change");
  setup.save_map_asked = !map.save.empty();
  if (map.save.empty() && !setup.services.localize_only) map.save = setup.out_dir + "/map.rtdmap";
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
  const std::string& save = setup.services.map.save;
  if (!save.empty()) arguments.insert(arguments.end(), {"--save-map", save});
  return arguments;
}

/// With the base of the robot slam's map has z up.
std::vector<std::string> dense_arguments(const RunSetup& setup) {
  // Of a room that only the page shows the first view may cost something, all others only idle processor time.
  std::vector<std::string> arguments = setup.dense ? std::vector<std::string>{"--out", setup.out_dir}
                                                   : std::vector<std::string>{"--set", "dense.niceness=19"};
  if (setup.services.base.z_up() && setup.services.up.empty()) arguments.emplace_back("--up=0,0,1");
  return arguments;
}

std::vector<std::string> detector_arguments(const RunSetup& setup) {
  std::vector<std::string> arguments = {"--model=" + setup.model_path};
  if (!setup.mask_model_path.empty()) arguments.push_back("--mask-model=" + setup.mask_model_path);
  return arguments;
}

std::vector<std::string> filter_arguments(const RunSetup& setup) {
  const service::MotionTopics& motion = setup.services.motion;
  std::vector<std::string> settings;
  const bool boxes = !setup.model_path.empty() || setup.replay.detections || setup.remote_detector;
  if (!boxes) settings.emplace_back("filter.detector=off");
  if (boxes && setup.services.filter_detector == "auto") settings.emplace_back("filter.detector=on");
  if (!motion.imu.empty() && motion.imu_mount_in_base.empty()) {  // else how it is turned is known to slam alone
    settings.push_back("filter.imu.topic=" + motion.imu);
    if (!motion.imu_mount.empty()) settings.push_back("filter.imu.mount=" + motion.imu_mount);
  }
  std::vector<std::string> arguments;
  for (const std::string& setting : settings) arguments.insert(arguments.end(), {"--set", setting});
  return arguments;
}

std::vector<std::string> camera_arguments(const RunSetup& setup, const std::vector<std::string>& wait_for) {
  std::vector<std::string> arguments = {"--source",          setup.source,
                                        "--wait-for",        fmt::format("{},launcher", fmt::join(wait_for, ",")),
                                        "--groundtruth-out", setup.groundtruth_path(),
                                        "--source-id",       std::to_string(std::random_device()() >> 1U)};
  if (setup.frames > 0) arguments.insert(arguments.end(), {"--frames", std::to_string(setup.frames)});
  if (!setup.sensor_topics.empty())
    arguments.insert(arguments.end(), {"--sensor-topics", fmt::format("{}", fmt::join(setup.sensor_topics, ","))});
  return arguments;
}

/// trajectory_map_1.txt, trajectory_segment_2.txt, ...
std::vector<fs::path> more_trajectories(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename();
    const bool ours = name.starts_with("trajectory_map_") || name.starts_with("trajectory_segment_");
    if (ours && name.ends_with(".txt")) files.push_back(entry.path());
  }
  return files;
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

void ServiceSettings::bind(service::ConfigBinder& binder) {
  using Part = service::ConfigBinder;
  binder.part_of_section("filter", [this](Part& filter) {
    service::bind_filter_mode(filter, filter_mode);
    service::bind_filter_detector(filter, filter_detector);
    service::bind_person_masks(filter, person_masks);
  });
  binder.part_of_section("detector", [this](Part& detector) {
    service::bind_model(detector, model);
    masks.bind(detector);
    service::bind_engine(detector, engine);
  });
  binder.part_of_section("slam", [this](Part& slam) {
    slam.section("map", map);
    service::bind_localize_only(slam, localize_only);
    slam.section("base", base);
    motion.bind(slam);
  });
  binder.part_of_section("dense", [this](Part& dense) { dense.field("grid.up", up, "what points up"); });
}

bool RunSetup::reports_masks() const {
  if (bus_options.security.enabled()) return false;  // the keys of a launcher do not admit it to them
  const bool replayed = std::ranges::count(replay.topics, std::string(bus::topics::kPersonMasks.name)) > 0;
  const bool read_by_others = viewer_use.shown || !record.empty() || services.person_masks == "on";
  return replayed || (!mask_model_path.empty() && (show_masks || read_by_others || services.masks.use == "on"));
}

RunSetup prepare_run(const RunOptions& options) {
  RunSetup setup(options);
  setup.source = camera::complete_uri(setup.source);
  choose_pace(setup);
  if (!setup.viewer.empty()) setup.viewer_use = parse_viewer_use(setup.viewer);
  load_config(setup);
  choose_vendors(setup);
  setup.replay = choose_replay(setup, setup.bus_options.robot);
  if (!setup.replay.robot.empty()) setup.config.given.push_back({"bus.robot", "--robot", {setup.replay.robot}});
  if (setup.replay) setup.bus_options.robot = setup.replay.robot;
  if (setup.replay) {
    setup.total_frames = setup.held_frames = setup.replay.frames;
  } else {
    look_at_source(setup);
  }
  choose_detector(setup);
  choose_map(setup);
  process::make_out_folder(setup.out_dir);
  if (!setup.trace.empty()) check_trace_file(setup.trace);
  if (bus::surely_empty(setup.bus_options)) setup.launcher.domain_check_ms = 0;
  if (setup.blur_people && setup.record.empty()) throw ConfigError("--blur-people is for what --record FILE records");
  if (fs::exists(setup.record)) throw ConfigError("--record " + setup.record + " exists already: choose another name");
  return setup;
}

void clear_out_dir(const RunSetup& setup) {
  const fs::path out_dir = setup.out_dir;
  io::remove_unfinished(out_dir);
  std::error_code error;
  const fs::path map = out_dir / "map.rtdmap";
  const bool needed = !setup.services.map.load.empty() &&
                      fs::equivalent(setup.services.map.load, map, error);  // --map of an earlier run here
  error.clear();
  if (!needed) fs::remove(map, error);
  for (const fs::path& file : more_trajectories(out_dir)) {
    if (!error) fs::remove(file, error);
  }
  for (const char* left : {"logs", "trace", "trajectory.txt", "trajectory_online.txt", "keyframes.txt", "map.ply",
                           "static_map.ply", "map.pgm", "map.yaml", "map.bt", "masks", "groundtruth.txt", "run.json",
                           "report.json", "report.html", "map.html"}) {
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
    std::vector<std::string> arguments{"-o", setup.record, "--beside"};
    if (setup.blur_people) arguments.emplace_back("--blur-people");
    plans.push_back(plan(setup, "record", ServiceRole::kOptional, std::move(arguments)));
    plans.back().ends_last = true;
  }
  if (detector) plans.push_back(plan(setup, "detector", ServiceRole::kOptional, detector_arguments(setup)));
  if (filter) plans.push_back(plan(setup, "filter", ServiceRole::kEssential, filter_arguments(setup)));
  plans.push_back(plan(setup, "slam", ServiceRole::kEssential, slam_arguments(setup)));
  plans.back().when_restarted = load_checkpoint(setup.services.map.save);
  if (setup.dense) plans.push_back(plan(setup, "dense", ServiceRole::kOptional, dense_arguments(setup)));
  std::vector<std::string> wait_for;
  for (ServicePlan& service : plans) {
    service.awaited = true;
    wait_for.push_back(service.name);
    if (setup.pace == "realtime" && (service.name == "detector" || service.name == "dense"))
      service.niceness = kRealtimeNiceness;
  }
  if (setup.viewer_use.shown) {  // no other service waits for it, nor for the room that it shows
    if (!setup.dense && !process::find_executable("rtd-dense").empty())
      plans.push_back(plan(setup, "dense", ServiceRole::kOptional, dense_arguments(setup)));
    plans.push_back(plan(setup, "viewer", ServiceRole::kOptional, {"--open"}));
    plans.back().niceness = kRealtimeNiceness;
    plans.back().ends_last = true;
    plans.back().outlives_run = setup.viewer_use.stays;
  }
  // In realtime no service waits for boxes: the run starts with geometry and uses boxes when they arrive.
  if (setup.remote_detector && setup.pace != "realtime") wait_for.emplace_back("detector");
  if (setup.replay) {
    plans.push_back(plan(setup, "replay", ServiceRole::kSource, setup.replay.arguments(wait_for)));
  } else {
    const ServiceRole role = setup.held_frames > 0 ? ServiceRole::kSource : ServiceRole::kLive;
    plans.push_back(plan(setup, "camera", role, camera_arguments(setup, wait_for)));
  }
  return plans;
}

}  // namespace rtd::launcher
