// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "common/bus/bus_factory.hpp"
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
  std::function<void(ConfigBinder&)> bind;
  std::function<ExitCode(Runtime&)> run;  ///< returns when stop is requested or the work is done
  /// What the command line has besides the options of the settings. Keys that it sets go to the list.
  std::function<void(CLI::App&, std::vector<GivenOption>&)> add_options = {};
  /// Called once the configuration is loaded. The name of its heartbeat where several processes of it may run in one
  /// domain; "": the usual one, `name`, which belongs to one process.
  std::function<std::string()> shared_name = {};
  /// Of bus.shm_segment_mib: all of it is memory from the start on.
  std::uint32_t shm_segment_mib = bus::BusOptions().shm_segment_mib;
};

/// Parses the command line, loads the configuration, joins the bus, installs the signal handlers, runs the service.
/// Exceptions become one line on stderr and an exit code: ConfigError and BusError 2, others 1.
int run_service(const ServiceDefinition& definition, int argc, char** argv);

/// Runs `service`, a temporary: its own connections are destroyed in bounded time, as that of the runtime is.
template <class Service>
ExitCode run_to_end(Service&& service, const Runtime& runtime) {
  const ExitCode code = service.run();
  runtime.bound_end(code);
  return code;
}

/// Service needs: static constexpr kName, kDescription; struct Config { void bind(auto& binder); };
/// Service(const Config&, Runtime&); ExitCode run(). It may have: static ServiceDefinition::add_options and
/// shm_segment_mib (kShmSegmentMib).
template <class Service>
int run_service(int argc, char** argv) {
  typename Service::Config config;
  ServiceDefinition definition{Service::kName, Service::kDescription,
                               [&](ConfigBinder& binder) { binder.section(Service::kName, config); },
                               [&](Runtime& runtime) { return run_to_end(Service(config, runtime), runtime); }};
  if constexpr (requires { &Service::add_options; }) definition.add_options = Service::add_options;
  if constexpr (requires { Service::kShmSegmentMib; }) definition.shm_segment_mib = Service::kShmSegmentMib;
  return run_service(definition, argc, argv);
}

/// Warns once when no other service was seen for a while: in which domain this one is, and in which domains DDS runs on
/// this host. It is not an error, the others may start later.
class NoPeersWarning {
 public:
  static constexpr std::chrono::milliseconds kUsualPatience{10'000};

  /// `warn` is called by its own thread.
  NoPeersWarning(const Heartbeat& heartbeat, const bus::BusOptions& options,
                 std::function<void(const std::string&)> warn, std::chrono::milliseconds patience = kUsualPatience);
  ~NoPeersWarning();
  NoPeersWarning(const NoPeersWarning&) = delete;
  NoPeersWarning& operator=(const NoPeersWarning&) = delete;

 private:
  StopToken ended_;
  std::thread thread_;
};

/// Ends the process when what was declared after this takes too long to be destroyed: a bus that other programs have
/// blocked or filled must not keep a program from ending whose work is done.
class BoundedEnd {
 public:
  /// A program that ends by itself may take its time. One that was asked to has less: it goes before whoever asked
  /// (`rtd run` after Ctrl-C) loses patience and kills it.
  static constexpr std::chrono::milliseconds kByItself{3'000}, kWhenAsked{400};

  explicit BoundedEnd(std::string program) : program_(std::move(program)) {}
  ~BoundedEnd();
  BoundedEnd(const BoundedEnd&) = delete;
  BoundedEnd& operator=(const BoundedEnd&) = delete;

  /// The work is done, all results are written: reports that, and from now on the time counts.
  void begin(int exit_code, std::chrono::milliseconds limit);

 private:
  void watch(int exit_code, std::chrono::milliseconds limit);

  const std::string program_;
  StopToken ended_;
  std::thread thread_;
};

/// Reports to systemd (Type=notify) that the worker runs and, as often as WatchdogSec= needs it, that it is not stuck:
/// systemd kills a service that falls silent, and starts it again. Does nothing in a process that systemd did not
/// start.
class SystemdLink {
 public:
  /// `work` is asked on a thread of the link.
  explicit SystemdLink(std::function<Heartbeat::Work()> work);
  /// Says that the service ends.
  ~SystemdLink();
  SystemdLink(const SystemdLink&) = delete;
  SystemdLink& operator=(const SystemdLink&) = delete;

 private:
  void watch(const std::stop_token& ended);

  const std::function<Heartbeat::Work()> work_;
  std::jthread thread_;
};

}  // namespace rtd::service
