// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/recorder/inspect/info_command.hpp"

#include <CLI/CLI.hpp>
#include <ostream>

#include "common/service/exit_code.hpp"
#include "common/service/progress.hpp"
#include "services/recorder/inspect/recording_file.hpp"
#include "services/recorder/inspect/report_text.hpp"

namespace rtd::launcher {

CLI::App* add_info_command(CLI::App& parent, InfoOptions& options) {
  CLI::App* command =
      parent.add_subcommand("info", "What is in a recording (MCAP): topics, rates, gaps, losses, damage");
  command->add_option("file", options.file, "Recording")->required();
  command->add_flag("--json", options.json, "Print JSON instead of text");
  command->add_flag("--check", options.check, "Read everything and compare all checksums (files up to 64 MB: always)");
  return command;
}

int run_info(const InfoOptions& options, std::ostream& out, std::ostream& err) {
  try {
    const mcap::FileSource source = open_recording(options.file);
    service::Progress progress(err, "reading", source.size());
    recording::ReportOptions how;
    how.check = options.check;
    how.on_progress = [&](std::uint64_t bytes) { progress.reach(bytes); };
    recording::RecordingReport report = recording::report_on(source, how);
    report.being_written = source.being_written();
    if (options.json) {
      out << recording::to_json(report, options.file).dump(2) << "\n";
    } else {
      out << recording::to_text(report, options.file);
    }
    return report.damaged() ? service::kPartialLoss : service::kOk;
  } catch (const RecordingFileError& error) {
    err << "rtd info: " << error.what() << "\n";
    return service::kUsageOrConfig;
  }
}

}  // namespace rtd::launcher
