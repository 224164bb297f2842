// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

namespace rtd::eval {

/// How far away the background of a source is: the upper quartile of the depths in some of its first frames. Only of
/// TUM folders and synthetic scenes; none where no frame can be read.
std::optional<double> scene_depth_m(const std::string& source_uri);

}  // namespace rtd::eval
