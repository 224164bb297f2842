// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/bench/rtd_bench/transport/transport_case.hpp"

namespace rtd::bench {

/// The publishing process: waits for the subscriber, measures, ends. Throws BusError, std::runtime_error.
PublisherResult publish(const TransportCase& what, const TransportOptions& options);

/// The subscribing process: until SIGTERM, which must be blocked in all threads.
SubscriberResult subscribe(const TransportCase& what, const TransportOptions& options);

}  // namespace rtd::bench
