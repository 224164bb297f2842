// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/cyclonedds/qos_mapping.hpp"

#include "common/ros2/type_description.hpp"

namespace rtd::bus::cyclonedds {
namespace {

constexpr int kUsualDepth = 10;  // of ROS 2

dds_duration_t duration(std::int64_t ns) {
  return ns == kUnlimitedNs ? DDS_INFINITY : ns;
}
std::int64_t milliseconds(int ms) {
  return ms > 0 ? std::int64_t{ms} * 1'000'000 : kUnlimitedNs;
}

/// What writers and readers have in common.
Qos endpoint_qos(const RawQos& asked) {
  Qos qos(dds_create_qos());
  const int depth = asked.depth > 0 ? asked.depth : kUsualDepth;
  dds_qset_reliability(qos.get(), asked.reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT,
                       DDS_MSECS(100));
  dds_qset_durability(qos.get(), static_cast<dds_durability_kind_t>(asked.durability));
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, depth);
  dds_qset_resource_limits(qos.get(), DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
  dds_qset_liveliness(qos.get(), static_cast<dds_liveliness_kind_t>(asked.liveliness),
                      duration(asked.liveliness_lease_ns));
  dds_qset_deadline(qos.get(), duration(asked.deadline_ns));
  dds_qset_latency_budget(qos.get(), 0);
  dds_qset_ownership(qos.get(), DDS_OWNERSHIP_SHARED);
  dds_qset_destination_order(qos.get(), DDS_DESTINATIONORDER_BY_RECEPTION_TIMESTAMP);
  dds_qset_presentation(qos.get(), DDS_PRESENTATION_INSTANCE, false, false);
  dds_qset_partition(qos.get(), 0, nullptr);
  dds_qset_ignorelocal(qos.get(), DDS_IGNORELOCAL_NONE);
  const dds_data_representation_id_t xcdr1 = DDS_DATA_REPRESENTATION_XCDR1;
  dds_qset_data_representation(qos.get(), 1, &xcdr1);
  return qos;
}

}  // namespace

RawQos to_raw_qos(const QosSettings& settings) {
  RawQos qos;
  qos.durability = settings.transient_local ? RawQos::Durability::kTransientLocal : RawQos::Durability::kVolatile;
  qos.depth = settings.depth;
  qos.deadline_ns = milliseconds(settings.deadline_ms);
  qos.liveliness_lease_ns = milliseconds(settings.liveliness_lease_ms);
  return qos;
}

Qos writer_qos(const RawQos& offered) {
  Qos qos = endpoint_qos(offered);
  const int depth = offered.depth > 0 ? offered.depth : kUsualDepth;
  dds_qset_durability_service(qos.get(), 0, DDS_HISTORY_KEEP_LAST, depth, DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED,
                              DDS_LENGTH_UNLIMITED);  // what late readers get; Cyclone's own default is 1
  dds_qset_lifespan(qos.get(), duration(offered.lifespan_ns));
  dds_qset_ownership_strength(qos.get(), 0);
  dds_qset_transport_priority(qos.get(), 0);
  dds_qset_writer_data_lifecycle(qos.get(), false);
  return qos;
}

Qos reader_qos(const RawQos& requested) {
  Qos qos = endpoint_qos(requested);
  dds_qset_time_based_filter(qos.get(), 0);
  dds_qset_reader_data_lifecycle(qos.get(), DDS_INFINITY, DDS_INFINITY);
  dds_qset_type_consistency(qos.get(), DDS_TYPE_CONSISTENCY_ALLOW_TYPE_COERCION, true, true, false, false, false);
  return qos;
}

Qos raw_reader_qos(const RawReaderOptions& options) {
  RawQos asked;
  asked.reliable = options.reliable;
  asked.durability = options.transient_local ? RawQos::Durability::kTransientLocal : RawQos::Durability::kVolatile;
  asked.depth = options.depth;
  Qos qos = reader_qos(asked);
  const dds_data_representation_id_t any[] = {DDS_DATA_REPRESENTATION_XCDR1, DDS_DATA_REPRESENTATION_XCDR2};
  dds_qset_data_representation(qos.get(), 2, any);
  return qos;
}

RawQos from_vendor(const dds_qos_t& qos) {
  RawQos offered;
  dds_reliability_kind_t reliability = DDS_RELIABILITY_BEST_EFFORT;
  dds_durability_kind_t durability = DDS_DURABILITY_VOLATILE;
  dds_liveliness_kind_t liveliness = DDS_LIVELINESS_AUTOMATIC;
  dds_duration_t blocking = 0, lease = DDS_INFINITY;
  const auto unlimited = [](dds_duration_t time) { return time == DDS_INFINITY ? kUnlimitedNs : std::int64_t{time}; };
  if (dds_qget_reliability(&qos, &reliability, &blocking)) offered.reliable = reliability == DDS_RELIABILITY_RELIABLE;
  if (dds_qget_durability(&qos, &durability)) offered.durability = static_cast<RawQos::Durability>(durability);
  if (dds_qget_liveliness(&qos, &liveliness, &lease)) {
    offered.liveliness = static_cast<RawQos::Liveliness>(liveliness);
    offered.liveliness_lease_ns = unlimited(lease);
  }
  dds_duration_t time = DDS_INFINITY;
  if (dds_qget_deadline(&qos, &time)) offered.deadline_ns = unlimited(time);
  if (dds_qget_lifespan(&qos, &time)) offered.lifespan_ns = unlimited(time);
  return offered;
}

void set_type_hash(dds_qos_t& qos, const std::string& dds_type) {
  const std::string text = ros2::user_data_of(dds_type);
  if (!text.empty()) dds_qset_userdata(&qos, text.data(), text.size());
}

std::string user_data(const dds_qos_t& qos) {
  void* bytes = nullptr;
  std::size_t size = 0;
  if (!dds_qget_userdata(&qos, &bytes, &size) || bytes == nullptr) return {};
  const std::string text(static_cast<const char*>(bytes), size);
  dds_free(bytes);
  return text;
}

std::string name_of(std::uint32_t policy) {
  if (policy == DDS_DATA_REPRESENTATION_QOS_POLICY_ID) return "DATA_REPRESENTATION";
  if (policy == DDS_TYPE_CONSISTENCY_ENFORCEMENT_QOS_POLICY_ID) return "TYPE_CONSISTENCY";
  return policy_name(policy);
}

}  // namespace rtd::bus::cyclonedds
