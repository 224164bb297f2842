// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "services/recorder/inspect/recording_report.hpp"

namespace CLI {
class App;
}

namespace rtd::recordings {

/// The command line of `rtd diff`.
struct DiffRequest {
  std::string a, b;
  bool json = false;
  std::vector<std::string> ignore;  ///< "stamps", "run"
};

/// Adds the subcommand `diff`; parsing fills `request`, which must outlive `parent`.
CLI::App* add_diff_command(CLI::App& parent, DiffRequest& request);

/// Returns the exit code: 0 equal; 1 different; 2 when a file cannot be used; 3 when a recording is damaged and the
/// readable part is equal.
int run_diff(const DiffRequest& request, std::ostream& out, std::ostream& err);

/// The command line of `rtd info`.
struct InfoOptions {
  std::string file;
  bool json = false;
  bool check = false;  ///< read everything, whatever the size
};

/// Adds the subcommand `info`; parsing fills `options`, which must outlive `parent`.
CLI::App* add_info_command(CLI::App& parent, InfoOptions& options);

/// The report on a ROS 1 bag or a rosbag2 database (sqlite3), which is read whole; empty for any other file. Throws
/// mcap::RecordingFileError when it cannot be used at all.
std::optional<RecordingReport> report_on_other_format(const std::filesystem::path& file);

/// Writes the report to `out`, progress and errors to `err`. Returns the exit code: 0; 2 when there is no such file or
/// it is not MCAP; 3 when it is damaged or truncated, after everything readable was reported.
int run_info(const InfoOptions& options, std::ostream& out, std::ostream& err);

}  // namespace rtd::recordings
