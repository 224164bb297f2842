// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>

#include "common/bus/commands.hpp"
#include "common/io/named_files.hpp"
#include "common/service/config.hpp"
#include "services/recorder/recording_session.hpp"

namespace CLI {
class App;
}

namespace rtd::recorder {

/// Records every wanted topic of the domain into MCAP files. It only subscribes, so no publisher waits for it. Its
/// heartbeat reports what is on disk for certain. It ends in good order when asked to, or when the disk is full. The
/// commands recorder/start and recorder/stop begin and end recordings meanwhile.
class RecorderService {
 public:
  static constexpr const char* kName = "record";
  static constexpr const char* kDescription = "Record topics of any type to MCAP files, byte for byte";
  using Config = ServiceConfig;
  static void add_options(CLI::App& app, std::vector<service::GivenOption>& given);

  /// Throws ConfigError when the output cannot be written.
  RecorderService(const Config& config, service::Runtime& runtime);
  RecorderService(const RecorderService&) = delete;
  RecorderService& operator=(const RecorderService&) = delete;
  service::ExitCode run();

 private:
  void offer_commands();
  bus::CommandAnswer start(const std::string& name);
  std::string output_of(const std::string& name) const;
  bus::CommandAnswer stop();
  void end_session();
  void show_recording();

  Config config_;
  const io::NamedFiles recordings_;
  service::Runtime& runtime_;
  std::shared_ptr<bus::RawBus> bus_;
  std::optional<RecordingSession> session_;     ///< none while nothing is recorded
  service::ExitCode result_ = service::kOk;     ///< the worst of all recordings
  bool ended_early_ = false;                    ///< a recording that was not stopped
  std::optional<bus::CommandServer> commands_;  // last: it uses the others
};

}  // namespace rtd::recorder
