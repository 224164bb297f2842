// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "common/bus/bus_factory.hpp"
#include "common/msg/filter_modes.hpp"
#include "common/run_record/run_record.hpp"
#include "common/service/bus_config.hpp"
#include "common/service/run_settings.hpp"
#include "services/launcher/core/run/supervisor.hpp"

namespace rtd::launcher {

/// Section `launcher` of the configuration.
struct LauncherConfig : SupervisorOptions {  ///< hung_after_ms: that of the pace, see load_config()
  int domain_check_ms = 500;
  int connect_timeout_ms = 15000;
  int interrupt_grace_ms = 1200;
  int finish_grace_ms = 10000;
  int samples = 24;

  void bind(auto& binder) {
    binder.field("max_restarts", max_restarts, {0, 100}, "deaths of a service in a row before it is given up");
    binder.field("first_backoff_ms", first_backoff_ms, {0, 2000},
                 "pause before the restart of a service that lived for less than 5 s, doubled for each further one");
    binder.field(
        "hung_after_ms", hung_after_ms, {0, 3600000},
        "silence after which a service is killed and restarted, 0 = never: for a debugger; 10000 where every frame "
        "is played");
    binder.field("domain_check_ms", domain_check_ms, {0, 10000},
                 "looking for another run in the same domain before anything starts, unless no process is in it");
    binder.field("connect_timeout_ms", connect_timeout_ms, {0, 60000},
                 "longest time that the launcher waits for filter and slam before it lets the camera play");
    binder.field("interrupt_grace_ms", interrupt_grace_ms, {0, 1500}, "from Ctrl-C to the forced end of a service");
    binder.field("finish_grace_ms", finish_grace_ms, {0, 600000},
                 "from the end of the source to the forced end: slam writes its map");
    binder.field("samples", samples, {1, 100}, "frames kept for the report");
  }
};

/// What `rtd run` knows of the settings of services: they are options of its own, which it forwards.
struct ServiceSettings {
  std::string filter_mode = msg::kDefaultFilterMode;
  std::string model;   ///< ONNX file; empty: search
  std::string engine;  ///< of the detector
  service::MaskSettings masks;
  std::string filter_detector = "auto";
  std::string person_masks = "off";  ///< whether the filter reads them
  service::MapFileConfig map;
  bool localize_only = false;
  service::BaseConfig base;
  service::MotionTopics motion;
  std::string up;  ///< of dense

  /// As parts of the services' sections.
  void bind(service::ConfigBinder& binder);
};

/// How a run or a replay goes together with the page that shows it.
struct ViewerUse {
  bool shown = false;
  bool waits = true;  ///< a recording is played when the first page is open
  bool stays = true;  ///< until Ctrl-C, after the run
};

/// What follows `--viewer=`, with commas: "stay" or "true" (what an option without a value has), "now": does not wait;
/// "exit": does not stay. Throws service::ConfigError that says what to write.
ViewerUse parse_viewer_use(const std::string& words);

/// The command line of `rtd run`.
struct RunOptions {
  std::string source;
  std::string pace;                 ///< empty: every frame of what is stored, a camera in real time
  service::ConfigSources config;    ///< for any service, with the options of services
  std::vector<std::string> dds_of;  ///< "SERVICE=VENDOR": another DDS for one service
  std::string detector = "auto";    ///< "auto": when weights are found and the filter mode needs them; "off"; "remote"
  std::string out_dir;
  bool dense = false;                      ///< also fuse a dense static map
  std::string viewer;                      ///< also show the run in the browser: parse_viewer_use(); empty = no
  std::string trace;                       ///< write what each service did when into this file; empty = no
  std::string record;                      ///< also record all topics: FILE.mcap or a folder; empty = no
  bool blur_people = false;                ///< in what is recorded
  std::vector<std::string> replay_topics;  ///< "detections", "features": recorded ones instead of their services
  bool show_masks = false;  ///< have people's masks computed for the report, also where nothing else reads them
  bool quiet = false;
  std::uint64_t frames = 0;  ///< end after so many frames; 0 = all
};

/// The part of a recording that replaces services of a run: rtd-replay plays it instead of the camera.
struct ReplaySetup {
  std::string file;                 ///< empty: nothing is replayed
  std::string robot;                ///< whose topics are played, and which the run therefore is
  bool detections = false;          ///< the recorded boxes; no detector runs
  bool features = false;            ///< the recorded features; neither detector nor filter runs
  std::uint64_t frames = 0;         ///< of the run
  std::vector<std::string> topics;  ///< to play: the needed ones, then optional ones

  explicit operator bool() const { return !file.empty(); }
  /// For rtd-replay.
  std::vector<std::string> arguments(const std::vector<std::string>& wait_for) const;
};

/// From --replay-topics. `robot`: the one of --robot; without it the only named one of the recording. Throws
/// service::ConfigError: not an MCAP source, a recording without the topic (the message lists its topics) or of several
/// robots, options that need a camera.
ReplaySetup choose_replay(const RunOptions& options, const std::string& robot);

/// A checked run: its options, completed (the source as a URI), and what follows from them.
struct RunSetup : RunOptions {
  explicit RunSetup(const RunOptions& options) : RunOptions(options) {}

  LauncherConfig launcher;
  ServiceSettings services;                       ///< in force, completed: the map file that slam writes, or none
  bus::BusOptions bus_options;                    ///< what `bus` and the configuration give
  std::map<std::string, std::string> vendors_of;  ///< services that use another DDS
  std::uint64_t total_frames = 0;                 ///< 0 = unknown or endless
  std::uint64_t held_frames = 0;                  ///< those of them that are stored, or of a scene with an end
  bool running_camera = false;                    ///< what it has not given cannot be had again
  std::vector<std::string> source_notes;          ///< what the source was taken for
  std::vector<std::string> source_remarks;        ///< what is wrong with it although it is played
  std::string depth_doubt;                        ///< why the depth unit is likely another; empty: it is not
  std::string model_path;                         ///< empty: no detector in this run
  std::string detector_note;                      ///< "YOLOX-nano, Apache-2.0", or "off (why)"
  std::string mask_model_path;                    ///< empty: boxes alone
  bool remote_detector = false;                   ///< it runs on another host; the launcher does not start it
  std::string weights_advice;   ///< where to get weights, when the filter mode needs a detector and there are none
  bool save_map_asked = false;  ///< the user named the file
  ViewerUse viewer_use;
  ReplaySetup replay;
  std::vector<std::string>
      sensor_topics;  ///< ROS names of topics of a recorded source that slam needs, for --sensor-topics

  /// Where the services write their parts of --trace.
  std::string trace_folder() const { return out_dir + "/trace"; }
  std::string groundtruth_path() const { return out_dir + "/groundtruth.txt"; }
  /// Whether the report shows masks of people: those that others read too, or that are asked for. Reading them makes
  /// the detector compute them.
  bool reports_masks() const;
};

/// The pace without --pace. A camera, a scene without an end, and a detector that serves at its own pace do not wait.
/// Of what is stored every frame is played, with the same result each time.
const char* usual_pace(const RunSetup& setup);

/// How many frames come, what the source was taken for, what is wrong with it, and which of its topics slam needs.
/// Throws service::ConfigError or camera::SourceError.
void look_at_source(RunSetup& setup);

/// Checks everything that can be checked before a process is started: source, configuration, weights, output folder (it
/// is created). Throws service::ConfigError or camera::SourceError.
RunSetup prepare_run(const RunOptions& options);

/// Removes what an earlier run left in the output folder. Throws service::ConfigError.
void clear_out_dir(const RunSetup& setup);

/// The services of the run in starting order, the camera or the replay last. Throws service::ConfigError
/// naming an executable that is missing.
std::vector<ServicePlan> plan_services(const RunSetup& setup);

}  // namespace rtd::launcher
