// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace rtd::eval::testing_support {

/// Whether node is installed, which runs the scripts of pages.
bool has_node();

/// What a page of the evaluation shows: the markup that its script makes. A broken script fails the test.
/// width_px: of the window; turned_px: after that, once it has drawn.
std::string rendered(const std::string& html, const std::string& scratch_file, int width_px = 1280, int turned_px = 0);

}  // namespace rtd::eval::testing_support
