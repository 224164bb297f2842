// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace rtd::launcher {

/// The command `rtd`: its own subcommands, and every rtd-<service> that is installed. Returns the exit code.
int front(int argc, char** argv);

}  // namespace rtd::launcher
