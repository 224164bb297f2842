// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

#include "tests/bench/rtd_bench/transport/transport_case.hpp"

namespace rtd::bench {

/// The options of `rtd bench transport` and of its worker processes.
struct TransportRequest {
  TransportOptions options;
  std::vector<std::string> payloads;  ///< by name
  bool json = false;
  std::string worker_role, worker_vendor, worker_path, worker_payload;
};

void add_transport_commands(CLI::App& app, TransportRequest& request);
/// Runs the command that was parsed, if any of the two; its exit code.
std::optional<int> run_transport(const CLI::App& app, TransportRequest& request);

}  // namespace rtd::bench
