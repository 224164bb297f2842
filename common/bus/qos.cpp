// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/qos.hpp"

#include <iterator>

#include "common/bus/backend.hpp"

namespace rtd::bus {

QosSettings qos_settings(QosProfile profile) {
  // clang-format off
  switch (profile) {  //                      depth  transient  sharing  lease  deadline
    case QosProfile::kRawFrame:       return {4,     false,     true,    0,     0};
    case QosProfile::kNetworkFrame:   return {8,     false,     false,   0,     0};
    case QosProfile::kLatched:        return {1,     true,      false,   0,     0};
    case QosProfile::kDetections:     return {8,     false,     false,   0,     0};
    case QosProfile::kFeatures:       return {8,     false,     false,   0,     0};
    case QosProfile::kKeyframes:      return {64,    true,      false,   0,     0};
    case QosProfile::kPose:           return {10,    false,     false,   0,     0};
    case QosProfile::kTracking:       return {64,    false,     false,   0,     0};
    case QosProfile::kHeartbeat:      return {8,     false,     false,   1000,  1000};
  }
  // clang-format on
  throw BusError("QoS profile " + std::to_string(static_cast<int>(profile)) + " is not one of common/bus/qos.hpp");
}

std::string policy_name(unsigned id) {
  constexpr const char* kNames[] = {"INVALID",          "USER_DATA",         "DURABILITY", "PRESENTATION",
                                    "DEADLINE",         "LATENCY_BUDGET",    "OWNERSHIP",  "OWNERSHIP_STRENGTH",
                                    "LIVELINESS",       "TIME_BASED_FILTER", "PARTITION",  "RELIABILITY",
                                    "DESTINATION_ORDER"};
  return id < std::size(kNames) ? kNames[id] : "policy " + std::to_string(id);
}

}  // namespace rtd::bus
