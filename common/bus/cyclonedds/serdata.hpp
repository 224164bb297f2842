// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// Cyclone's internal headers: only for the two files that give it our samples. Never together with Fast DDS's headers.
extern "C" {
#include <dds/ddsi/ddsi_serdata.h>
#include <dds/ddsi/ddsi_sertype.h>
}

#include <memory>

#include "common/bus/cyclonedds/sample_type.hpp"
#include "common/bus/message_pool.hpp"

namespace rtd::bus::cyclonedds {

/// Cyclone's view of a SampleType.
struct Sertype : ddsi_sertype {
  SampleType description;
  MessagePool<ByteBlock> pool;
};

/// Cyclone's view of one sample. Counted by Cyclone, freed by serdata_ops().
struct Serdata : ddsi_serdata {
  std::shared_ptr<ByteBlock> bytes;  ///< empty: no data (a dispose or the like), or still in `iox_chunk`
  SampleOrigin origin;
  std::int64_t received_ns = 0;
};

const ddsi_serdata_ops& serdata_ops();

/// `kind` tells data from a dispose.
Serdata* create_serdata(const ddsi_sertype* type, ddsi_serdata_kind kind, std::shared_ptr<ByteBlock> bytes);

/// What lies in iceoryx's memory, copied into ours; that memory is given back.
void leave_shared_memory(Serdata& sample);

}  // namespace rtd::bus::cyclonedds
