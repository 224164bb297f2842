// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/command_line.hpp"
#include "common/service/run_service.hpp"
#include "services/detector/core/engine.hpp"
#include "services/detector/detector_service.hpp"
#include "services/detector/image_table.hpp"

int main(int argc, char** argv) {
  rtd::service::restart_with(rtd::detector::kAllowAllDevices, "1", argv);
  if (rtd::detector::asks_for_image_table(argc, argv)) return rtd::detector::print_image_table(argc, argv);
  return rtd::service::run_service<rtd::detector::DetectorService>(argc, argv);
}
