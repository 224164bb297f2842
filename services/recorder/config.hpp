// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace rtd::recorder {

/// Section `record` of the configuration.
struct ServiceConfig {
  std::vector<std::string> topics{"*"};
  std::string output;
  std::string split;
  std::string compression = "none";
  bool force = false;
  bool beside = false;
  bool json = false;
  int queue_mib = 256;
  int chunk_kib = 1024;
  int chunk_ms = 100;
  int sync_pause_ms = 50;
  int min_free_mib = 64;
  int niceness = 5;
  bool in_place = false;

  void bind(auto& binder) {
    binder.field("topics", topics, "shell patterns of topics, DDS or ROS 2 names: rt/slam/*, /slam/odometry");
    binder.field("output", output, "FILE.mcap, or a folder as rosbag2 has it; empty: rtd_DATE-TIME");
    binder.field("split", split, "start a new file after this much, e.g. 1GB or 60s; empty: one file");
    binder.choice("compression", compression, {"none", "lz4", "zstd"}, "of chunks");
    binder.field("force", force, "replace an earlier recording");
    binder.field("beside", beside, "keep an earlier recording, this one gets the next free name: run.1.mcap");
    binder.field("json", json, "final report as JSON on stdout");
    binder.field("queue_mib", queue_mib, {1, 65536}, "data that may wait for the disk; beyond it the newest is lost");
    binder.field("chunk_kib", chunk_kib, {1, 65536}, "size at which a chunk ends");
    binder.field("chunk_ms", chunk_ms, {1, 10000}, "age of its first message at which a chunk ends");
    binder.field("sync_pause_ms", sync_pause_ms, {0, 10000}, "between two syncs");
    binder.field("min_free_mib", min_free_mib, {0, 1'000'000}, "with less space on the disk the recording ends");
    binder.field("niceness", niceness, {0, 19}, "priority of the recorder behind the services that it records");
    binder.field("in_place", in_place, "take images from the camera's shared memory instead of having them sent");
  }
};

}  // namespace rtd::recorder
