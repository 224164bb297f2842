// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Fast DDS 2 or 3, whichever is installed, under the same names. All that differs between them is in this folder.
///   rtps, transports        namespaces
///   succeeded()             of a return code, or of what version 2 returns in its place
///   TypeSupportBase         type support
///   DiscoveryAdapter        listener of a participant that calls DiscoveryEvents
///   PublicationData         what discovery finds of a writer, with the names of version 3
///   PassingTransport        transport in front of another
///   largest_sample()        of a type
///   set_timing(), set_representations(), add_discovery_server(), turn_off_direct_calls(), kShmPrefix, kVersion
#if __has_include(<fastrtps/fastrtps_dll.h>)
#include "common/bus/fastdds/versions/vendor_2.hpp"
#else
#include "common/bus/fastdds/versions/vendor_3.hpp"
#endif
