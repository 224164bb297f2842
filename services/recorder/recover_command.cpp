// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/recorder/recover_command.hpp"

#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>

#include "common/mcap/recover.hpp"
#include "common/service/exit_code.hpp"
#include "common/service/progress.hpp"
#include "services/recorder/file_command.hpp"

namespace rtd::recorder {
namespace {

struct Options {
  std::string input, output;
  bool force = false, json = false;
};

std::string default_output(const std::filesystem::path& input) {
  return (input.parent_path() / input.stem()).string() + ".recovered.mcap";
}

nlohmann::json to_json(const mcap::RecoverReport& report, const Options& options) {
  nlohmann::json json{{"input", options.input},
                      {"output", options.output},
                      {"messages", report.recovered.message_count},
                      {"chunks", report.recovered.chunk_count},
                      {"data_lost", report.data_lost},
                      {"problem_count", report.problem_count},
                      {"problems", nlohmann::json::array()}};
  if (const auto lost = report.messages_lost()) json["messages_lost"] = *lost;
  for (const mcap::Problem& problem : report.problems) json["problems"].push_back(to_string(problem));
  return json;
}

void print(const mcap::RecoverReport& report, const Options& options) {
  if (options.json) {
    std::cout << to_json(report, options).dump(2) << '\n';
    return;
  }
  for (const mcap::Problem& problem : report.problems) std::cout << to_string(problem) << '\n';
  std::cout << report.recovered.message_count << " messages recovered to " << options.output;
  if (const auto lost = report.messages_lost()) std::cout << ", " << *lost << " of those announced are lost";
  std::cout << '\n';
}

int recover(const Options& options) {
  const mcap::FileSource source(options.input);
  if (source.being_written()) {
    std::cerr << "rtd-record: " << options.input << " is being written: end its recorder first\n";
    return service::kUsageOrConfig;
  }
  mcap::FileSink sink(options.output, options.force ? mcap::IfExists::kReplace : mcap::IfExists::kFail);
  service::Progress progress(std::cerr, "recovering", source.size());
  mcap::RecoverOptions recovering;
  recovering.progress = [&](std::uint64_t bytes) { progress.reach(bytes); };
  const mcap::RecoverReport report = mcap::recover(source, sink, recovering);
  sink.sync();
  print(report, options);
  return report.data_lost ? service::kPartialLoss : service::kOk;
}

}  // namespace

bool wants_recover(int argc, char** argv) {
  return argc > 1 && std::string(argv[1]) == "recover";
}

int run_recover(int argc, char** argv) {
  Options options;
  CLI::App app{"Make what is whole in a damaged or unfinished recording a well-formed one", "rtd-record recover"};
  app.add_option("FILE", options.input, "Recording, MCAP")->required();
  app.add_option("-o,--output", options.output, "New file (default: FILE.recovered.mcap)");
  app.add_flag("--force", options.force, "Replace the new file if it exists");
  app.add_flag("--json", options.json, "Report as JSON");
  return run_file_command(app, argc, argv, [&] {
    if (options.output.empty()) options.output = default_output(options.input);
    return recover(options);
  });
}

}  // namespace rtd::recorder
