// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/cyclonedds/samples.hpp"

#include <dds/dds.h>
#include <dds/ddsi/ddsi_keyhash.h>
#include <dds/ddsi/ddsi_serdata.h>
#include <dds/ddsi/ddsi_sertype.h>
#include <dds/ddsi/q_bswap.h>
#include <dds/ddsi/q_misc.h>
#include <dds/ddsi/q_protocol.h>
#include <dds/ddsi/q_radmin.h>

#include <algorithm>
#include <cstring>

#include "common/bus/backend.hpp"
#include "common/bus/message_cdr.hpp"
#include "common/bus/message_pool.hpp"
#include "common/msg/largest_sample.hpp"

// Cyclone's internal headers: only for this file, which gives it our samples. Never together with Fast DDS's headers.
extern "C" {}
namespace rtd::bus::cyclonedds {
namespace {

/// Cyclone's view of a SampleType.
struct Sertype : ddsi_sertype {
  SampleType description;
  MessagePool<ByteBlock> pool;
};

/// Cyclone's view of one sample. Counted by Cyclone, freed by free_sample().
struct Serdata : ddsi_serdata {
  std::shared_ptr<ByteBlock> bytes;  ///< empty: no data (a dispose or the like)
  SampleOrigin origin;
  std::int64_t received_ns = 0;
};

/// `kind` distinguishes data from a dispose.
Serdata* create_serdata(const ddsi_sertype* type, ddsi_serdata_kind kind, std::shared_ptr<ByteBlock> bytes) {
  auto* const sample = new Serdata;
  ddsi_serdata_init(sample, type, kind);
  sample->hash = type->serdata_basehash;
  sample->bytes = std::move(bytes);
  return sample;
}

constexpr std::size_t kHeaderBytes = ByteBlock::kCdrHeaderBytes;

Serdata& ours(ddsi_serdata* sample) {
  return *static_cast<Serdata*>(sample);
}
const Serdata& ours(const ddsi_serdata* sample) {
  return *static_cast<const Serdata*>(sample);
}
std::span<const std::byte> bytes_of(const ddsi_serdata* sample) {
  return ours(sample).bytes ? std::as_const(*ours(sample).bytes).view() : std::span<const std::byte>();
}

bool is_size_of(const ddsi_sertype* type, std::size_t size) {
  return size >= kHeaderBytes && size <= static_cast<const Sertype*>(type)->description.largest_bytes;
}

/// Writer and number stand in the headers of the packet that brought the first fragment. Cyclone keeps the packet and
/// has turned its numbers to our byte order; the writer's id it turned as well.
SampleOrigin origin_of(const nn_rdata& fragment) {
  SampleOrigin origin;
  const unsigned char* const packet = NN_RMSG_PAYLOAD(fragment.rmsg);
  Header_t rtps;
  Data_DataFrag_common_t data;
  std::memcpy(&rtps, packet, sizeof(rtps));
  std::memcpy(&data, packet + NN_RDATA_SUBMSG_OFF(&fragment), sizeof(data));
  const ddsi_guid_t guid = nn_hton_guid({rtps.guid_prefix, data.writerId});
  std::memcpy(origin.writer.data(), &guid, sizeof(guid));
  origin.sequence = static_cast<std::int64_t>(fromSN(data.writerSN));
  return origin;
}

/// Fragments may overlap.
bool copy_fragments(const nn_rdata* fragment, std::span<std::byte> target) {
  std::size_t copied = 0;
  for (; fragment != nullptr; fragment = fragment->nextfrag) {
    if (fragment->min > copied || fragment->maxp1 > target.size()) return false;
    if (fragment->maxp1 <= copied) continue;
    const unsigned char* const payload = NN_RMSG_PAYLOADOFF(fragment->rmsg, NN_RDATA_PAYLOAD_OFF(fragment));
    std::memcpy(target.data() + copied, payload + (copied - fragment->min), fragment->maxp1 - copied);
    copied = fragment->maxp1;
  }
  return copied == target.size();
}

ddsi_serdata* from_packets(const ddsi_sertype* type, ddsi_serdata_kind kind, const nn_rdata* fragments,
                           std::size_t size) {
  if (!is_size_of(type, size)) return nullptr;
  auto block = acquire_block(type, size);
  if (!copy_fragments(fragments, block->bytes())) return nullptr;
  Serdata* const sample = create_serdata(type, kind, std::move(block));
  sample->origin = origin_of(*fragments);
  sample->received_ns = dds_time();
  return sample;
}

ddsi_serdata* from_pieces(const ddsi_sertype* type, ddsi_serdata_kind kind, ddsrt_msg_iovlen_t count,
                          const ddsrt_iovec_t* pieces, std::size_t size) {
  if (!is_size_of(type, size)) return nullptr;
  auto block = acquire_block(type, size);
  std::size_t copied = 0;
  for (ddsrt_msg_iovlen_t i = 0; i < count && copied < size; ++i) {
    const std::size_t length = std::min<std::size_t>(pieces[i].iov_len, size - copied);
    std::memcpy(block->bytes().data() + copied, pieces[i].iov_base, length);
    copied += length;
  }
  return copied == size ? create_serdata(type, kind, std::move(block)) : nullptr;
}

ddsi_serdata* from_keyhash(const ddsi_sertype* type, const ddsi_keyhash*) {
  return create_serdata(type, SDK_KEY, nullptr);
}

/// Only for dds_write(), which we do not call.
ddsi_serdata* from_sample(const ddsi_sertype*, ddsi_serdata_kind, const void*) {
  return nullptr;
}

std::uint32_t size(const ddsi_serdata* sample) {
  return static_cast<std::uint32_t>(std::max(bytes_of(sample).size(), kHeaderBytes));
}

/// The range may end in the padding.
const std::byte* range(const ddsi_serdata* sample, std::size_t offset) {
  static const std::byte kEmptyCdr[kHeaderBytes] = {std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}};
  const auto bytes = bytes_of(sample);
  return (bytes.empty() ? kEmptyCdr : bytes.data()) + offset;
}
void to_bytes(const ddsi_serdata* sample, std::size_t offset, std::size_t length, void* target) {
  std::memcpy(target, range(sample, offset), length);
}
ddsi_serdata* lend_bytes(const ddsi_serdata* sample, std::size_t offset, std::size_t length, ddsrt_iovec_t* lent) {
  lent->iov_base = const_cast<std::byte*>(range(sample, offset));
  lent->iov_len = length;
  return ddsi_serdata_ref(sample);
}
void return_bytes(ddsi_serdata* sample, const ddsrt_iovec_t*) {
  ddsi_serdata_unref(sample);
}

// We take samples as they are, so none is ever made into a structure.
bool to_sample(const ddsi_serdata*, void*, void**, void*) {
  return false;
}
bool untyped_to_sample(const ddsi_sertype*, const ddsi_serdata*, void*, void**, void*) {
  return false;
}
/// All samples of a topic are one instance: our types have no key, and of keyed ones we do not know it.
ddsi_serdata* to_untyped(const ddsi_serdata* sample) {
  Serdata* const untyped = create_serdata(sample->type, SDK_KEY, nullptr);
  untyped->type = nullptr;
  return untyped;
}
bool equal_key(const ddsi_serdata*, const ddsi_serdata*) {
  return true;
}
void keyhash(const ddsi_serdata*, ddsi_keyhash* hash, bool) {
  std::memset(hash->value, 0, sizeof(hash->value));
}

void free_sample(ddsi_serdata* sample) {
  // Cyclone's count orders this behind the others' use of the sample; a thread sanitizer, which does not see into that
  // library, learns it from this load: they gave the sample back with an inline function, in our code.
  (void)__atomic_load_n(&sample->refc.v, __ATOMIC_ACQUIRE);
  delete &ours(sample);
}

std::size_t print(const ddsi_sertype*, const ddsi_serdata* sample, char* text, std::size_t capacity) {
  return static_cast<std::size_t>(std::snprintf(text, capacity, "%zu bytes", bytes_of(sample).size()));
}

constexpr ddsi_serdata_ops sample_ops() {
  ddsi_serdata_ops ops{};
  ops.eqkey = equal_key;
  ops.get_size = size;
  ops.from_ser = from_packets;
  ops.from_ser_iov = from_pieces;
  ops.from_keyhash = from_keyhash;
  ops.from_sample = from_sample;
  ops.to_ser = to_bytes;
  ops.to_ser_ref = lend_bytes;
  ops.to_ser_unref = return_bytes;
  ops.to_sample = to_sample;
  ops.to_untyped = to_untyped;
  ops.untyped_to_sample = untyped_to_sample;
  ops.free = free_sample;
  ops.print = print;
  ops.get_keyhash = keyhash;
  return ops;
}

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

// Samples as structures are never asked for: we take and give serialised ones.
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
  return ops;
}

}  // namespace

ddsi_sertype* create_sertype(const SampleType& description) {
  static constexpr ddsi_serdata_ops kSampleOps = sample_ops();
  static const ddsi_sertype_ops kOps = type_ops();
  auto type = std::make_unique<Sertype>();
  type->description = description;
  const std::uint32_t flags = description.keyed ? 0 : DDSI_SERTYPE_FLAG_TOPICKIND_NO_KEY;
  ddsi_sertype_init_flags(type.get(), description.name.c_str(), &kOps, &kSampleOps, flags);
  type->allowed_data_representation = DDS_DATA_REPRESENTATION_FLAG_XCDR1;
  if (description.any_representation) type->allowed_data_representation |= DDS_DATA_REPRESENTATION_FLAG_XCDR2;
  return type.release();
}

void destroy_sertype(ddsi_sertype* type) {
  ddsi_sertype_unref(type);
}

std::optional<TakenSample> take_sample(dds_entity_t reader) {
  ddsi_serdata* taken = nullptr;
  dds_sample_info_t info;
  if (dds_takecdr(reader, &taken, 1, &info, DDS_ANY_STATE) < 1) return std::nullopt;
  Serdata& sample = *static_cast<Serdata*>(taken);
  TakenSample result;
  if (info.valid_data) result.bytes = sample.bytes;
  result.origin = sample.origin;
  result.received_ns = sample.received_ns != 0 ? sample.received_ns : dds_time();
  result.source_ns = info.source_timestamp > 0 ? info.source_timestamp : result.received_ns;
  ddsi_serdata_unref(taken);
  return result;
}

bool write_sample(dds_entity_t writer, const ddsi_sertype* type, std::shared_ptr<ByteBlock> bytes,
                  const SampleOrigin& origin, std::int64_t source_ns) {
  Serdata* const sample = create_serdata(type, SDK_DATA, std::move(bytes));
  sample->origin = origin;
  sample->timestamp.v = source_ns != 0 ? source_ns : dds_time();
  return dds_forwardcdr(writer, sample) == DDS_RETCODE_OK;
}

std::shared_ptr<ByteBlock> acquire_block(const ddsi_sertype* type, std::size_t size) {
  std::shared_ptr<ByteBlock> block = static_cast<const Sertype*>(type)->pool.acquire();
  block->resize(size);
  return block;
}

namespace {

constexpr std::size_t kHeader = sizeof(kCdrHeader);

ros::Bytes bytes_of(const ByteBlock& block) {
  const auto sample = block.view();
  return {reinterpret_cast<const std::uint8_t*>(sample.data()), sample.size()};
}

/// The sample itself is the message: no copy.
template <class T>
std::shared_ptr<const void> decode_plain(const std::shared_ptr<const ByteBlock>& bytes) {
  static_assert(alignof(T) <= 16, "ByteBlock aligns to 16");
  const ros::Bytes sample = bytes_of(*bytes);
  if (!is_plain_cdr<T>(sample)) return nullptr;
  return {bytes, sample.data() + kHeader};
}

template <class T>
std::shared_ptr<const void> decode_fields(const ByteBlock& bytes) {
  auto message = std::make_shared<T>();
  return read_cdr(bytes_of(bytes), *message) ? message : nullptr;
}

}  // namespace

SampleType sample_type(MessageId id) {
  const std::uint32_t plain_bytes =
      visit_message_type(id, []<class T>() -> std::uint32_t { return MessageTraits<T>::kPlain ? sizeof(T) : 0; });
  const std::size_t largest = visit_message_type(id, []<class T>() { return msg::largest_sample<T>(); });
  return {dds_type_name(id), false, plain_bytes, false, largest};
}

std::shared_ptr<ByteBlock> plain_block(MessageId id, const ddsi_sertype* type) {
  const std::uint32_t size = sample_type(id).plain_bytes;
  if (size == 0) throw BusError(dds_type_name(id) + " is of variable size and cannot be loaned");
  auto block = acquire_block(type, kHeader + size);
  std::memcpy(block->bytes().data(), kCdrHeader, kHeader);
  return block;
}

std::shared_ptr<ByteBlock> encode(MessageId id, const ddsi_sertype* type, const void* message) {
  return visit_message_type(id, [&]<class T>() {
    const T& typed = *static_cast<const T*>(message);
    auto block = acquire_block(type, cdr_size(typed));
    const auto bytes = block->bytes();
    write_cdr(typed, {reinterpret_cast<std::uint8_t*>(bytes.data()), bytes.size()});
    return block;
  });
}

std::shared_ptr<const void> decode(MessageId id, const std::shared_ptr<const ByteBlock>& bytes) {
  return visit_message_type(id, [&]<class T>() -> std::shared_ptr<const void> {
    if constexpr (MessageTraits<T>::kPlain) {
      return decode_plain<T>(bytes);
    } else {
      return decode_fields<T>(*bytes);
    }
  });
}

}  // namespace rtd::bus::cyclonedds
