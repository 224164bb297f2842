// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/fastdds/raw_qos.hpp"

#include "common/bus/fastdds/qos_mapping.hpp"
#include "common/bus/fastdds/raw_codec.hpp"

namespace rtd::bus::fastdds {
namespace {

namespace dds = eprosima::fastdds::dds;
using eprosima::fastrtps::c_TimeInfinite;
using eprosima::fastrtps::Duration_t;

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

dds::DataReaderQos raw_reader_qos(const RawReaderOptions& options) {
  auto qos = reader_qos({options.depth, options.transient_local, options.in_place, 0, 0}, options.in_place);
  set_reliability(qos.reliability(), options.reliable);
  qos.type_consistency().representation.m_value = {dds::XCDR_DATA_REPRESENTATION, dds::XCDR2_DATA_REPRESENTATION};
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

TopicWriter to_topic_writer(const eprosima::fastrtps::rtps::WriterProxyData& data) {
  const auto& offered = data.m_qos;
  TopicWriter writer;
  writer.id = to_writer_id(data.guid());
  writer.topic.name = data.topicName().to_string();
  writer.topic.type = data.typeName().to_string();
  writer.topic.keyed = data.topicKind() == eprosima::fastrtps::rtps::WITH_KEY;
  writer.user_data.assign(offered.m_userData.begin(), offered.m_userData.end());
  writer.shared_memory = !offered.data_sharing.domain_ids().empty();
  writer.qos.reliable = offered.m_reliability.kind == dds::RELIABLE_RELIABILITY_QOS;
  writer.qos.durability = static_cast<RawQos::Durability>(offered.m_durability.kind);
  writer.qos.deadline_ns = nanoseconds(offered.m_deadline.period);
  writer.qos.lifespan_ns = nanoseconds(offered.m_lifespan.duration);
  writer.qos.liveliness = static_cast<RawQos::Liveliness>(offered.m_liveliness.kind);
  writer.qos.liveliness_lease_ns = nanoseconds(offered.m_liveliness.lease_duration);
  return writer;
}

}  // namespace rtd::bus::fastdds
