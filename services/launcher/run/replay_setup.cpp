// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/launcher/run/run_setup.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <set>

#include "common/bus/frame_topics.hpp"
#include "common/bus/robot.hpp"
#include "common/bus/topics.hpp"
#include "common/mcap/indexed_reader.hpp"
#include "common/mcap/recording_file.hpp"
#include "common/recordings/open.hpp"
#include "common/ros2/names.hpp"
#include "common/service/config.hpp"

namespace rtd::launcher {
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
