// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <sstream>

#include "common/bus/frame_topics.hpp"
#include "common/bus/robot.hpp"
#include "common/bus/topics.hpp"
#include "common/camera/depth_figures.hpp"
#include "common/camera/frame_source.hpp"
#include "common/camera/live_uri.hpp"
#include "common/camera/open/source_factory.hpp"
#include "common/camera/source_schemes.hpp"
#include "common/camera/synthetic/synthetic_source.hpp"
#include "common/mcap/indexed_reader.hpp"
#include "common/mcap/recording_file.hpp"
#include "common/recordings/open.hpp"
#include "common/ros2/names.hpp"
#include "common/run_record/run_record.hpp"
#include "common/service/config.hpp"
#include "services/launcher/doctor/doctor_command.hpp"
#include "services/launcher/run/run_setup.hpp"

namespace rtd::launcher {

using service::ConfigError;
namespace {

/// No one plugs a camera in because a run waits for it.
void require_camera(const RunSetup& setup) {
  if (!camera::is_device(setup.source)) return;
  const camera::DeviceUri uri = camera::parse_device_uri(setup.source);
  if (uri.recorded) return;
  const std::string why = uri.scheme == "realsense-dds"
                              ? why_no_realsense(uri.device, setup.bus_options)
                              : why_no_camera(uri.scheme, uri.device, camera::find_openni2_cameras());
  if (!why.empty()) throw ConfigError(why);
}

std::uint64_t limited(std::uint64_t frames, std::uint64_t limit) {
  if (limit == 0) return frames;
  return frames == 0 ? limit : std::min(frames, limit);
}

/// What the first frame, which is read in any case, says about the depth unit; empty when it says nothing.
std::string doubt_about_depth(camera::FrameSource& source) {
  const std::optional<camera::SourceFrame> first = source.next();
  if (!first) return {};
  camera::DepthFigures figures;
  figures.add(first->image.depth, first->image.depth_scale_m);
  return figures.doubt(source.info().depth_unit_given);
}

/// --imu and --wheel-odometry of a recorded source come from the recording, and so does tf. Throws ConfigError listing
/// its topics when it does not have them. None for other sources.
std::vector<std::string> sensor_topics(const RunSetup& setup) {
  const auto& motion = setup.services.motion;
  const bool tf = setup.services.base.from_tf();
  if (!motion.given() && !tf) return {};
  const std::unique_ptr<recordings::Reader> recording =
      camera::is_live(setup.source) ? nullptr : camera::recording_of(setup.source);
  if (!recording) return {};
  const auto lacks = [&](const std::string& option, const std::string& what) {
    return ConfigError(fmt::format("{}: {} has no {}; its topics are:\n{}", option, recording->name(), what,
                                   recordings::list_topics(*recording)));
  };
  std::vector<std::string> topics;
  const auto take = [&](const char* option, const std::string& topic, const char* type) {
    if (topic.empty()) return;
    const bool there = std::ranges::any_of(recording->topics(), [&](const recordings::RecordedTopic& recorded) {
      return ros2::ros_topic(recorded.name) == topic && recorded.type == type && recorded.messages > 0;
    });
    if (!there) throw lacks(fmt::format("{} {}", option, topic), fmt::format("{} on this topic", type));
    topics.push_back(topic);
  };
  take("--imu", motion.imu, "sensor_msgs/Imu");
  take("--wheel-odometry", motion.wheels, "nav_msgs/Odometry");
  if (tf && std::ranges::none_of(recording->topics(), recordings::is_tf))
    throw lacks("--camera-in-base tf", "transforms (/tf_static or /tf)");
  if (tf) topics.push_back(ros2::ros_topic(bus::topics::kTfStatic.name));
  return topics;
}

}  // namespace

ViewerUse parse_viewer_use(const std::string& words) {
  ViewerUse use{.shown = true};
  std::istringstream rest(words);
  for (std::string word; std::getline(rest, word, ',');) {
    if (word == "now") {
      use.waits = false;
    } else if (word == "exit") {
      use.stays = false;
    } else if (word != "stay" && word != "true") {
      throw ConfigError("--viewer=" + words +
                        ": write --viewer (a recording waits for the first page, the page stays until Ctrl-C), "
                        "--viewer=now (no wait), --viewer=exit (the page ends with the run) or --viewer=now,exit");
    }
  }
  return use;
}

const char* usual_pace(const RunSetup& setup) {
  if (setup.detector == "remote") return "realtime";
  if (camera::is_device(setup.source)) return camera::parse_device_uri(setup.source).recorded ? "lockstep" : "realtime";
  if (camera::is_live(setup.source)) return "realtime";
  if (!camera::is_of_kind(setup.source, camera::SourceKind::kScene) || setup.frames > 0) return "lockstep";
  const camera::SyntheticOptions scene = camera::parse_synthetic_options(camera::parse_source_uri(setup.source));
  return scene.frames == 0 ? "realtime" : "lockstep";
}

void look_at_source(RunSetup& setup) {
  if (camera::is_live(setup.source)) {
    camera::check_live_uri(setup.source);
    require_camera(setup);
    setup.total_frames = setup.frames;
    setup.running_camera = !camera::is_device(setup.source) || !camera::parse_device_uri(setup.source).recorded;
    return;
  }
  const std::unique_ptr<camera::FrameSource> source = camera::make_source(setup.source);
  setup.total_frames = limited(source->info().frames, setup.frames);
  if (source->info().frames > 0) setup.held_frames = setup.total_frames;
  setup.source_notes = source->info().notes;
  setup.source_remarks = source->info().remarks;
  if (!run_record::is_synthetic(setup.source)) setup.depth_doubt = doubt_about_depth(*source);
  setup.sensor_topics = sensor_topics(setup);
}

namespace {

using service::ConfigError;

constexpr std::string_view kScheme = "mcap:";

/// The robot of a recording, which the run then is: the one asked for, or the only one with a name.
std::string choose_robot(const std::set<std::string>& recorded, const std::string& asked, const std::string& file) {
  if (asked.empty() && recorded.size() == 1) return *recorded.begin();
  if (recorded.size() < 2 || recorded.contains(asked)) return asked;
  throw ConfigError(fmt::format("{} has the topics of several robots: choose one with --robot {}", file,
                                fmt::join(recorded, " or ")));
}

/// Messages by DDS name of the topic, without that of the robot, whose name is chosen.
std::map<std::string, std::uint64_t> counts_of(const std::string& file, std::string& robot) {
  try {
    const recordings::Opened recording = recordings::open(file);
    const mcap::IndexedReader reader(*recording.source);
    std::vector<std::string> topics;
    for (const auto& [id, channel] : reader.summary().channels) topics.push_back(ros2::dds_topic(channel.topic));
    const std::set<std::string> recorded = bus::robots_in(topics);
    robot = choose_robot(recorded, robot, file);
    std::map<std::string, std::uint64_t> counts;
    for (const auto& [id, channel] : reader.summary().channels) {
      const bus::RobotTopic topic = bus::split_robot(ros2::dds_topic(channel.topic));
      if (recorded.size() > 1 && !topic.robot.empty() && topic.robot != robot) continue;
      std::uint64_t messages = 0;
      if (const auto& statistics = reader.summary().statistics)
        if (const auto found = statistics->channel_message_counts.find(id);
            found != statistics->channel_message_counts.end())
          messages = found->second;
      counts[topic.topic] += messages;
    }
    return counts;
  } catch (const mcap::RecordingFileError& error) {
    throw ConfigError(error.what());
  }
}

void choose_topics(ReplaySetup& replay, const std::map<std::string, std::uint64_t>& counts) {
  using namespace bus::topics;
  const auto has = [&](const std::string& topic) { return counts.contains(topic) && counts.at(topic) > 0; };
  std::string frames = kFrame.name;  // of the size class that was recorded
  for (const bus::FrameTopic& topic : bus::frame_topics())
    if (has(topic.name)) frames = topic.name;
  replay.topics =
      replay.features ? std::vector<std::string>{kFeatures.name} : std::vector<std::string>{frames, kDetections.name};
  for (const std::string& topic : replay.topics) {
    if (has(topic)) continue;
    std::vector<std::string> known;
    for (const auto& [name, messages] : counts)
      if (messages > 0) known.push_back(name);
    throw ConfigError(fmt::format("--replay-topics: {} has no messages of {}; it has {}", replay.file, topic,
                                  fmt::join(known, ", ")));
  }
  replay.frames = counts.at(replay.topics.front());
  if (replay.features && has(frames)) replay.topics.push_back(frames);
  if (!replay.features && has(kPersonMasks.name)) replay.topics.emplace_back(kPersonMasks.name);
  if (has(kCameraInfo.name)) replay.topics.emplace_back(kCameraInfo.name);
}

}  // namespace

std::vector<std::string> ReplaySetup::arguments(const std::vector<std::string>& wait_for) const {
  std::vector<std::string> arguments = {
      file, "--restamp", "--wait-for", fmt::format("{}", fmt::join(wait_for, ",")), "--paced-topic", topics.front()};
  if (detections) arguments.insert(arguments.end(), {"--stand-in", "detector"});
  arguments.emplace_back("--topics");
  arguments.insert(arguments.end(), topics.begin(), topics.end());
  return arguments;
}

ReplaySetup choose_replay(const RunOptions& options, const std::string& robot) {
  ReplaySetup replay;
  if (options.replay_topics.empty()) return replay;
  const auto asked = [&](const char* what) { return std::ranges::count(options.replay_topics, what) > 0; };
  replay.features = asked("features");
  replay.detections = asked("detections") && !replay.features;
  if (!options.source.starts_with(kScheme))
    throw ConfigError("--replay-topics needs a recording: --source mcap:FILE, not " + options.source);
  if (options.frames > 0)
    throw ConfigError("--frames cannot be combined with --replay-topics: a replay always plays to the end");
  if (options.dense && replay.features)
    throw ConfigError("--dense cannot be combined with --replay-topics features: its masks come from a running filter");
  replay.file = options.source.substr(kScheme.size());
  replay.robot = robot;
  choose_topics(replay, counts_of(replay.file, replay.robot));
  return replay;
}

}  // namespace rtd::launcher
