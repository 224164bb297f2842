// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tests/bench/rtd_bench/transport/transport_case.hpp"

namespace rtd::bench {

/// Every case with a publishing and a subscribing process of its own; `on_case` receives the next one.
std::vector<TransportResult> bench_transport(const TransportOptions& options,
                                             const std::function<void(const TransportCase&)>& on_case);

/// What the worker processes run: `role` is "publish" or "subscribe"; the result goes to stdout as JSON. Exit code.
int run_transport_worker(const std::string& role, const TransportCase& what, const TransportOptions& options);

/// A table for people, and the same as JSON text.
std::string transport_table(const std::vector<TransportResult>& results, const TransportOptions& options);
std::string transport_json(const std::vector<TransportResult>& results, const TransportOptions& options);

}  // namespace rtd::bench
