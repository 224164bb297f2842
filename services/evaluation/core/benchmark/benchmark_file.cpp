// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "common/io/input_file.hpp"
#include "common/service/config.hpp"
#include "services/evaluation/core/benchmark/benchmark.hpp"

namespace rtd::eval {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kFormat = 1;

Json run_json(const BenchmarkRun& run) {
  return {{"sequence", run.sequence},
          {"folder", run.folder},
          {"mode", run.mode},
          {"run", run.run},
          {"duration_s", run.duration_s},
          {"failure", run.failure.empty() ? Json(nullptr) : Json(run.failure)},
          {"figures", run.figures}};
}

BenchmarkRun run_from(const nlohmann::json& json) {
  const nlohmann::json& failure = json.at("failure");
  return {json.at("sequence"),
          json.at("folder"),
          json.at("mode"),
          json.at("run"),
          json.at("duration_s"),
          failure.is_null() ? "" : failure.get<std::string>(),
          json.at("figures").get<Figures>()};
}

Json row_json(const BenchmarkRow& row) {
  Json json = {{"sequence", row.sequence}, {"mode", row.mode}, {"runs", row.runs}, {"failed", row.failed}};
  Json& figures = json["figures"] = Json::object();
  for (const auto& [name, spread] : row.figures) figures[name] = spread_json(spread);
  return json;
}

Benchmark benchmark_from(const nlohmann::json& json) {
  Benchmark benchmark;
  BenchmarkSettings& settings = benchmark.settings;
  settings.version = json.at("version");
  settings.build = json.at("build");
  settings.dataset = json.at("dataset");
  settings.detector = json.at("detector");
  settings.frames = json.at("frames");
  settings.set = json.at("set").get<std::vector<std::string>>();
  benchmark.jobs = json.at("jobs");
  benchmark.complete = json.at("complete");
  for (const nlohmann::json& run : json.at("runs")) benchmark.runs.push_back(run_from(run));
  return benchmark;
}

}  // namespace

Json benchmark_json(const Benchmark& benchmark) {
  const BenchmarkSettings& settings = benchmark.settings;
  Json json = {{"format", kFormat},           {"version", settings.version},   {"build", settings.build},
               {"dataset", settings.dataset}, {"detector", settings.detector}, {"frames", settings.frames},
               {"set", settings.set},         {"jobs", benchmark.jobs},        {"complete", benchmark.complete},
               {"notes", benchmark.notes},    {"left_out", Json::array()},     {"rows", Json::array()},
               {"runs", Json::array()}};
  for (const LeftOut& one : benchmark.left_out)
    json["left_out"].push_back({{"folder", one.folder}, {"reason", one.reason}});
  for (const BenchmarkRow& row : summarize(benchmark)) json["rows"].push_back(row_json(row));
  for (const BenchmarkRun& run : benchmark.runs) json["runs"].push_back(run_json(run));
  return json;
}

Benchmark read_benchmark(const std::string& file) {
  const auto text = io::try_read_file(file, io::kResults);
  if (!text) throw service::ConfigError(file + " cannot be read");
  const nlohmann::json json = nlohmann::json::parse(*text, nullptr, false);
  if (!json.is_object() || json.value("format", nlohmann::json()) != kFormat)
    throw service::ConfigError(file + " is not a benchmark.json that 'rtd benchmark' wrote");
  try {
    return benchmark_from(json);
  } catch (const nlohmann::json::exception& error) {
    throw service::ConfigError(file + " is damaged (" + error.what() + "): remove it");
  }
}

}  // namespace rtd::eval
