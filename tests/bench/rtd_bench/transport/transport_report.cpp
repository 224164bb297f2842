// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "tests/bench/rtd_bench/percentile.hpp"
#include "tests/bench/rtd_bench/transport/transport_bench.hpp"

namespace rtd::bench {
namespace {

double p50(const std::vector<double>& samples) {
  return percentile(samples, 50);
}

double to_memcpy_ratio(const TransportResult& result) {
  const double reference = p50(result.publisher.memcpy_us);
  return reference > 0 ? p50(result.subscriber.latency_us) / reference : 0;
}

std::string row(const TransportResult& result, const TransportOptions& options) {
  const std::string head = fmt::format("  {:<11} {:<8}", result.what.vendor, to_string(result.what.path));
  if (!result.failure.empty()) return fmt::format("{} {}\n", head, result.failure);
  const auto& [publisher, subscriber] = std::tie(result.publisher, result.subscriber);
  const std::size_t missing = static_cast<std::size_t>(options.messages) -
                              std::min(subscriber.latency_us.size(), static_cast<std::size_t>(options.messages));
  return fmt::format("{} {:>9.0f} {:>9.0f} {:>9.1f} {:>8} {:>9.1f} {:>9.1f} {:>10.0f} {:>8.0f}{}\n", head,
                     p50(subscriber.latency_us), percentile(subscriber.latency_us, 99), p50(publisher.memcpy_us),
                     fmt::format("{:.1f}x", to_memcpy_ratio(result)), publisher.cpu_percent, subscriber.cpu_percent,
                     publisher.rate_hz, publisher.rate_hz * static_cast<double>(publisher.bytes) / 1e6,
                     missing > 0 ? fmt::format("  {} of {} never came", missing, options.messages) : "");
}

nlohmann::json spread(const std::vector<double>& samples) {
  return {{"p50", p50(samples)}, {"p99", percentile(samples, 99)}, {"samples", samples.size()}};
}

nlohmann::json to_json(const TransportResult& result) {
  nlohmann::json row{{"vendor", result.what.vendor},
                     {"path", to_string(result.what.path)},
                     {"message", to_string(result.what.payload)}};
  if (!result.failure.empty()) {
    row["failure"] = result.failure;
    return row;
  }
  row["bytes"] = result.publisher.bytes;
  row["latency_us"] = spread(result.subscriber.latency_us);
  row["memcpy_us"] = spread(result.publisher.memcpy_us);
  row["cpu_percent"] = {{"publisher", result.publisher.cpu_percent}, {"subscriber", result.subscriber.cpu_percent}};
  row["max_rate_hz"] = result.publisher.rate_hz;
  row["repeated"] = result.publisher.repeated;
  return row;
}

}  // namespace

std::string transport_table(const std::vector<TransportResult>& results, const TransportOptions& options) {
  std::string text = fmt::format(
      "{} messages at {:g} Hz from write() in one process to a copy that another one may keep; rate with three in "
      "flight\n",
      options.messages, options.rate_hz);
  const char* message = "";
  for (const TransportResult& result : results) {
    if (message != title(result.what.payload)) {
      message = title(result.what.payload);
      text += fmt::format("\n{:<22} {:>9} {:>9} {:>9} {:>8} {:>9} {:>9} {:>10} {:>8}\n", message, "p50 us", "p99 us",
                          "memcpy us", "ratio", "pub CPU %", "sub CPU %", "max Hz", "MB/s");
    }
    text += row(result, options);
  }
  return text;
}

std::string transport_json(const std::vector<TransportResult>& results, const TransportOptions& options) {
  nlohmann::json json{{"messages", options.messages}, {"rate_hz", options.rate_hz}, {"cases", nlohmann::json::array()}};
  for (const TransportResult& result : results) json["cases"].push_back(to_json(result));
  return json.dump(2) + '\n';
}

}  // namespace rtd::bench
