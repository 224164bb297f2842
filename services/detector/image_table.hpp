// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace rtd::detector {

/// True when the first argument is --image: `rtd-detector --image FILE... [--model M] [--confidence C]`.
bool asks_for_image_table(int argc, const char* const* argv);

/// Prints what the detector finds in image files as a table, without any bus. Exit code: 0, 1 when a file is not an
/// image, 2 for wrong arguments or without weights.
int print_image_table(int argc, const char* const* argv);

}  // namespace rtd::detector
