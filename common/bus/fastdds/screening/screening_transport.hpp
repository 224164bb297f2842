// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fastdds/rtps/transport/ChainingTransportDescriptor.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

namespace rtd::bus::fastdds {

/// A transport that passes on only what an RtpsScreen passes: Fast DDS 2.9 as Debian builds it ends the process (an
/// assertion) on some datagrams that are no RTPS messages, reads fragments that are not there, and stands still while
/// it counts to a sequence number that is far away. Tells `on_problem` of the first one.
///
/// One datagram at a time, though each socket has a thread of its own: in a secured domain Fast DDS 2.9 connects the
/// handshake of two participants that it discovers at once, by multicast and unicast, through one unguarded scratch
/// object. One of them was then never answered, one start in thirty of eight participants on a busy host.
///
/// Sends datagrams of at most `largest_sent` bytes and receives what `transport` has room for: others, and Cyclone DDS
/// now and then, send larger ones than we do, whose end Fast DDS would cut off.
std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> screened(
    std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> transport, std::uint32_t largest_sent,
    std::function<void(const std::string&)> on_problem);

}  // namespace rtd::bus::fastdds
