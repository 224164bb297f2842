// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/run_service.hpp"

#include <pthread.h>
#include <systemd/sd-daemon.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <condition_variable>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <mutex>
#include <optional>
#include <utility>

#include "common/bus/host/host_checks.hpp"
#include "common/bus/host/shm_leftovers.hpp"
#include "common/bus/port_check.hpp"
#include "common/service/bus_config.hpp"
#include "common/service/command_line.hpp"
#include "common/service/log.hpp"
#include "common/service/metric_names.hpp"
#include "common/service/model_locator.hpp"
#include "common/service/monotonic_clock.hpp"
#include "common/service/parameter_server.hpp"
#include "common/service/patience.hpp"
#include "common/service/service_lock.hpp"
#include "common/service/standard_streams.hpp"

namespace rtd::service {
namespace {

struct CommonOptions {
  ConfigSources config;
  std::string pace = "realtime", log_level = "info";
  bool print_config = false;
};

void add_common_options(CLI::App& app, CommonOptions& common) {
  add_source_options(app, common.config);
  app.add_option("--pace", common.pace, "realtime, asap or lockstep")->capture_default_str();
  app.add_option("--log-level", common.log_level, "trace, debug, info, warning, error")
      ->check(CLI::IsMember({"trace", "debug", "info", "warning", "error"}))
      ->capture_default_str();
  app.add_flag("--print-config", common.print_config, "Print all keys with the values in force and end");
}

/// Turns SIGINT and SIGTERM into a stop request. All other threads inherit the blocked mask.
class SignalWatcher {
 public:
  explicit SignalWatcher(StopToken& stop) {
    sigemptyset(&signals_);
    for (const int number : {SIGINT, SIGTERM, SIGUSR2}) sigaddset(&signals_, number);
    pthread_sigmask(SIG_BLOCK, &signals_, nullptr);
    thread_ = std::thread([this, &stop] {
      int number = 0;
      sigwait(&signals_, &number);
      if (number != SIGUSR2) stop.request_stop();
    });
  }
  ~SignalWatcher() {
    pthread_kill(thread_.native_handle(), SIGUSR2);
    thread_.join();
  }
  SignalWatcher(const SignalWatcher&) = delete;
  SignalWatcher& operator=(const SignalWatcher&) = delete;

 private:
  sigset_t signals_{};
  std::thread thread_;
};

/// Killed processes leave shared memory behind.
void remove_leftovers() {
  const bus::CleanReport report = bus::remove_shm_leftovers();
  if (report.removed.empty()) return;
  SPDLOG_INFO("event=leftovers_removed folder=/dev/shm files={} mib={:.1f}", report.removed.size(),
              static_cast<double>(report.removed_bytes()) / (1024 * 1024));
}

/// Leftovers may be all that is in the way.
std::shared_ptr<bus::Bus> join_bus(const bus::BusOptions& options) {
  try {
    return bus::connect(options);
  } catch (const bus::BusError&) {
    if (options.vendor == bus::kInprocess || bus::remove_shm_leftovers().removed.empty()) throw;
    return bus::connect(options);
  }
}

/// What keeps other participants from being matched: in the log, and counted in the heartbeat while there is one.
class BusProblems {
 public:
  void add(const std::string& problem) {
    constexpr int kLogged = 50;  // other participants must not fill the disk
    const std::lock_guard lock(mutex_);
    if (++count_ <= kLogged) SPDLOG_WARN("event=bus_problem cause=\"{}\"", problem);
    if (heartbeat_ != nullptr) heartbeat_->set_metric(metric::kBusProblems, count_);
  }
  void count_in(Heartbeat* heartbeat) {
    const std::lock_guard lock(mutex_);
    heartbeat_ = heartbeat;
    if (heartbeat_ != nullptr && count_ > 0) heartbeat_->set_metric(metric::kBusProblems, count_);
  }

 private:
  std::mutex mutex_;
  Heartbeat* heartbeat_ = nullptr;
  int count_ = 0;
};

/// A service works without them.
void offer_parameters(std::optional<ParameterServer>& server, bus::Bus& bus, const std::string& service,
                      Heartbeat& heartbeat) {
  try {
    server.emplace(bus, service, heartbeat);
  } catch (const bus::BusError& error) {
    SPDLOG_WARN("event=no_parameters cause=\"{}\"", error.what());
  }
}

/// rtd run warns once for all its services.
void log_setting(const bus::EnvironmentSetting& setting) {
  SPDLOG_INFO("event=environment_{}followed setting=\"{}\"", setting.followed ? "" : "not_", setting.text);
}

ExitCode run_on_bus(const ServiceDefinition& definition, const BusConfig& bus_config, Pace pace) {
  StopToken stop;
  const SignalWatcher signals(stop);
  bus::BusOptions options = to_bus_options(bus_config, "rtd-" + definition.name);
  const std::string shared = definition.shared_name ? definition.shared_name() : std::string();
  std::optional<ServiceLock> only_one;
  if (shared.empty())
    only_one.emplace(ServicePlace{definition.name, options.robot, options.domain, options.vendor == bus::kInprocess});
  BusProblems problems;
  options.on_problem = [&problems](const std::string& problem) { problems.add(problem); };
  options.traffic = std::make_shared<bus::Traffic>();
  BoundedEnd end("rtd-" + definition.name);
  const std::int64_t begin_ns = monotonic_ns();
  const std::shared_ptr<bus::Bus> bus = join_bus(options);
  options.on_problem = {};  // a further connection would say the same again
  std::jthread cleaner;     // next to the work: joining the bus is what a restarted service must be quick at
  if (options.vendor != bus::kInprocess) cleaner = std::jthread(remove_leftovers);
  for (const std::string& warning : bus::host_warnings(options)) SPDLOG_INFO("event=host_limit cause=\"{}\"", warning);
  for (const bus::EnvironmentSetting& setting : options.environment) log_setting(setting);
  ExitCode code = kOk;
  {
    using SecondInstance = Heartbeat::SecondInstance;
    Heartbeat heartbeat(*bus, shared.empty() ? definition.name : shared, stop,
                        shared.empty() ? SecondInstance::kReported : SecondInstance::kAllowed);
    problems.count_in(&heartbeat);
    const std::shared_ptr<void> at_end(nullptr, [&problems](void*) { problems.count_in(nullptr); });
    heartbeat.watch_progress(std::chrono::milliseconds(patience_of(pace).stuck_ms));
    std::optional<NoPeersWarning> warning;
    if (shared.empty()) {
      warning.emplace(heartbeat, options,
                      [](const std::string& cause) { SPDLOG_WARN("event=no_peers cause=\"{}\"", cause); });
    }
    const SystemdLink systemd([&heartbeat] { return heartbeat.work(); });
    Trace trace(process_environment()(kTraceVariable).value_or(""), definition.name);
    std::optional<ParameterServer> parameters;
    std::jthread offering;  // next to the work, too; of a service that several processes may be, none is the node
    if (shared.empty() && !options.security.enabled())
      offering = std::jthread([&] { offer_parameters(parameters, *bus, definition.name, heartbeat); });
    const auto bound_end = [&](int exit_code) {
      end.begin(exit_code, stop.stop_requested() ? BoundedEnd::kWhenAsked : BoundedEnd::kByItself);
    };
    Runtime runtime{*bus, heartbeat, stop, pace, options, bound_end, trace};
    SPDLOG_INFO("event=started dds={} domain={} pace={} pid={}{}", bus->vendor(), options.domain, to_string(pace),
                getpid(), options.security.enabled() ? " enclave=" + options.security.enclave : "");
    trace.span("join", begin_ns, monotonic_ns(), 0);
    code = definition.run(runtime);
    bound_end(code);
  }
  log_repeated_events();
  SPDLOG_INFO("event=ended exit={}", static_cast<int>(code));
  return code;
}

using std::chrono::microseconds;
constexpr microseconds kNotifyPeriod{50'000};
constexpr std::uint64_t kSigns = 10;

}  // namespace

int run_service(const ServiceDefinition& definition, int argc, char** argv) {
  outlive_readers();
  CommonOptions common;
  BusConfig bus_config;
  bus_config.options.shm_segment_mib = definition.shm_segment_mib;
  ConfigBinder binder;
  binder.section("bus", bus_config);
  definition.bind(binder);

  try {
    const std::string program = "rtd-" + definition.name;
    CLI::App app{definition.description, program};
    wrap_help(app);
    app.set_version_flag("--version", program + " " RTD_VERSION);
    add_common_options(app, common);
    binder.add_options(app, common.config.given);
    if (definition.add_options) definition.add_options(app, common.config.given);
    try {
      parse(app, argc, argv);
    } catch (const CLI::ParseError& error) {  // or --help, --version
      return app.exit(error) == 0 ? kOk : kUsageOrConfig;
    }
    load_config(binder, common.config);
    if (common.print_config) {
      std::cout << binder.print();
      return kOk;
    }
    init_logging(definition.name, common.log_level);
    return run_on_bus(definition, bus_config, parse_pace(common.pace));
  } catch (const std::exception& error) {
    std::cerr << "rtd-" << definition.name << ": " << error.what() << '\n';
    if (dynamic_cast<const AlreadyRuns*>(&error) != nullptr) return kAlreadyRuns;
    const bool wrong_setup =
        dynamic_cast<const ConfigError*>(&error) != nullptr || dynamic_cast<const bus::BusError*>(&error) != nullptr;
    return wrong_setup ? kUsageOrConfig : kRunFailed;
  }
}

NoPeersWarning::NoPeersWarning(const Heartbeat& heartbeat, const bus::BusOptions& options,
                               std::function<void(const std::string&)> warn, std::chrono::milliseconds patience) {
  thread_ = std::thread([this, &heartbeat, domain = options.domain, warn = std::move(warn), patience] {
    if (ended_.wait_for(patience) || !heartbeat.alone()) return;
    warn("no other service is in DDS domain " + std::to_string(domain) + bus::other_domains_hint(domain));
  });
}

NoPeersWarning::~NoPeersWarning() {
  ended_.request_stop();
  thread_.join();
}

BoundedEnd::~BoundedEnd() {
  ended_.request_stop();
  if (thread_.joinable()) thread_.join();
}

void BoundedEnd::begin(int exit_code, std::chrono::milliseconds limit) {
  if (thread_.joinable()) return;
  sd_notify(0, "STOPPING=1");
  thread_ = std::thread([this, exit_code, limit] { watch(exit_code, limit); });
}

void BoundedEnd::watch(int exit_code, std::chrono::milliseconds limit) {
  if (ended_.wait_for(limit)) return;
  std::fprintf(stderr, "%s: the bus did not end within %lld ms and is left behind\n", program_.c_str(),
               static_cast<long long>(limit.count()));
  std::fflush(nullptr);
  std::_Exit(exit_code);
}

SystemdLink::SystemdLink(std::function<Heartbeat::Work()> work) : work_(std::move(work)) {
  if (std::getenv("NOTIFY_SOCKET") == nullptr) return;
  thread_ = std::jthread([this](const std::stop_token& ended) { watch(ended); });
}

SystemdLink::~SystemdLink() {
  if (!thread_.joinable()) return;
  sd_notify(0, "STOPPING=1");
}

/// The watchdog gets ten signs of life in its time: a service that was stopped for most of it has the rest to give one.
void SystemdLink::watch(const std::stop_token& ended) {
  std::uint64_t limit_us = 0;
  const bool watched = sd_watchdog_enabled(0, &limit_us) > 0;
  microseconds period = watched ? std::min(kNotifyPeriod, microseconds(limit_us / kSigns)) : kNotifyPeriod;
  std::mutex mutex;
  std::condition_variable_any wake;
  std::unique_lock lock(mutex);
  bool ready = false;
  while (!ended.stop_requested()) {
    const Heartbeat::Work work = work_();
    if (!ready && work != Heartbeat::Work::kNotBegun) {
      sd_notify(0, "READY=1");
      ready = true;
      if (!watched) return;
      period = microseconds(limit_us / kSigns);
    }
    if (watched && work != Heartbeat::Work::kStuck) sd_notify(0, "WATCHDOG=1");
    wake.wait_for(lock, ended, period, [] { return false; });
  }
}

}  // namespace rtd::service
