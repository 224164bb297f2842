// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/bus/bus_factory.hpp"
#include "common/service/model_locator.hpp"

namespace rtd::service {

/// A variable that sets up the DDS of ROS 2 programs: a sentence that names it and its value.
using DdsSetting = bus::EnvironmentSetting;

/// Follows those variables that a user of ROS 2 has set and that can be followed, where no option of ours says
/// otherwise: ROS_DISCOVERY_SERVER (Fast DDS) and ROS_STATIC_PEERS, unless they name other hosts while only this one is
/// used. Profiles of a vendor (FASTRTPS_DEFAULT_PROFILES_FILE, FASTDDS_DEFAULT_PROFILES_FILE, CYCLONEDDS_URI) are not
/// read, but what they say of hosts and interfaces is named as options. Returns what was set, in a fixed order.
std::vector<DdsSetting> follow_dds_environment(const EnvironmentReader& environment, bus::BusOptions& options);

}  // namespace rtd::service
