// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/rtd_bench/transport/transport_bench.hpp"

#include <iostream>
#include <nlohmann/json.hpp>

#include "tests/bench/rtd_bench/transport/transport_worker.hpp"
#include "tests/bench/rtd_bench/transport/worker_process.hpp"

namespace rtd::bench {
namespace {

using nlohmann::json;

std::vector<std::string> worker_arguments(const std::string& role, const TransportCase& what,
                                          const TransportOptions& options) {
  return {"transport-worker",
          "--role",
          role,
          "--dds",
          what.vendor,
          "--path",
          to_string(what.path),
          "--payload",
          to_string(what.payload),
          "--domain",
          std::to_string(options.domain),
          "--messages",
          std::to_string(options.messages),
          "--rate",
          std::to_string(options.rate_hz),
          "--flood",
          std::to_string(options.flood_s)};
}

/// The JSON of a worker, or why there is none.
json result_of(const WorkerProcess::End& end, const std::string& role, std::string& failure) {
  const json result = json::parse(end.output, nullptr, false);
  if (end.code == 0 && result.is_object() && !result.contains("failure")) return result;
  if (failure.empty()) {
    failure = result.is_object() && result.contains("failure") ? result["failure"].get<std::string>()
                                                               : role + " process ended without a result";
  }
  return json::object();
}

TransportResult run_case(const TransportCase& what, const TransportOptions& options) {
  TransportResult result{what, {}, {}, {}};
  const auto longest = std::chrono::seconds(
      30 + static_cast<long>(options.flood_s + 2 * static_cast<double>(options.messages) / options.rate_hz));
  WorkerProcess subscriber(worker_arguments("subscribe", what, options));
  WorkerProcess publisher(worker_arguments("publish", what, options));
  const json published = result_of(publisher.finish(longest), "publisher", result.failure);
  subscriber.ask_to_end();
  const json received = result_of(subscriber.finish(std::chrono::seconds(10)), "subscriber", result.failure);
  if (!result.failure.empty()) return result;
  result.publisher = {published["bytes"], published["memcpy_us"], published["cpu_percent"], published["rate_hz"],
                      published["repeated"]};
  result.subscriber = {received["latency_us"], received["cpu_percent"]};
  return result;
}

}  // namespace

std::vector<TransportResult> bench_transport(const TransportOptions& options,
                                             const std::function<void(const TransportCase&)>& on_case) {
  std::vector<TransportResult> results;
  for (const TransportCase& what : transport_cases(options)) {
    on_case(what);
    results.push_back(run_case(what, options));
  }
  return results;
}

int run_transport_worker(const std::string& role, const TransportCase& what, const TransportOptions& options) {
  try {
    if (role == "publish") {
      const PublisherResult result = publish(what, options);
      std::cout << json{{"bytes", result.bytes},
                        {"memcpy_us", result.memcpy_us},
                        {"cpu_percent", result.cpu_percent},
                        {"rate_hz", result.rate_hz},
                        {"repeated", result.repeated}};
    } else {
      const SubscriberResult result = subscribe(what, options);
      std::cout << json{{"latency_us", result.latency_us}, {"cpu_percent", result.cpu_percent}};
    }
    return 0;
  } catch (const std::exception& error) {
    std::cout << json{{"failure", error.what()}};
    return 1;
  }
}

}  // namespace rtd::bench
