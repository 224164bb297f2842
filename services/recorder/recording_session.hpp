// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/service/exit_code.hpp"
#include "common/service/runtime.hpp"
#include "services/recorder/core/output_files.hpp"
#include "services/recorder/core/recording.hpp"
#include "services/recorder/people/blur_line.hpp"
#include "services/recorder/topic_readers.hpp"

namespace rtd::recorder {

/// Section `record` of the configuration.
struct ServiceConfig {
  std::vector<std::string> topics{"*"};
  std::string output;
  std::string folder;
  std::string split;
  std::string compression = "none";
  bool force = false;
  bool beside = false;
  bool blur_people = false;
  bool json = false;
  bool wait = false;
  int queue_mib = 256;
  int chunk_kib = 1024;
  int chunk_ms = 100;
  int sync_pause_ms = 50;
  int min_free_mib = 64;
  int niceness = 5;
  bool in_place = false;

  void bind(auto& binder) {
    binder
        .field("topics", topics, "shell patterns of DDS or ROS 2 names: 'rt/slam/*', /slam/odometry; empty: all topics")
        .option("--topics");
    binder.field("output", output, "FILE.mcap, or a folder in the layout of rosbag2; empty: rtd_DATE-TIME")
        .option("-o,--output");
    binder
        .field("folder", folder,
               "folder of the recordings that recorder/start may name; empty: that of output, else $STATE_DIRECTORY, "
               "else the working folder")
        .option("--recordings-dir");
    binder.field("split", split, "size or duration after which a new file begins, e.g. 1GB or 60s; empty: one file")
        .option("--split");
    binder.choice("compression", compression, {"none", "lz4", "zstd"}, "compression of chunks").option("--compress");
    binder.field("force", force, "replace an earlier recording").option("--force");
    binder.field("beside", beside, "keep an earlier recording and take the next free name: run.1.mcap")
        .option("--beside");
    binder
        .field("blur_people", blur_people,
               "pixelate people in images, by the detector's boxes; images without detections as a whole")
        .option("--blur-people");
    binder.field("json", json, "print the final report as JSON on stdout").option("--json");
    binder.field("wait", wait, "record nothing until the command recorder/start (rtd call)").option("--wait");
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

/// "rtd_DATE-TIME": of a recording without a name, local time.
std::string dated_name();

/// One recording from its first file to its last. For one thread.
class RecordingSession {
 public:
  /// Throws ConfigError when the output cannot be written.
  RecordingSession(const ServiceConfig& config, service::Runtime& runtime);
  RecordingSession(const RecordingSession&) = delete;
  RecordingSession& operator=(const RecordingSession&) = delete;

  /// Subscribes. The bus outlives the session.
  void listen(bus::RawBus& bus);
  /// Waits a moment for messages and writes them. False when the recording cannot continue: finish() says why.
  bool turn();
  /// Ends the recording; what was written stays. kPartialLoss: something was lost, or it ended early.
  service::ExitCode finish();

  std::string path() const;  ///< of the first file, absolute
  std::uint64_t bytes() const { return recording_->bytes(); }
  TopicCounts totals() const { return book_.totals(); }
  const std::string& failure() const { return failure_; }  ///< why it ended early

 private:
  std::shared_ptr<io::ByteSink> open_sink(std::size_t number) const;
  /// Writes what has come and need not wait. `ended`: nothing more comes.
  void write_queued(bool ended);
  void write_messages();
  void write_rest();
  void report_state(std::int64_t now_ns);
  void publish_metrics(const Acknowledged& acknowledged, const TopicCounts& totals);
  void set_state(const TopicCounts& totals);
  void show_progress(std::int64_t now_ns, const TopicCounts& totals);
  void watch_disk();
  void write_metadata(const std::string& text) const;
  /// Something was lost, or it ended early.
  bool is_partial(const TopicCounts& totals) const { return !failure_.empty() || totals.lost() > 0; }
  nlohmann::json report() const;
  service::ExitCode conclude();

  const ServiceConfig config_;
  service::Runtime& runtime_;
  const OutputFiles files_;
  TopicRegistry book_;
  MessageQueue queue_;
  std::optional<SyncThread> sync_;
  std::optional<Recording> recording_;
  std::optional<BlurLine> blur_line_;
  std::optional<TopicReaders> readers_;
  std::int64_t started_ns_ = 0, reported_ns_ = 0, progress_ns_ = 0;
  std::uint64_t progress_bytes_ = 0, free_bytes_ = 0;
  bool interactive_ = false, waiting_logged_ = false, stepped_back_ = false;
  std::string failure_;
};

}  // namespace rtd::recorder
