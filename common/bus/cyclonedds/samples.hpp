// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "common/bus/message_types.hpp"
#include "common/bus/raw_bus.hpp"

struct ddsi_sertype;
/// Serialised samples in and out of Cyclone, which never looks into them.
namespace rtd::bus::cyclonedds {

/// A type as Cyclone gets to know it: a name and bytes.
struct SampleType {
  std::string name;  ///< "nav_msgs::msg::dds_::Odometry_"
  bool keyed = false;
  std::uint32_t plain_bytes = 0;    ///< > 0: every sample has so many behind its header, as in memory
  bool any_representation = false;  ///< also XCDR2
  std::size_t largest_bytes = 0;    ///< of a sample, header included: larger ones are dropped
  bool operator==(const SampleType&) const = default;
};

/// Which of whose samples one is: writers count theirs from 1.
struct SampleOrigin {
  WriterId writer{};
  std::int64_t sequence = 0;
};

/// For dds_create_topic_sertype(), which takes it over.
ddsi_sertype* create_sertype(const SampleType& type);
/// For one without an owner.
void destroy_sertype(ddsi_sertype* type);

struct TakenSample {
  std::shared_ptr<const ByteBlock> bytes;  ///< header and fields; empty: a dispose or the like
  SampleOrigin origin;
  std::int64_t source_ns = 0, received_ns = 0;
};

/// The next sample that waits in a reader (a dds_entity_t); nothing when none does.
std::optional<TakenSample> take_sample(std::int32_t reader);

/// Hands bytes over, which must not change afterwards. `source_ns` 0: now.
bool write_sample(std::int32_t writer, const ddsi_sertype* type, std::shared_ptr<ByteBlock> bytes,
                  const SampleOrigin& origin, std::int64_t source_ns);

/// Memory for a sample of so many bytes, header included.
std::shared_ptr<ByteBlock> acquire_block(const ddsi_sertype* type, std::size_t size);

SampleType sample_type(MessageId id);

/// The message as a sample in memory of the type's pool.
std::shared_ptr<ByteBlock> encode(MessageId id, const ddsi_sertype* type, const void* message);

/// The message that a sample holds, a plain struct of common/msg; null when the bytes do not make one.
std::shared_ptr<const void> decode(MessageId id, const std::shared_ptr<const ByteBlock>& bytes);

/// A sample of a plain type with its header written and its fields to be filled in.
std::shared_ptr<ByteBlock> plain_block(MessageId id, const ddsi_sertype* type);

}  // namespace rtd::bus::cyclonedds
