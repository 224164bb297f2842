// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fastdds/rtps/common/Guid.h>

#include "common/bus/fastdds/codec.hpp"
#include "common/bus/raw_bus.hpp"

namespace rtd::bus::fastdds {

/// What a raw writer's codec takes as its message.
struct RawOutput {
  std::span<const std::byte> cdr;
  std::int64_t source_ns = 0;  ///< 0: now
};

/// A codec without a type: write() takes a RawOutput, take() gives a RawSample.
std::unique_ptr<Codec> create_raw_codec(const RawTopic& topic, const RawReaderOptions& options);
std::unique_ptr<Codec> create_raw_codec(const RawTopic& topic, const RawWriterOptions& options);

WriterId to_writer_id(const eprosima::fastrtps::rtps::GUID_t& guid);

}  // namespace rtd::bus::fastdds
