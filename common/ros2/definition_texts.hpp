// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace rtd::ros2 {

/// The text of idl/rtd_msgs.idl.
const std::string& own_idl();

}  // namespace rtd::ros2
