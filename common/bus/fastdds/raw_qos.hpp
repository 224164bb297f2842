// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fastdds/rtps/builtin/data/WriterProxyData.h>

#include <fastdds/dds/publisher/qos/DataWriterQos.hpp>
#include <fastdds/dds/subscriber/qos/DataReaderQos.hpp>

#include "common/bus/raw_bus.hpp"

namespace rtd::bus::fastdds {

/// Asks for nothing that would keep a writer from matching: no deadline, no liveliness, any data representation.
eprosima::fastdds::dds::DataReaderQos raw_reader_qos(const RawReaderOptions& options);
eprosima::fastdds::dds::DataWriterQos raw_writer_qos(const RawWriterOptions& options);

/// What discovery tells of a writer; `own` is not set.
TopicWriter to_topic_writer(const eprosima::fastrtps::rtps::WriterProxyData& data);

}  // namespace rtd::bus::fastdds
