// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/bus/message_types.hpp"

namespace rtd::bus {

/// The name under which every vendor registers the type, e.g. "nav_msgs::msg::dds_::Odometry_".
const char* dds_type_name(MessageId id);

}  // namespace rtd::bus
