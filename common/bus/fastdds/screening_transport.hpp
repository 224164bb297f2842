// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fastdds/rtps/transport/ChainingTransportDescriptor.h>

#include <functional>
#include <memory>
#include <string>

namespace rtd::bus::fastdds {

/// A transport that passes on only what is_rtps_message(): Fast DDS 2.9 as Debian builds it ends the process (an
/// assertion) on some datagrams that are not. Tells `on_problem` of the first one.
std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> screened(
    std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> transport,
    std::function<void(const std::string&)> on_problem);

}  // namespace rtd::bus::fastdds
