// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/commands/experiment_plan.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "common/camera/open/source_factory.hpp"
#include "common/io/bytes.hpp"
#include "common/io/input_file.hpp"
#include "common/msg/filter_modes.hpp"
#include "common/process/executable.hpp"
#include "common/run_record/run_record.hpp"
#include "common/service/config.hpp"
#include "common/service/model_locator.hpp"
#include "services/evaluation/core/datasets/dataset.hpp"

namespace rtd::eval {
namespace fs = std::filesystem;
namespace {

std::string require_executable(const std::string& name) {
  std::string path = process::find_executable(name);
  if (path.empty()) throw service::ConfigError(process::missing_executable(name));
  return path;
}

/// Another build has other bytes.
std::string build_id() {
  std::uint32_t crc = 0;
  for (const char* name : {"rtd", "rtd-camera", "rtd-detector", "rtd-filter", "rtd-slam"}) {
    const auto bytes = io::try_read_file(require_executable(name), io::kNetwork);
    if (bytes) crc = io::crc32(io::bytes_of(*bytes), crc);
  }
  return fmt::format("{:08x}", crc);
}

/// The keys that `rtd-filter` and `rtd-slam` print with --print-config.
std::vector<Technique> known_techniques() {
  std::vector<Technique> techniques;
  for (const char* service : {"filter", "slam"}) {
    const std::string executable = require_executable(std::string("rtd-") + service);
    const std::string printed = process::output_of(executable, {"--print-config"});
    if (printed.empty()) throw service::ConfigError(executable + " --print-config printed nothing");
    const std::vector<Technique> found = read_techniques(printed, service);
    techniques.insert(techniques.end(), found.begin(), found.end());
  }
  return techniques;
}

/// The network's file; empty: no detector.
std::string model_of(const ExperimentOptions& options) {
  if (options.detector == "off") return "";
  const service::ModelSearch model = service::find_model(options.model, service::process_environment());
  if (!model && !options.model.empty()) throw service::ConfigError(model.message);
  return model ? model.path : "";
}

void choose_variants(const ExperimentOptions& options, Experiment& experiment) {
  const bool detector = !experiment.settings["model"].get<std::string>().empty();
  VariantPlan plan =
      options.is_benchmark()
          ? plan_variants({options.modes, {"none"}, detector}, msg::filter_mode_names(), {})
          : plan_variants({options.modes, options.without, detector}, msg::filter_mode_names(), known_techniques());
  experiment.variants = std::move(plan.variants);
  experiment.notes = std::move(plan.notes);
  if (!detector) experiment.notes.emplace_back("no detector: mode rtd has geometry only");
}

/// An experiment compares errors, so the source needs ground truth.
void check_source(const std::string& uri, const ExperimentOptions& options, std::vector<std::string>& notes) {
  const auto source = camera::make_source(uri);
  if (source->info().frames == 0 && options.frames == 0)
    throw service::ConfigError("--source " + uri + " is endless: limit it with --frames");
  if (!run_record::is_synthetic(uri) && source->groundtruth().empty())
    throw service::ConfigError("--source " + uri +
                               " has no ground truth: there is no error to compare (groundtruth.txt)");
  if (!run_record::has_true_masks(uri))
    notes.push_back(uri + " has no mask/: precision and recall of removed points are unknown");
}

void take_sources(const ExperimentOptions& options, Experiment& experiment) {
  std::vector<std::string> uris;
  for (const std::string& source : options.sources) {
    uris.push_back(camera::complete_uri(source));
    check_source(uris.back(), options, experiment.notes);
  }
  const std::vector<std::string> names = source_names(uris);
  for (std::size_t i = 0; i < uris.size(); ++i) experiment.subjects.push_back({names[i], uris[i]});
}

/// Of OpenLORIS-Scene a folder with links to the images, all of which find_sequences() has found below the sequence.
std::string source_of(Dataset dataset, const Sequence& sequence, const std::string& out_dir) {
  if (dataset != Dataset::kOpenloris) return "tum:" + sequence.folder.string();
  const fs::path folder = fs::absolute(out_dir) / "sequences" / sequence.name;
  prepare_openloris(sequence.folder, folder);
  return "tum:" + folder.string() + "?outside=1";
}

void find_subjects(const ExperimentOptions& options, Experiment& experiment) {
  const NamedDataset& dataset = *find_dataset(options.dataset);
  FoundSequences found = find_sequences(dataset.dataset, options.folders);
  experiment.left_out = std::move(found.left_out);
  for (const Sequence& sequence : found.sequences) {
    try {
      experiment.subjects.push_back({sequence.name, source_of(dataset.dataset, sequence, options.out_dir)});
    } catch (const camera::SourceError& error) {
      experiment.left_out.push_back({sequence.folder.string(), error.what()});
    }
  }
  if (experiment.subjects.empty())
    throw service::ConfigError(fmt::format("no sequence of {} to run in these folders; its sequences are named {}",
                                           dataset.title, dataset.folder_form));
}

/// The settings of the services, in the domain of this place.
std::vector<std::string> service_settings(service::ConfigSources config, int place) {
  if (place > 0) {
    const int domain = service::load_bus_options(config, "rtd-eval").domain + place;
    std::erase_if(config.given, [](const service::GivenOption& option) { return option.key == "bus.domain"; });
    config.given.push_back({"bus.domain", "--domain", {std::to_string(domain)}});
  }
  return service::to_command_line(config);
}

}  // namespace

Experiment plan_experiment(const ExperimentOptions& options) {
  Experiment experiment;
  experiment.name = options.is_benchmark() ? "benchmark" : "ablation";
  experiment.settings = {{"version", RTD_VERSION},
                         {"build", build_id()},
                         {"dataset", options.dataset},
                         {"model", fs::path(model_of(options)).filename().string()},
                         {"pace", options.pace},
                         {"frames", options.frames},
                         {"set", options.config.overrides},
                         {"config", options.config.file}};
  experiment.runs = options.runs;
  experiment.jobs = options.jobs;
  experiment.repeats = !options.is_benchmark() && options.pace == "lockstep";
  choose_variants(options, experiment);
  if (options.is_benchmark()) {
    find_subjects(options, experiment);
  } else {
    take_sources(options, experiment);
  }
  if (options.runs > 1 && experiment.repeats)
    experiment.notes.emplace_back(
        "lockstep gives the same bytes each time: more than one run is a check, not a statistic");
  return experiment;
}

std::vector<PlannedRun> missing_runs(const ExperimentOptions& options, const Experiment& experiment) {
  std::vector<PlannedRun> planned;
  for (int run = 1; run <= options.runs; ++run) {
    for (const Subject& subject : experiment.subjects) {
      for (const Variant& variant : experiment.variants) {
        if (find_run(experiment, subject.source, variant.name, run) != nullptr) continue;
        const fs::path folder = fs::path(options.out_dir) / subject.name / variant.folder() / std::to_string(run);
        planned.push_back({subject, variant, run, folder.string()});
      }
    }
  }
  return planned;
}

int feature_count_of(int run) {
  return run == 1 ? 1000 : 800 + 157 * run % 401;
}

std::vector<std::string> run_command(const ExperimentOptions& options, const PlannedRun& planned, int place) {
  std::vector<std::string> command = {require_executable("rtd"), "run"};
  const auto add = [&](const std::string& option, const std::string& value) {
    if (!value.empty()) command.insert(command.end(), {option, value});
  };
  add("--source", planned.subject.source);
  add("--out", planned.folder);
  add("--pace", options.pace);
  add("--filter", planned.variant.mode);
  add("--detector", options.detector);
  add("--model", options.model);
  if (options.frames > 0) add("--frames", std::to_string(options.frames));
  for (const std::string& word : service_settings(options.config, place)) command.push_back(word);
  for (const std::string& assignment : planned.variant.settings) add("--set", assignment);
  if (options.is_benchmark() && planned.run > 1)
    add("--set", fmt::format("filter.orb.feature_count={}", feature_count_of(planned.run)));
  command.emplace_back("--quiet");
  return command;
}

}  // namespace rtd::eval
