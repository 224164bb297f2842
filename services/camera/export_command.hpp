// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace rtd::camera {

/// Whether the command line asks for `rtd-camera --export FOLDER` instead of a service.
bool wants_export(int argc, char** argv);

/// `rtd-camera --export FOLDER --source URI [--frames N]`: no bus, no service. Returns the exit code.
int run_export(int argc, char** argv);

}  // namespace rtd::camera
