// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/io/input_file.hpp"
#include "common/service/config.hpp"
#include "services/evaluation/core/experiment/experiment.hpp"
#include "services/evaluation/core/trajectory/evaluation.hpp"

namespace rtd::eval {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kExperimentFormat = 2;

Json run_json(const ExperimentRun& run) {
  return {{"source", run.source},         {"variant", run.variant}, {"run", run.run},
          {"duration_s", run.duration_s}, {"failure", run.failure}, {"figures", run.figures},
          {"trajectory", run.trajectory}};
}

ExperimentRun run_from(const nlohmann::json& json) {
  return {json.at("source"),  json.at("variant"), json.at("run"),       json.at("duration_s"),
          json.at("failure"), json.at("figures"), json.at("trajectory")};
}

/// Unknown values are null.
Json spread_json(const Spread& spread) {
  return {{"median", number_or_null(spread.median)},
          {"min", number_or_null(spread.min)},
          {"max", number_or_null(spread.max)}};
}

Json row_json(const ExperimentRow& row) {
  Json json = {{"subject", row.subject}, {"variant", row.variant}, {"runs", row.runs},
               {"failed", row.failed},   {"failure", row.failure}, {"trajectories_differ", row.differ}};
  Json& figures = json["figures"] = Json::object();
  for (const auto& [name, spread] : row.figures) figures[name] = spread_json(spread);
  return json;
}

Json plan_json(const Experiment& experiment) {
  Json json = {{"subjects", Json::array()}, {"variants", Json::array()}, {"left_out", Json::array()}};
  for (const auto& [name, source] : experiment.subjects)
    json["subjects"].push_back({{"name", name}, {"source", source}});
  for (const Variant& one : experiment.variants)
    json["variants"].push_back(
        {{"name", one.name}, {"mode", one.mode}, {"settings", one.settings}, {"meaning", one.meaning}});
  for (const LeftOut& one : experiment.left_out)
    json["left_out"].push_back({{"folder", one.folder}, {"reason", one.reason}});
  return json;
}

Experiment experiment_from(const nlohmann::json& json) {
  Experiment experiment;
  experiment.name = json.at("name");
  experiment.settings = json.at("settings");
  experiment.complete = json.at("complete");
  for (const auto& one : json.at("subjects")) experiment.subjects.push_back({one.at("name"), one.at("source")});
  for (const auto& one : json.at("variants"))
    experiment.variants.push_back({one.at("name"), one.at("mode"), one.at("settings"), one.at("meaning")});
  for (const auto& run : json.at("results")) experiment.results.push_back(run_from(run));
  return experiment;
}

}  // namespace

Json experiment_json(const Experiment& experiment) {
  Json json = {{"format", kExperimentFormat}, {"name", experiment.name},      {"settings", experiment.settings},
               {"runs", experiment.runs},     {"jobs", experiment.jobs},      {"complete", experiment.complete},
               {"baseline", kBaseline},       {"notes", notes_of(experiment)}};
  json.update(plan_json(experiment));
  json["rows"] = json["results"] = Json::array();
  for (const ExperimentRow& row : summarize(experiment)) json["rows"].push_back(row_json(row));
  for (const ExperimentRun& run : experiment.results) json["results"].push_back(run_json(run));
  return json;
}

Experiment read_experiment(const std::string& file) {
  const auto text = io::try_read_file(file, io::kResults);
  if (!text) throw service::ConfigError(file + " cannot be read");
  const nlohmann::json json = nlohmann::json::parse(*text, nullptr, false);
  if (!json.is_object() || json.value("format", nlohmann::json()) != kExperimentFormat)
    throw service::ConfigError(file + " is not a file that 'rtd ablate' or 'rtd benchmark' of this version wrote");
  try {
    return experiment_from(json);
  } catch (const nlohmann::json::exception& error) {
    throw service::ConfigError(file + " is damaged (" + error.what() + "): remove it");
  }
}

}  // namespace rtd::eval
