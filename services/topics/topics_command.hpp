// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>
#include <vector>

#include "common/service/bus_config.hpp"

namespace rtd::topics {

/// The command line of `rtd topics`.
struct TopicsRequest {
  std::string action;  ///< list, hz, echo
  service::ConfigSources bus;
  std::vector<std::string> topics;  ///< ROS or DDS names. hz: empty = all; mirror: empty = ours; echo: one, or a
                                    ///< recording and its topics
  double wait_s = 6;                ///< list: longest search
  double duration_s = -1;           ///< hz: 5; echo: 0 = until Ctrl-C or the end of the recording
  std::uint64_t count = 0;          ///< messages (of each topic), 0 = any number
  bool verbose = false;              ///< echo: every field as it is on the wire
  std::uint64_t max_array = 36;     ///< echo: values shown of an array, 0 = all
  bool once = false, json = false;
};

/// Adds `list`, `hz` and `echo`; parsing fills `request`, which must outlive `app`.
void add_topics_commands(CLI::App& app, TopicsRequest& request);

/// Results go to `out`, errors to `err`. Exit code 0; 1: no topic or message was found; 2: not possible (bus, unknown
/// type); 3: some messages could not be read.
int run_topics(const TopicsRequest& request, std::ostream& out, std::ostream& err);

}  // namespace rtd::topics
