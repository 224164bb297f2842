// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/fastdds/raw_discovery.hpp"

#include <algorithm>
#include <fastdds/dds/domain/DomainParticipant.hpp>

#include "common/bus/fastdds/raw_codec.hpp"
#include "common/bus/fastdds/raw_qos.hpp"

namespace rtd::bus::fastdds {

using eprosima::fastrtps::rtps::WriterDiscoveryInfo;

void RawDiscovery::on_publisher_discovery(eprosima::fastdds::dds::DomainParticipant* participant,
                                          WriterDiscoveryInfo&& info) {
  TopicWriter writer = to_topic_writer(info.info);
  if (info.status == WriterDiscoveryInfo::REMOVED_WRITER) return registry_.note_gone(writer.id);
  const WriterId own = to_writer_id(participant->guid());
  constexpr auto kPrefix = eprosima::fastrtps::rtps::GuidPrefix_t::size;
  writer.own = std::equal(own.begin(), own.begin() + kPrefix, writer.id.begin());
  registry_.note(writer);
}

}  // namespace rtd::bus::fastdds
