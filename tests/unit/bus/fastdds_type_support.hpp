// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/bus/fastdds/versions/vendor.hpp"

namespace rtd::bus::fastdds {

/// A type support, ours or a generated one, by the interface of the version of Fast DDS that is installed.
class AnyType {
 public:
  using Bytes = std::vector<std::uint8_t>;
  explicit AnyType(dds::TopicDataType& type) : type_(type) {}

  bool bounded() const { return type_.is_bounded(); }

#if __has_include(<fastrtps/fastrtps_dll.h>)
  /// Whether generated code counts 100 elements for a sequence without a bound, or none.
  static constexpr bool kGeneratedCountsUnbounded = true;
  static constexpr std::uint32_t kRounding = 0;  ///< bytes that generated code may add to the largest sample
  std::string name() const {
    return type_.getName();
  }
  std::uint32_t largest() const {
    return type_.m_typeSize;
  }
  bool keyed() const {
    return type_.m_isGetKeyDefined;
  }
  bool describes_itself() const {
    return type_.type_object() != nullptr || type_.type_information() != nullptr;
  }
  void* create() {
    return type_.createData();
  }
  void destroy(void* data) {
    type_.deleteData(data);
  }
  Bytes serialised(void* data) {
    rtps::SerializedPayload_t payload(type_.getSerializedSizeProvider(data)());
    return checked(type_.serialize(data, &payload), payload);
  }
  bool deserialised(const Bytes& cdr, void* data) {
    rtps::SerializedPayload_t payload = payload_of(cdr);
    return type_.deserialize(&payload, data);
  }
#else
  static constexpr bool kGeneratedCountsUnbounded = false;
  static constexpr std::uint32_t kRounding = 4;
  std::string name() const {
    return type_.get_name();
  }
  std::uint32_t largest() const {
    return type_.max_serialized_type_size;
  }
  bool keyed() const {
    return type_.is_compute_key_provided;
  }
  bool describes_itself() const {
    return type_.type_identifiers().type_identifier1()._d() != dds::xtypes::TK_NONE;
  }
  void* create() {
    return type_.create_data();
  }
  void destroy(void* data) {
    type_.delete_data(data);
  }
  Bytes serialised(void* data) {
    rtps::SerializedPayload_t payload(type_.calculate_serialized_size(data, dds::XCDR_DATA_REPRESENTATION));
    return checked(type_.serialize(data, payload, dds::XCDR_DATA_REPRESENTATION), payload);
  }
  bool deserialised(const Bytes& cdr, void* data) {
    rtps::SerializedPayload_t payload = payload_of(cdr);
    return type_.deserialize(payload, data);
  }
#endif

 private:
  static Bytes checked(bool written, const rtps::SerializedPayload_t& payload) {
    if (!written || payload.encapsulation != CDR_LE) throw std::runtime_error("not serialised as little-endian CDR");
    return {payload.data, payload.data + payload.length};
  }
  static rtps::SerializedPayload_t payload_of(const Bytes& cdr) {
    rtps::SerializedPayload_t payload(static_cast<std::uint32_t>(cdr.size()));
    std::copy(cdr.begin(), cdr.end(), payload.data);
    payload.length = payload.max_size;
    return payload;
  }

  dds::TopicDataType& type_;
};

}  // namespace rtd::bus::fastdds
