// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/recorder/inspect/info_command.hpp"

#include <CLI/CLI.hpp>
#include <ostream>

#include "common/mcap/recording_file.hpp"
#include "common/service/exit_code.hpp"
#include "common/service/progress.hpp"
#include "services/recorder/inspect/report_text.hpp"

namespace rtd::recording {

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
    const mcap::FileSource source = mcap::open_recording(options.file);
    service::Progress progress(err, "reading", source.size());
    ReportOptions how;
    how.check = options.check;
    how.on_progress = [&](std::uint64_t bytes) { progress.reach(bytes); };
    RecordingReport report = report_on(source, how);
    report.being_written = source.being_written();
    if (options.json) {
      out << to_json(report, options.file).dump(2) << "\n";
    } else {
      out << to_text(report, options.file);
    }
    return report.damaged() ? service::kPartialLoss : service::kOk;
  } catch (const mcap::RecordingFileError& error) {
    err << "rtd info: " << error.what() << "\n";
    return service::kUsageOrConfig;
  }
}

}  // namespace rtd::recording
