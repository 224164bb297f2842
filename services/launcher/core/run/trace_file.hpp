// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace rtd::launcher {

/// Joins what the services wrote into `folder` (common/service/trace.hpp) to one file in the Trace Event Format, which
/// Perfetto and chrome://tracing open, and removes the folder. The last line of a killed process may be cut off; it is
/// left out. Returns why that failed; empty when it did not.
std::string join_trace(const std::string& folder, const std::string& path);

}  // namespace rtd::launcher
