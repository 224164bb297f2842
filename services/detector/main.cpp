// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/command_line.hpp"
#include "common/service/run_service.hpp"
#include "services/detector/detector_service.hpp"
#include "services/detector/fleet_service.hpp"
#include "services/detector/image_table.hpp"

namespace {

/// One robot or several, as configured.
int run_detector(int argc, char** argv) {
  using namespace rtd::detector;
  using rtd::service::run_to_end;
  ServiceConfig config;
  const auto run = [&config](rtd::service::Runtime& runtime) {
    if (config.robots.empty()) return run_to_end(DetectorService(config, runtime), runtime);
    const FleetConfig fleet = fleet_config(config, runtime);
    return run_to_end(FleetService(fleet, runtime, load_inference(config)), runtime);
  };
  return rtd::service::run_service(
      {DetectorService::kName, DetectorService::kDescription,
       [&config](rtd::service::ConfigBinder& binder) { binder.section(DetectorService::kName, config); }, run,
       DetectorService::add_options,
       [&config] { return config.robots.empty() ? std::string() : FleetService::kHeartbeatName; },
       DetectorService::kShmSegmentMib},
      argc, argv);
}

}  // namespace

int main(int argc, char** argv) {
  if (rtd::detector::asks_for_image_table(argc, argv)) return rtd::detector::print_image_table(argc, argv);
  return run_detector(argc, argv);
}
