// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "common/bus/calls.hpp"
#include "common/bus/fastdds/participant.hpp"

namespace rtd::bus::fastdds {

/// One end of a service as rmw_fastrtps has it: the identities travel beside the samples, in their inline QoS. A
/// request is known by its number and by the GUID of the reader that waits for the reply, which the client announces as
/// related identity; older clients (ROS 2 Foxy) announce none and mean their writer.
std::unique_ptr<CallEndpoint> create_calls(std::shared_ptr<Participant> participant, const CallTopics& topics,
                                           CallRole role, OnCall on_call);

}  // namespace rtd::bus::fastdds
