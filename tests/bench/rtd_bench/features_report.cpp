// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <numeric>

#include "tests/bench/rtd_bench/features_bench.hpp"

namespace rtd::bench {
namespace {

template <class T>
double mean(const std::vector<T>& samples) {
  if (samples.empty()) return 0;
  return static_cast<double>(std::accumulate(samples.begin(), samples.end(), T{})) /
         static_cast<double>(samples.size());
}

std::string row(const ExtractorTimes& times) {
  return fmt::format("{:<10} {:>9.2f} {:>9.2f} {:>9.2f} {:>9.2f} {:>9.0f} {:>9.0f} %\n", times.name,
                     percentile(times.wall_ms, 50), percentile(times.wall_ms, 99), percentile(times.cpu_ms, 50),
                     percentile(times.cpu_ms, 99), mean(times.found), 100 * mean(times.spread));
}

nlohmann::json to_json(const ExtractorTimes& times) {
  return {{"wall_ms", {{"p50", percentile(times.wall_ms, 50)}, {"p99", percentile(times.wall_ms, 99)}}},
          {"cpu_ms", {{"p50", percentile(times.cpu_ms, 50)}, {"p99", percentile(times.cpu_ms, 99)}}},
          {"features", mean(times.found)},
          {"cells_with_features", mean(times.spread)}};
}

double ratio(const FeaturesResult& result) {
  const double reference = percentile(result.opencv.cpu_ms, 50);
  return reference > 0 ? percentile(result.own.cpu_ms, 50) / reference : 0;
}

}  // namespace

std::string features_table(const FeaturesResult& result, const FeaturesOptions& options, const std::string& source) {
  std::string text = fmt::format("{} features wanted, {}x{}, {} frames of {}, one thread\n\n", options.features,
                                 result.width, result.height, result.own.wall_ms.size(), source);
  text += fmt::format("{:<10} {:>9} {:>9} {:>9} {:>9} {:>9} {:>11}\n", "", "p50 ms", "p99 ms", "cpu p50", "cpu p99",
                      "found", "cells used");
  text += row(result.own) + row(result.opencv);
  text +=
      fmt::format("\nrtd-slam takes {:.2f} of the CPU time of cv::ORB (p50), and undistorts and reads depth in it\n",
                  ratio(result));
  return text;
}

std::string features_json(const FeaturesResult& result, const FeaturesOptions& options, const std::string& source) {
  const nlohmann::json json{{"source", source},
                            {"frames", result.own.wall_ms.size()},
                            {"width", result.width},
                            {"height", result.height},
                            {"wanted", options.features},
                            {"rtd_slam", to_json(result.own)},
                            {"cv_orb", to_json(result.opencv)},
                            {"cpu_ratio", ratio(result)}};
  return json.dump(2) + '\n';
}

}  // namespace rtd::bench
