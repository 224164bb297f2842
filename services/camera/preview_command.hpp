// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace rtd::camera {

/// Whether the command line asks for a preview instead of a service.
bool wants_preview(int argc, char** argv);

/// `rtd-camera --preview --source URI [--seconds 3] [--picture preview.png] [bus options]`: plays the source for a
/// while, prints its figures and writes a picture. Publishes nothing. Returns the exit code: 1 when no frame came.
int run_preview(int argc, char** argv);

}  // namespace rtd::camera
