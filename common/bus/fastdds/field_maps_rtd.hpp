// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rtd_msgsPubSubTypes.h>

#include "common/bus/fastdds/field_map.hpp"
#include "common/msg/status.hpp"

/// The messages of our own that are not plain.
namespace rtd::bus::fastdds {

// clang-format off
template <> struct FieldMap<msg::Metric> {
  using Vendor = rtd_msgs::msg::dds_::Metric_;
  static void pair(auto& plain, auto& vendor, auto copy) {
    copy(plain.name, vendor.name());
    copy(plain.value, vendor.value());
  }
};
template <> struct FieldMap<msg::ServiceStatus> {
  using Vendor = rtd_msgs::msg::dds_::ServiceStatus_;
  static void pair(auto& plain, auto& vendor, auto copy) {
    copy(plain.service, vendor.service());
    copy(plain.pid, vendor.pid());
    copy(plain.started_ns, vendor.started_ns());
    copy(plain.stamp_ns, vendor.stamp_ns());
    copy(plain.state, vendor.state());
    copy(plain.message, vendor.message());
    copy(plain.metrics, vendor.metrics());
  }
};
// clang-format on

}  // namespace rtd::bus::fastdds
