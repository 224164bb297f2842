// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>

#include "services/replay/replay_service.hpp"

namespace rtd::replay {

void ReplayService::add_options(CLI::App& app, Config& config) {
  app.add_option("file", config.file, "Recording, or the folder with it (replay.file)");
  app.add_option("-r,--rate", config.rate, "Speed, 1 = as recorded, 0 = as fast as possible (replay.rate)");
  app.add_flag(
      "--asap", [&config](std::int64_t) { config.rate = 0; }, "As fast as possible: --rate 0");
  app.add_flag("-l,--loop", config.loop, "Start again at the end (replay.loop)");
  app.add_option("--start-offset", config.start_offset_s, "Start this many seconds after the first message");
  app.add_option("--duration", config.duration_s, "Play this many seconds, 0 = to the end");
  app.add_option("--topics", config.topics, "Play only these topics or patterns, e.g. rtd/frame '/slam/*'")
      ->delimiter(',');
  app.add_option("--exclude", config.exclude, "Leave these topics or patterns out")->delimiter(',');
  app.add_option("-m,--remap", config.remap, "Rename topics: old:=new");
  app.add_option("--clock", config.clock_hz, "Publish /clock at this rate (40 Hz without a number)")
      ->expected(0, 1)
      ->default_str("40");
  app.add_flag("-p,--pause,--start-paused", config.pause, "Start paused (space continues)");
  app.add_option("--read-ahead", config.read_ahead_mb, "Megabytes read before they are due (replay.read_ahead_mb)");
  app.add_option("--lockstep", config.lockstep,
                 "Send the next frame only after a message of this topic, e.g. rtd/tracking");
  app.add_option("--paced-topic", config.paced_topic,
                 "Topic that waits for these answers (default rtd/frame, else rtd/features)");
  app.add_option("--wait-for", config.wait_for, "Services that must be ready first, e.g. filter,slam")->delimiter(',');
  app.add_option("--wait-readers", config.wait_readers_s, "Longest wait for readers of reliable topics [s]");
  app.add_option("--stand-in", config.stand_in, "Services to send heartbeats for, e.g. detector")->delimiter(',');
  app.add_flag("--restamp", config.restamp, "Set published_ns of our frames and features to the time of the replay");
  app.add_flag("--json", config.json, "Print a report in JSON at the end");
  app.footer(
      "Keys: space pauses, right arrow or s steps (paused), up and down arrow change the rate, b and f jump 10 s back "
      "and forward, q ends.\n'rtd replay --viewer' also shows it in the browser (--set viewer.port=...).\nExit code: 0 "
      "done, 1 no answers (--lockstep), 2 the recording or an option cannot be "
      "used, 3 the recording is damaged and only its readable part was played");
}

}  // namespace rtd::replay
