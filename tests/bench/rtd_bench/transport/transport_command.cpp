// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/rtd_bench/transport/transport_command.hpp"

#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <iostream>

#include "common/service/command_line.hpp"
#include "common/service/exit_code.hpp"
#include "tests/bench/rtd_bench/transport/transport_bench.hpp"
#include "tests/support/test_domain.hpp"

namespace rtd::bench {
namespace {

void add_measuring_options(CLI::App& command, TransportOptions& options) {
  command.add_option("--messages", options.messages, "For the latency of each case")
      ->check(CLI::Range(2, 100'000))
      ->capture_default_str();
  command.add_option("--rate", options.rate_hz, "Messages a second meanwhile")
      ->check(CLI::Range(1.0, 10'000.0))
      ->capture_default_str();
  command.add_option("--flood", options.flood_s, "Seconds for the maximum rate")
      ->check(CLI::Range(0.0, 600.0))
      ->capture_default_str();
  command.add_option("--domain", options.domain, "DDS domain; else one of this process's own")
      ->check(CLI::Range(0, 232));
}

int run_bench(TransportRequest& request) {
  TransportOptions& options = request.options;
  if (options.domain == 0) options.domain = test_domain();
  if (!request.payloads.empty()) options.payloads.clear();
  for (const std::string& name : request.payloads) options.payloads.push_back(*parse_payload(name));
  service::Progress progress(std::cerr, "cases", transport_cases(options).size());
  std::uint64_t done = 0;
  const auto results = bench_transport(options, [&](const TransportCase&) { progress.reach(done++); });
  std::cout << (request.json ? transport_json(results, options) : transport_table(results, options));
  const bool failed =
      std::any_of(results.begin(), results.end(), [](const auto& result) { return !result.failure.empty(); });
  return failed ? service::kRunFailed : service::kOk;
}

int run_worker(const TransportRequest& request) {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);  // before any thread exists
  const auto path = parse_path(request.worker_path);
  const auto payload = parse_payload(request.worker_payload);
  if (!path || !payload) return service::kUsageOrConfig;
  return run_transport_worker(request.worker_role, {request.worker_vendor, *path, *payload}, request.options);
}

}  // namespace

void add_transport_commands(CLI::App& app, TransportRequest& request) {
  CLI::App* bench = app.add_subcommand("transport", "Latency, CPU and maximum rate of every message on every path");
  add_measuring_options(*bench, request.options);
  bench->add_option("--dds", request.options.vendors, "Only these DDS implementations")
      ->delimiter(',')
      ->check(CLI::IsMember(bus::dds_vendors()));
  bench
      ->add_option("--only", request.payloads,
                   "Only these of frame, frame-848x480, frame-1280x720, frame-1920x1200, jpeg, features, pose")
      ->delimiter(',')
      ->check(
          CLI::IsMember({"frame", "frame-848x480", "frame-1280x720", "frame-1920x1200", "jpeg", "features", "pose"}));
  bench->add_flag("--json", request.json, "Report as JSON");

  CLI::App* worker = app.add_subcommand("transport-worker", "One side of one case")->group("");
  add_measuring_options(*worker, request.options);
  worker->add_option("--role", request.worker_role)->required();
  worker->add_option("--dds", request.worker_vendor)->required();
  worker->add_option("--path", request.worker_path)->required();
  worker->add_option("--payload", request.worker_payload)->required();
}

std::optional<int> run_transport(const CLI::App& app, TransportRequest& request) {
  if (app.got_subcommand("transport")) return run_bench(request);
  if (app.got_subcommand("transport-worker")) return run_worker(request);
  return std::nullopt;
}

}  // namespace rtd::bench
