// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace rtd::recorder {

/// Whether the command line asks for `rtd-record recover FILE` instead of a service.
bool wants_recover(int argc, char** argv);

/// `rtd-record recover FILE [-o OUT]`: what is whole in a damaged or unfinished recording, as a well-formed one. No
/// bus. Returns the exit code: 3 when something of the file is lost.
int run_recover(int argc, char** argv);

}  // namespace rtd::recorder
