// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <iostream>

#include "common/service/command_line.hpp"
#include "services/topics/topics_command.hpp"

int main(int argc, char** argv) {
  rtd::topics::TopicsRequest request;
  CLI::App app{"List the topics of a DDS domain, measure their rates, print their messages", "rtd topics"};
  rtd::topics::add_topics_commands(app, request);
  return rtd::service::run_command(app, argc, argv,
                                   [&] { return rtd::topics::run_topics(request, std::cout, std::cerr); });
}
