// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "tests/support/simulated_detector.hpp"

namespace rtd::test_support {

/// Answers from a file (JSON, by frame number), and what is not in it from `look`, written there at the end: many runs
/// over one source need its network only once. The file belongs to one source and one network: this is not checked.
/// Throws std::invalid_argument for a file that is not one of its own.
Look remembered_look(Look look, const std::string& file);

/// The same for masks.
LookAtPixels remembered_pixels(LookAtPixels look, const std::string& file);

}  // namespace rtd::test_support
