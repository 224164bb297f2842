// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/atlas/status_command.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <cmath>
#include <future>
#include <iostream>

#include "common/bus/bus_factory.hpp"
#include "common/bus/port_check.hpp"
#include "common/io/printable.hpp"
#include "common/service/bus_config.hpp"
#include "common/service/command_line.hpp"
#include "common/service/config.hpp"

namespace rtd::atlas {
namespace {

constexpr std::chrono::seconds kPatience{3};

int print_status(const service::ConfigSources& sources, std::ostream& out, std::ostream& err) {
  return service::report_errors<service::ConfigError, bus::BusError>("rtd atlas status", err, [&] {
    const bus::BusOptions options = service::load_bus_options(sources, "rtd-observer");  // its enclave may read this
    const auto bus = bus::connect(options);
    std::promise<std::shared_ptr<const msg::AtlasState>> first;
    std::atomic<bool> answered = false;
    const auto reader = bus->reader(bus::topics::kAtlas, [&](std::shared_ptr<const msg::AtlasState> state) {
      if (!answered.exchange(true)) first.set_value(std::move(state));
    });
    auto state = first.get_future();
    if (state.wait_for(kPatience) == std::future_status::ready) {
      out << to_table(*state.get());
      return service::kOk;
    }
    err << fmt::format("rtd atlas status: no atlas in domain {}{}\n", options.domain,
                       bus::other_domains_hint(options.domain));
    return service::kRunFailed;
  });
}

}  // namespace

std::string to_table(const msg::AtlasState& state) {
  if (state.robots.empty()) return "no robots yet: their services need names (--robot NAME) and this DDS domain\n";
  std::string text =
      fmt::format("{:<16} {:>9} {:>8} {:>9}  {}\n", "robot", "keyframes", "missing", "meetings", "in the joint map");
  for (const msg::AtlasRobot& robot : state.robots) {
    const auto& [x, y, z] = robot.T_map_camera.translation_m;
    const std::string name = robot.name.empty() ? "(without name)" : io::printable(robot.name);
    const std::string place = robot.met ? fmt::format("x {:.2f} y {:.2f} z {:.2f} m, +-{:.1f} cm", x, y, z,
                                                      100 * std::sqrt(robot.covariance[0]))
                                        : std::string("has not met it yet");
    text += fmt::format("{:<16} {:>9} {:>8} {:>9}  {}\n", name, robot.keyframes, robot.missing, robot.meetings, place);
  }
  return text;
}

int run_status(int argc, char** argv) {
  service::ConfigSources sources;
  CLI::App app{"Show which robots are in the joint map, and where", "rtd atlas status"};
  service::add_bus_options(app, sources);
  app.footer("Exit code: 0; 1 there is no atlas in the domain; 2 wrong arguments");
  return service::run_command(app, argc, argv, [&] { return print_status(sources, std::cout, std::cerr); });
}

}  // namespace rtd::atlas
