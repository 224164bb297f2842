// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <ctime>
#include <iostream>

#include "common/service/command_line.hpp"
#include "services/keystore/keystore_command.hpp"

int main(int argc, char** argv) {
  rtd::keystore::KeystoreRequest request;
  CLI::App app{"Keys and permissions for --secure (docs/security.md), in the layout of sros2", "rtd keystore"};
  rtd::keystore::add_keystore_commands(app, request);
  return rtd::service::run_command(
      app, argc, argv, [&] { return rtd::keystore::run_keystore(request, std::time(nullptr), std::cout, std::cerr); });
}
