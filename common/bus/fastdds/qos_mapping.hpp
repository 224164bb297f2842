// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fastdds/dds/publisher/qos/DataWriterQos.hpp>
#include <fastdds/dds/subscriber/qos/DataReaderQos.hpp>
#include <string>

#include "common/bus/qos_settings.hpp"

namespace rtd::bus::fastdds {

/// Every policy is set explicitly: the defaults of the vendors differ from each other and from DDS.
/// `plain`: the type has a fixed size.
eprosima::fastdds::dds::DataWriterQos writer_qos(const QosSettings& settings, bool plain);
eprosima::fastdds::dds::DataReaderQos reader_qos(const QosSettings& settings, bool plain);

/// With the type's hash in the user data, for ROS 2 (common/ros2/type_hash.hpp).
eprosima::fastdds::dds::DataWriterQos with_type_hash(eprosima::fastdds::dds::DataWriterQos qos,
                                                     const std::string& dds_type);
eprosima::fastdds::dds::DataReaderQos with_type_hash(eprosima::fastdds::dds::DataReaderQos qos,
                                                     const std::string& dds_type);

/// DDS name of a policy, e.g. "RELIABILITY".
std::string policy_name(eprosima::fastdds::dds::QosPolicyId_t id);

}  // namespace rtd::bus::fastdds
