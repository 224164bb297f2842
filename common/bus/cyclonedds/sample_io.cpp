// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/cyclonedds/sample_io.hpp"

#include "common/bus/cyclonedds/serdata.hpp"

namespace rtd::bus::cyclonedds {

std::optional<TakenSample> take_sample(dds_entity_t reader) {
  ddsi_serdata* taken = nullptr;
  dds_sample_info_t info;
  if (dds_takecdr(reader, &taken, 1, &info, DDS_ANY_STATE) < 1) return std::nullopt;
  Serdata& sample = *static_cast<Serdata*>(taken);
  TakenSample result;
  if (info.valid_data) {
    leave_shared_memory(sample);
    result.bytes = sample.bytes;
  }
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

}  // namespace rtd::bus::cyclonedds
