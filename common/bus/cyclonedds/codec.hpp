// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "common/bus/cyclonedds/samples.hpp"
#include "common/bus/message_types.hpp"

namespace rtd::bus::cyclonedds {

SampleType sample_type(MessageId id);

/// The message as a sample in memory of the type's pool.
std::shared_ptr<ByteBlock> encode(MessageId id, const ddsi_sertype* type, const void* message);

/// The message that a sample holds, a plain struct of common/msg; null when the bytes do not make one.
std::shared_ptr<const void> decode(MessageId id, const std::shared_ptr<const ByteBlock>& bytes);

/// A sample of a plain type with its header written and its fields to be filled in.
std::shared_ptr<ByteBlock> plain_block(MessageId id, const ddsi_sertype* type);

}  // namespace rtd::bus::cyclonedds
