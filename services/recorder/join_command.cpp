// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/recorder/join_command.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "common/mcap/indexed_reader.hpp"
#include "common/mcap/join.hpp"
#include "common/service/exit_code.hpp"
#include "common/service/progress.hpp"
#include "services/recorder/file_command.hpp"

namespace rtd::recorder {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::vector<std::string> inputs;
  std::string output;
  bool force = false, json = false;
};

struct Part {
  std::unique_ptr<mcap::FileSource> source;
  mcap::Timestamp begin = 0;
};

/// The files that are meant, folders replaced by the parts in them.
std::vector<fs::path> files_of(const std::vector<std::string>& inputs) {
  std::vector<fs::path> files;
  for (const std::string& input : inputs) {
    if (!fs::is_directory(input)) {
      files.emplace_back(input);
      continue;
    }
    const std::size_t before = files.size();
    for (const fs::directory_entry& entry : fs::directory_iterator(input))
      if (entry.path().extension() == ".mcap") files.push_back(entry.path());
    if (files.size() == before) throw mcap::IoError(EISDIR, input + ": this folder holds no .mcap file");
  }
  return files;
}

Part open_part(const fs::path& file) {
  Part part{std::make_unique<mcap::FileSource>(file)};
  if (part.source->being_written()) throw mcap::IoError(EBUSY, file.string() + ": end its recorder first");
  const mcap::IndexedReader reader(*part.source);
  for (const mcap::Problem& problem : reader.problems().listed()) {
    if (problem.kind == mcap::ProblemKind::kNotMcap && problem.data_lost)
      throw mcap::IoError(EINVAL, file.string() + ": this is no MCAP file");
  }
  if (reader.summary().statistics) part.begin = reader.summary().statistics->message_start_time;
  return part;
}

std::vector<Part> open_parts(const std::vector<std::string>& inputs) {
  std::vector<Part> parts;
  for (const fs::path& file : files_of(inputs)) parts.push_back(open_part(file));
  std::ranges::stable_sort(parts, {}, &Part::begin);
  return parts;
}

void print(const mcap::JoinReport& report, const Options& options, std::size_t parts) {
  if (options.json) {
    nlohmann::json json{{"output", options.output},
                        {"parts", parts},
                        {"messages", report.joined.message_count},
                        {"data_lost", report.data_lost},
                        {"problem_count", report.problem_count},
                        {"problems", nlohmann::json::array()}};
    for (const mcap::Problem& problem : report.problems) json["problems"].push_back(to_string(problem));
    std::cout << json.dump(2) << '\n';
    return;
  }
  for (const mcap::Problem& problem : report.problems) std::cout << to_string(problem) << '\n';
  std::cout << report.joined.message_count << " messages of " << parts << " parts in " << options.output << '\n';
}

int join(const Options& options) {
  const std::vector<Part> parts = open_parts(options.inputs);
  std::vector<const mcap::ByteSource*> sources;
  std::uint64_t bytes = 0;
  for (const Part& part : parts) {
    sources.push_back(part.source.get());
    bytes += part.source->size();
  }
  mcap::FileSink sink(options.output, options.force ? mcap::IfExists::kReplace : mcap::IfExists::kFail);
  service::Progress progress(std::cerr, "joining", bytes);
  mcap::JoinOptions joining;
  joining.progress = [&](std::uint64_t done) { progress.reach(done); };
  const mcap::JoinReport report = mcap::join(sources, sink, joining);
  sink.sync();
  print(report, options, parts.size());
  return report.data_lost ? service::kPartialLoss : service::kOk;
}

}  // namespace

bool wants_join(int argc, char** argv) {
  return argc > 1 && std::string(argv[1]) == "join";
}

int run_join(int argc, char** argv) {
  Options options;
  CLI::App app{"Make one recording of the parts of a split one", "rtd-record join"};
  app.add_option("PARTS", options.inputs, "Folder with the parts, or the parts themselves in any order")->required();
  app.add_option("-o,--output", options.output, "New file")->required();
  app.add_flag("--force", options.force, "Replace the new file if it exists");
  app.add_flag("--json", options.json, "Report as JSON");
  return run_file_command(app, argc, argv, [&] { return join(options); });
}

}  // namespace rtd::recorder
