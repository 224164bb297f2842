// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/fastdds/qos_mapping.hpp"

#include <cstdint>
#include <functional>

#include "common/bus/fastdds/codec.hpp"
#include "common/bus/network.hpp"

namespace rtd::bus::fastdds {
namespace {

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

constexpr std::int64_t kSecond = 1'000'000'000;
constexpr int kUsualDepth = 10;  // of ROS 2

Duration_t duration(std::int64_t ns) {
  if (ns == kUnlimitedNs) return c_TimeInfinite;
  return {static_cast<std::int32_t>(ns / kSecond), static_cast<std::uint32_t>(ns % kSecond)};
}

std::int64_t nanoseconds(const Duration_t& time) {
  return time == c_TimeInfinite ? kUnlimitedNs : std::int64_t{time.seconds} * kSecond + time.nanosec;
}

template <class Policy>
void set_reliability(Policy& policy, bool reliable) {
  policy.kind = reliable ? dds::RELIABLE_RELIABILITY_QOS : dds::BEST_EFFORT_RELIABILITY_QOS;
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
  // Cyclone's volatile readers begin with the first heartbeat.
  set_timing(qos, milliseconds(1), milliseconds(kHeartbeatPeriodMs), milliseconds(kResponseDelayMs));
  return qos;
}

dds::DataReaderQos reader_qos(const QosSettings& settings, bool plain) {
  auto qos = endpoint_qos<dds::DataReaderQos>(settings, plain);
  // Only so Fast DDS gives up a sample that is too large before it takes memory for it (Participant::create_reader).
  qos.endpoint().history_memory_policy = rtps::PREALLOCATED_MEMORY_MODE;
  set_representations(qos, {dds::XCDR_DATA_REPRESENTATION});
  set_timing(qos, milliseconds(kResponseDelayMs));
  return qos;
}

std::uint64_t ring_id(const std::string& folder) {
  return std::hash<std::string>()(host_partition() + folder + std::to_string(kVersion));
}

void place_ring(dds::DataSharingQosPolicy& policy, const std::string& folder) {
  if (folder.empty()) return policy.off();
  policy.automatic(folder);
  policy.add_domain_id(ring_id(folder));
}

std::string name_of(dds::QosPolicyId_t id) {
  if (id == dds::DATAREPRESENTATION_QOS_POLICY_ID) return "DATA_REPRESENTATION";
  if (id == dds::TYPECONSISTENCYENFORCEMENT_QOS_POLICY_ID) return "TYPE_CONSISTENCY";
  return policy_name(static_cast<unsigned>(id));
}

dds::DataReaderQos raw_reader_qos(const RawReaderOptions& options) {
  auto qos = reader_qos({options.depth, options.transient_local, options.in_place, 0, 0}, options.in_place);
  set_reliability(qos.reliability(), options.reliable);
  set_representations(qos, {dds::XCDR_DATA_REPRESENTATION, dds::XCDR2_DATA_REPRESENTATION});
  return qos;
}

dds::DataWriterQos raw_writer_qos(const RawWriterOptions& options) {
  const RawQos& asked = options.qos;
  const int depth = asked.depth > 0 ? asked.depth : kUsualDepth;
  const bool transient_local = asked.durability != RawQos::Durability::kVolatile;
  auto qos = writer_qos({depth, transient_local, options.fixed_bytes > 0, 0, 0}, options.fixed_bytes > 0);
  set_reliability(qos.reliability(), asked.reliable);
  qos.deadline().period = duration(asked.deadline_ns);
  qos.lifespan().duration = duration(asked.lifespan_ns);
  qos.liveliness().kind = static_cast<dds::LivelinessQosPolicyKind>(asked.liveliness);
  if (asked.liveliness_lease_ns != kUnlimitedNs) {
    qos.liveliness().lease_duration = duration(asked.liveliness_lease_ns);
    qos.liveliness().announcement_period = duration(asked.liveliness_lease_ns / 3);
  }
  return qos;
}

TopicWriter to_topic_writer(const PublicationData& data) {
  TopicWriter writer;
  writer.id = to_writer_id(data.guid);
  writer.topic.name = data.topic_name.to_string();
  writer.topic.type = data.type_name.to_string();
  writer.topic.keyed = data.topic_kind == rtps::WITH_KEY;
  writer.user_data.assign(data.user_data.begin(), data.user_data.end());
  writer.shared_memory = !data.data_sharing.domain_ids().empty();
  writer.qos.reliable = data.reliability.kind == dds::RELIABLE_RELIABILITY_QOS;
  writer.qos.durability = static_cast<RawQos::Durability>(data.durability.kind);
  writer.qos.deadline_ns = nanoseconds(data.deadline.period);
  writer.qos.lifespan_ns = nanoseconds(data.lifespan.duration);
  writer.qos.liveliness = static_cast<RawQos::Liveliness>(data.liveliness.kind);
  writer.qos.liveliness_lease_ns = nanoseconds(data.liveliness.lease_duration);
  return writer;
}

}  // namespace rtd::bus::fastdds
