// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

namespace rtd::ros2 {

/// The files of common/ros2/msg by "package/Type".
const std::map<std::string, std::string>& message_texts();
/// idl/rtd_msgs.idl.
const std::string& own_idl();

}  // namespace rtd::ros2
