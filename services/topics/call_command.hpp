// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>
#include <string>

#include "common/service/bus_config.hpp"

namespace CLI {
class App;
}

namespace rtd::topics {

/// The command line of `rtd call`.
struct CallRequest {
  service::ConfigSources bus;
  std::string service, argument;
  double timeout_s = 10;
  bool list = false, json = false;
};

/// Parsing fills `request`, which must outlive `app`.
void add_call_options(CLI::App& app, CallRequest& request);

/// The answer, or the list, goes to `out`, errors to `err`. Exit code 0; 1: the service answered that it failed, did
/// not answer, or there is none; 2: not possible (arguments, bus).
int run_call(const CallRequest& request, std::ostream& out, std::ostream& err);

}  // namespace rtd::topics
