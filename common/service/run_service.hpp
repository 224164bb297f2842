// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include "common/service/config.hpp"
#include "common/service/exit_code.hpp"
#include "common/service/runtime.hpp"

namespace CLI {
class App;
}

namespace rtd::service {

/// The parts of a service that run_service() needs, without its type.
struct ServiceDefinition {
  std::string name;         ///< "filter": executable rtd-filter, config section `filter`
  std::string description;  ///< one line for --help
  std::function<void(CLI::App&)> add_options;
  std::function<void(ConfigBinder&)> bind;
  std::function<ExitCode(Runtime&)> run;  ///< returns when stop is requested or the work is done
};

/// Parses the command line, loads the configuration, joins the bus, installs the signal handlers, runs the service.
/// Exceptions become one line on stderr and an exit code: ConfigError and BusError 2, others 1.
int run_service(const ServiceDefinition& definition, int argc, char** argv);

/// Service needs: static constexpr kName, kDescription; struct Config { void bind(auto& binder); };
/// static void add_options(CLI::App&, Config&); Service(const Config&, Runtime&); ExitCode run().
template <class Service>
int run_service(int argc, char** argv) {
  typename Service::Config config;
  return run_service({Service::kName, Service::kDescription, [&](CLI::App& app) { Service::add_options(app, config); },
                      [&](ConfigBinder& binder) { binder.section(Service::kName, config); },
                      [&](Runtime& runtime) { return Service(config, runtime).run(); }},
                     argc, argv);
}

}  // namespace rtd::service
