// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/fastdds/qos_mapping.hpp"

#include "common/ros2/type_hash.hpp"

namespace rtd::bus::fastdds {
namespace {

namespace dds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;
using eprosima::fastrtps::c_TimeInfinite;
using eprosima::fastrtps::Duration_t;

Duration_t milliseconds(int ms) {
  return {ms / 1000, static_cast<std::uint32_t>(ms % 1000) * 1'000'000U};
}

/// A lost sample is noticed and repaired within some ms, not after Fast DDS's default 3 s.
constexpr int kHeartbeatPeriodMs = 10, kResponseDelayMs = 1;

/// What DataWriterQos and DataReaderQos have in common.
template <class Qos>
Qos endpoint_qos(const QosSettings& settings, bool plain) {
  Qos qos;
  qos.reliability().kind = dds::RELIABLE_RELIABILITY_QOS;
  qos.reliability().max_blocking_time = milliseconds(100);
  qos.durability().kind = settings.transient_local ? dds::TRANSIENT_LOCAL_DURABILITY_QOS : dds::VOLATILE_DURABILITY_QOS;
  qos.history().kind = dds::KEEP_LAST_HISTORY_QOS;
  qos.history().depth = settings.depth;
  qos.resource_limits().max_samples = settings.depth;
  qos.resource_limits().max_instances = 1;
  qos.resource_limits().max_samples_per_instance = settings.depth;
  qos.resource_limits().allocated_samples = 1;
  qos.resource_limits().extra_samples = 1;  // one on loan
  qos.liveliness().kind = dds::AUTOMATIC_LIVELINESS_QOS;
  if (settings.liveliness_lease_ms > 0) {
    qos.liveliness().lease_duration = milliseconds(settings.liveliness_lease_ms);
    qos.liveliness().announcement_period = milliseconds(settings.liveliness_lease_ms / 3);
  } else {
    qos.liveliness().lease_duration = c_TimeInfinite;
    qos.liveliness().announcement_period = c_TimeInfinite;
  }
  qos.deadline().period = settings.deadline_ms > 0 ? milliseconds(settings.deadline_ms) : c_TimeInfinite;
  qos.lifespan().duration = c_TimeInfinite;
  qos.ownership().kind = dds::SHARED_OWNERSHIP_QOS;
  qos.destination_order().kind = dds::BY_RECEPTION_TIMESTAMP_DESTINATIONORDER_QOS;
  if (settings.data_sharing && plain) {
    qos.data_sharing().automatic();
  } else {
    qos.data_sharing().off();
  }
  qos.endpoint().history_memory_policy =
      plain ? rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE : rtps::DYNAMIC_REUSABLE_MEMORY_MODE;
  return qos;
}

template <class Qos>
Qos hashed(Qos qos, const std::string& dds_type) {
  const std::string text = ros2::user_data_of(dds_type);
  qos.user_data().data_vec({text.begin(), text.end()});
  return qos;
}

}  // namespace

dds::DataWriterQos writer_qos(const QosSettings& settings, bool plain) {
  auto qos = endpoint_qos<dds::DataWriterQos>(settings, plain);
  if (qos.data_sharing().kind() != dds::OFF) {
    // Fast DDS 2.9 takes acknowledged samples of a volatile writer out of its history in whatever thread brought the
    // acknowledgement. With several readers a slot of the shared pool then gets lost now and then, and write() fails
    // for good with OUT_OF_RESOURCES (a race like eProsima/Fast-DDS#5762). A transient-local writer only lets go of
    // samples in write(). Readers stay volatile: they are not given old frames.
    qos.durability().kind = dds::TRANSIENT_LOCAL_DURABILITY_QOS;
  }
  qos.publish_mode().kind = dds::SYNCHRONOUS_PUBLISH_MODE;
  qos.representation().m_value = {dds::XCDR_DATA_REPRESENTATION};
  qos.reliable_writer_qos().times.initialHeartbeatDelay = milliseconds(1);  // where Cyclone's volatile readers begin
  qos.reliable_writer_qos().times.heartbeatPeriod = milliseconds(kHeartbeatPeriodMs);
  qos.reliable_writer_qos().times.nackResponseDelay = milliseconds(kResponseDelayMs);
  return qos;
}

dds::DataReaderQos reader_qos(const QosSettings& settings, bool plain) {
  auto qos = endpoint_qos<dds::DataReaderQos>(settings, plain);
  qos.type_consistency().representation.m_value = {dds::XCDR_DATA_REPRESENTATION};
  qos.reliable_reader_qos().times.heartbeatResponseDelay = milliseconds(kResponseDelayMs);
  return qos;
}

dds::DataWriterQos with_type_hash(dds::DataWriterQos qos, const std::string& dds_type) {
  return hashed(std::move(qos), dds_type);
}

dds::DataReaderQos with_type_hash(dds::DataReaderQos qos, const std::string& dds_type) {
  return hashed(std::move(qos), dds_type);
}

std::string policy_name(dds::QosPolicyId_t id) {
  switch (id) {
    case dds::DURABILITY_QOS_POLICY_ID:
      return "DURABILITY";
    case dds::PRESENTATION_QOS_POLICY_ID:
      return "PRESENTATION";
    case dds::DEADLINE_QOS_POLICY_ID:
      return "DEADLINE";
    case dds::LATENCYBUDGET_QOS_POLICY_ID:
      return "LATENCY_BUDGET";
    case dds::OWNERSHIP_QOS_POLICY_ID:
      return "OWNERSHIP";
    case dds::LIVELINESS_QOS_POLICY_ID:
      return "LIVELINESS";
    case dds::PARTITION_QOS_POLICY_ID:
      return "PARTITION";
    case dds::RELIABILITY_QOS_POLICY_ID:
      return "RELIABILITY";
    case dds::DESTINATIONORDER_QOS_POLICY_ID:
      return "DESTINATION_ORDER";
    case dds::DATAREPRESENTATION_QOS_POLICY_ID:
      return "DATA_REPRESENTATION";
    case dds::TYPECONSISTENCYENFORCEMENT_QOS_POLICY_ID:
      return "TYPE_CONSISTENCY";
    default:
      return "policy " + std::to_string(static_cast<std::uint32_t>(id));
  }
}

}  // namespace rtd::bus::fastdds
