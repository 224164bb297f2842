// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace rtd::camera {

/// Text of config/cameras/tum_fr<family>.yaml, family 1..3. The definition is generated from these files.
const std::string& tum_camera_yaml(int family);

}  // namespace rtd::camera
