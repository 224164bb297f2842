// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <dds/dds.h>

#include <memory>
#include <optional>

#include "common/bus/cyclonedds/sample_type.hpp"

/// Serialised samples in and out of Cyclone.
namespace rtd::bus::cyclonedds {

struct TakenSample {
  std::shared_ptr<const ByteBlock> bytes;  ///< header and fields; empty: a dispose or the like
  SampleOrigin origin;
  std::int64_t source_ns = 0, received_ns = 0;
};

/// The next sample that waits in a reader; nothing when none does.
std::optional<TakenSample> take_sample(dds_entity_t reader);

/// Hands bytes over, which must not change afterwards. `source_ns` 0: now.
bool write_sample(dds_entity_t writer, const ddsi_sertype* type, std::shared_ptr<ByteBlock> bytes,
                  const SampleOrigin& origin, std::int64_t source_ns);

/// Memory for a sample of so many bytes, header included.
std::shared_ptr<ByteBlock> acquire_block(const ddsi_sertype* type, std::size_t size);

}  // namespace rtd::bus::cyclonedds
