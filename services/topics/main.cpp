// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <iostream>
#include <string_view>

#include "common/service/command_line.hpp"
#include "services/topics/call_command.hpp"
#include "services/topics/topics_command.hpp"

namespace {

int topics_main(int argc, char** argv) {
  rtd::topics::TopicsRequest request;
  CLI::App app{"List the topics of a DDS domain, measure their rates, print their messages", "rtd topics"};
  rtd::topics::add_topics_commands(app, request);
  return rtd::service::run_command(app, argc, argv,
                                   [&] { return rtd::topics::run_topics(request, std::cout, std::cerr); });
}

int call_main(int argc, char** argv) {
  rtd::topics::CallRequest request;
  CLI::App app{"Call a command of a running service, as 'ros2 service call' does", "rtd call"};
  rtd::topics::add_call_options(app, request);
  return rtd::service::run_command(app, argc, argv,
                                   [&] { return rtd::topics::run_call(request, std::cout, std::cerr); });
}

}  // namespace

int main(int argc, char** argv) {
  const bool is_call = argc > 1 && std::string_view(argv[1]) == "call";
  return is_call ? call_main(argc - 1, argv + 1) : topics_main(argc, argv);
}
