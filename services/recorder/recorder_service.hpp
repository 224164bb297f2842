// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/service/exit_code.hpp"
#include "common/service/runtime.hpp"
#include "services/recorder/core/output_files.hpp"
#include "services/recorder/core/recording.hpp"
#include "services/recorder/topic_readers.hpp"

namespace CLI {
class App;
}

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

/// Records every wanted topic of the domain into MCAP files. It only subscribes, so no publisher waits for it. Its
/// heartbeat reports what is on disk for certain. It ends in good order when asked to, or when the disk is full.
class RecorderService {
 public:
  static constexpr const char* kName = "record";
  static constexpr const char* kDescription = "Record topics of any type to MCAP files, byte for byte";
  using Config = ServiceConfig;
  static void add_options(CLI::App& app, Config& config);

  /// Throws ConfigError when the output cannot be written.
  RecorderService(const Config& config, service::Runtime& runtime);
  RecorderService(const RecorderService&) = delete;
  RecorderService& operator=(const RecorderService&) = delete;
  service::ExitCode run();

 private:
  std::shared_ptr<io::ByteSink> open_sink(std::size_t number) const;
  void record();
  void record_until_stopped();
  void finish();
  void report_state(std::int64_t now_ns);
  void publish_metrics(const Acknowledged& acknowledged, const TopicCounts& totals);
  void set_state(const TopicCounts& totals);
  void show_progress(std::int64_t now_ns, const TopicCounts& totals);
  void watch_disk();
  service::ExitCode conclude();

  const Config config_;
  service::Runtime& runtime_;
  const OutputFiles files_;
  TopicBook book_;
  MessageQueue queue_;
  std::optional<SyncThread> sync_;
  std::optional<Recording> recording_;
  std::shared_ptr<bus::RawBus> bus_;
  std::optional<TopicReaders> readers_;
  std::int64_t started_ns_ = 0, reported_ns_ = 0, progress_ns_ = 0;
  std::uint64_t progress_bytes_ = 0, free_bytes_ = 0;
  bool interactive_ = false, waiting_logged_ = false, stepped_back_ = false;
  std::string failure_;  ///< why it ended early
};

}  // namespace rtd::recorder
