// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "common/bus/fastdds/versions/vendor.hpp"
#include "common/bus/raw_bus.hpp"
#include "common/ros2/type_description.hpp"

namespace rtd::bus::fastdds {

/// Every policy is set explicitly: the defaults of the vendors differ from each other and from DDS.
/// `plain`: the type has a fixed size.
dds::DataWriterQos writer_qos(const QosSettings& settings, bool plain);
dds::DataReaderQos reader_qos(const QosSettings& settings, bool plain);

/// Asks for nothing that would keep a writer from matching: no deadline, no liveliness, any data representation.
dds::DataReaderQos raw_reader_qos(const RawReaderOptions& options);
dds::DataWriterQos raw_writer_qos(const RawWriterOptions& options);

/// By what endpoints know each other that share rings in the folder; RingClaims keeps others from using it.
std::uint64_t ring_id(const std::string& folder);

/// An endpoint with a ring has it in `folder` (host/ring_folder.hpp), and shares it with those that have theirs there
/// too, on this host, and with the same version of Fast DDS: others lay the memory out differently, and the process
/// that opens it aborts. Without a folder, samples go through the transports, as to all others.
void place_ring(dds::DataSharingQosPolicy& policy, const std::string& folder);

/// With the type's hash in the user data, for ROS 2 (common/ros2/type_description.hpp).
template <class Qos>
Qos with_type_hash(Qos qos, const std::string& dds_type) {
  const std::string text = ros2::user_data_of(dds_type);
  qos.user_data().data_vec({text.begin(), text.end()});
  return qos;
}

/// DDS name of a policy, e.g. "RELIABILITY".
std::string name_of(dds::QosPolicyId_t id);

}  // namespace rtd::bus::fastdds
