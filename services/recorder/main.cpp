// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/run_service.hpp"
#include "services/recorder/join_command.hpp"
#include "services/recorder/recorder_service.hpp"
#include "services/recorder/recover_command.hpp"

int main(int argc, char** argv) {
  if (rtd::recorder::wants_recover(argc, argv)) return rtd::recorder::run_recover(argc, argv);
  if (rtd::recorder::wants_join(argc, argv)) return rtd::recorder::run_join(argc, argv);
  return rtd::service::run_service<rtd::recorder::RecorderService>(argc, argv);
}
