// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>

namespace CLI {
class App;
}

namespace rtd::recording {

/// What `rtd info` was asked.
struct InfoOptions {
  std::string file;
  bool json = false;
  bool check = false;  ///< read everything, whatever the size
};

/// Adds the subcommand `info`; parsing fills `options`, which must outlive `parent`.
CLI::App* add_info_command(CLI::App& parent, InfoOptions& options);

/// Writes the report to `out`, what prevents it with the fix and the progress to `err`. Returns the exit code: 0; 2
/// when there is no such file or it is no MCAP; 3 when it is damaged or cut, behind all that is readable.
int run_info(const InfoOptions& options, std::ostream& out, std::ostream& err);

}  // namespace rtd::recording
