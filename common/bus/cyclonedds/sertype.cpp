// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <functional>

#include "common/bus/cyclonedds/serdata.hpp"

namespace rtd::bus::cyclonedds {
namespace {

const SampleType& description(const ddsi_sertype* type) {
  return static_cast<const Sertype*>(type)->description;
}

void free_type(ddsi_sertype* type) {
  ddsi_sertype_fini(type);
  delete static_cast<Sertype*>(type);
}

bool equal(const ddsi_sertype* a, const ddsi_sertype* b) {
  return description(a) == description(b);
}

std::uint32_t hash(const ddsi_sertype* type) {
  const SampleType& own = description(type);
  return own.plain_bytes * 4 + (own.keyed ? 1U : 0U) + (own.any_representation ? 2U : 0U);
}

// Samples as structures are never asked for: we take and give serialised ones. Loans through iceoryx need no more.
void zero_samples(const ddsi_sertype*, void*, std::size_t) {}
void realloc_samples(void** pointers, const ddsi_sertype*, void*, std::size_t, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) pointers[i] = nullptr;
}
void free_samples(const ddsi_sertype*, void**, std::size_t, dds_free_op_t) {}

constexpr ddsi_sertype_ops type_ops() {
  ddsi_sertype_ops ops{};
  ops.version = ddsi_sertype_v0;
  ops.free = free_type;
  ops.zero_samples = zero_samples;
  ops.realloc_samples = realloc_samples;
  ops.free_samples = free_samples;
  ops.equal = equal;
  ops.hash = hash;
  return ops;  // without serialize_into() only types of fixed size go through iceoryx
}

}  // namespace

ddsi_sertype* create_sertype(const SampleType& description) {
  static const ddsi_sertype_ops kOps = type_ops();
  auto type = std::make_unique<Sertype>();
  type->description = description;
  std::uint32_t flags = description.keyed ? 0 : DDSI_SERTYPE_FLAG_TOPICKIND_NO_KEY;
  if (description.plain_bytes > 0) flags |= DDSI_SERTYPE_FLAG_FIXED_SIZE;
  ddsi_sertype_init_flags(type.get(), description.name.c_str(), &kOps, &serdata_ops(), flags);
  type->allowed_data_representation = DDS_DATA_REPRESENTATION_FLAG_XCDR1;
  if (description.any_representation) type->allowed_data_representation |= DDS_DATA_REPRESENTATION_FLAG_XCDR2;
#ifdef DDS_HAS_SHM
  type->iox_size = description.plain_bytes;
#endif
  return type.release();
}

void destroy_sertype(ddsi_sertype* type) {
  ddsi_sertype_unref(type);
}

}  // namespace rtd::bus::cyclonedds
