// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace rtd::recorder {

/// Whether the command line asks for `rtd-record join PART...` instead of a service.
bool wants_join(int argc, char** argv);

/// `rtd-record join FOLDER|PART... -o OUT`: the parts of a split recording as one file, in the order of their first
/// messages. No bus. Returns the exit code: 3 when something of a part is lost.
int run_join(int argc, char** argv);

}  // namespace rtd::recorder
