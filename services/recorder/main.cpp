// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/run_service.hpp"
#include "services/recorder/file_commands.hpp"
#include "services/recorder/recorder_service.hpp"

int main(int argc, char** argv) {
  if (const auto code = rtd::recorder::run_file_command(argc, argv)) return *code;
  return rtd::service::run_service<rtd::recorder::RecorderService>(argc, argv);
}
