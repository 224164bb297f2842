// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/recorder/config.hpp"

namespace rtd::recorder {

void ServiceConfig::bind(service::ConfigBinder& binder) {
  binder.field("topics", topics, "patterns of topics, DDS or ROS 2 names: rt/slam/*, /slam/odometry");
  binder.field("output", output, "FILE.mcap, or a folder as rosbag2 has it; empty: rtd_DATE-TIME");
  binder.field("split", split, "a new file after so much, e.g. 1GB or 60s; empty: one file");
  binder.choice("compression", compression, {"none", "lz4", "zstd"}, "of chunks");
  binder.field("force", force, "replace an earlier recording");
  binder.field("beside", beside, "an earlier recording stays, this one gets the next free name: run.1.mcap");
  binder.field("json", json, "final report as JSON on stdout");
  binder.field("queue_mib", queue_mib, {1, 65536}, "what may wait for the disk; beyond it the newest is lost");
  binder.field("chunk_kib", chunk_kib, {1, 65536}, "a chunk is ended when it has so much");
  binder.field("chunk_ms", chunk_ms, {1, 10000}, "or when its first message is so old");
  binder.field("sync_pause_ms", sync_pause_ms, {0, 10000}, "between two syncs");
  binder.field("min_free_mib", min_free_mib, {0, 1'000'000}, "with less space on the disk the recording ends");
  binder.field("niceness", niceness, {0, 19}, "so much the recorder steps back behind those that it listens to");
  binder.field("in_place", in_place, "take images from the camera's shared memory instead of having them sent");
}

}  // namespace rtd::recorder
