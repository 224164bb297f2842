// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "common/service/exit_code.hpp"
#include "common/service/runtime.hpp"
#include "services/recorder/config.hpp"
#include "services/recorder/core/output_files.hpp"
#include "services/recorder/core/recording.hpp"
#include "services/recorder/report.hpp"
#include "services/recorder/topic_readers.hpp"

namespace CLI {
class App;
}

namespace rtd::recorder {

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
