// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <string>

namespace rtd::service {

/// "x,y,z,qx,qy,qz,qw" (m, Hamilton, made of unit length) as a transform. Throws ConfigError that names the
/// key.
Eigen::Isometry3d parse_mount(const std::string& text, const std::string& key = "slam.base.camera");

}  // namespace rtd::service
