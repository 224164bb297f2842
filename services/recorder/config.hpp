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
    binder.field("topics", topics, "shell patterns of DDS or ROS 2 names: rt/slam/*, /slam/odometry");
    binder.field("output", output, "FILE.mcap, or a folder in the layout of rosbag2; empty: rtd_DATE-TIME");
    binder.field("split", split, "size or duration after which a new file begins, e.g. 1GB or 60s; empty: one file");
    binder.choice("compression", compression, {"none", "lz4", "zstd"}, "compression of chunks");
    binder.field("force", force, "replace an earlier recording");
    binder.field("beside", beside, "keep an earlier recording and take the next free name: run.1.mcap");
    binder.field("json", json, "print the final report as JSON on stdout");
    binder.field("queue_mib", queue_mib, {1, 65536},
                 "what may wait for the disk; beyond it the newest message is lost");
    binder.field("chunk_kib", chunk_kib, {1, 65536}, "size at which a chunk ends");
    binder.field("chunk_ms", chunk_ms, {1, 10000}, "age of its first message at which a chunk ends");
    binder.field("sync_pause_ms", sync_pause_ms, {0, 10000}, "pause between two syncs");
    binder.field("min_free_mib", min_free_mib, {0, 1'000'000}, "free disk space below which the recording ends");
    binder.field("niceness", niceness, {0, 19}, "how far the recorder steps back behind the programs it records");
    binder.field("in_place", in_place, "read images in the camera's shared memory instead of having them sent");
  }
};

}  // namespace rtd::recorder
