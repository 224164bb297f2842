// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "common/msg/atlas.hpp"

namespace rtd::atlas {

/// A table for people: a line for each robot.
std::string to_table(const msg::AtlasState& state);

/// `rtd atlas status`: what the atlas of the domain says. Returns the exit code: 0; 1 when there is none; 2 for wrong
/// arguments.
int run_status(int argc, char** argv);

}  // namespace rtd::atlas
