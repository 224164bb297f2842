// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

namespace rtd::recorder {

/// The commands of rtd-record that work on files and need no bus:
/// - `recover FILE [-o OUT]` writes what is intact in a damaged or unfinished recording to a well-formed file;
/// - `join FOLDER|PART... -o OUT` joins the parts of a split recording in the order of their first messages.
/// Returns the exit code: 0; 1 failed; 2 wrong options, or a file that cannot be used; 3 something in a file is lost.
/// Empty when the command line names neither.
std::optional<int> run_file_command(int argc, char** argv);

}  // namespace rtd::recorder
