// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/recorder/file_commands.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <functional>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "common/mcap/copy.hpp"
#include "common/mcap/indexed_reader.hpp"
#include "common/service/command_line.hpp"
#include "common/service/exit_code.hpp"

namespace rtd::recorder {
namespace {

namespace fs = std::filesystem;

/// The same for both commands: a file that cannot be used is exit code 2, another failure 1.
int run_on_files(CLI::App& app, int argc, char** argv, const std::function<int()>& work) {
  return service::run_command(app, argc, argv, [&]() -> int {
    try {
      return work();
    } catch (const io::IoError& error) {
      std::cerr << "rtd record: " << error.what() << '\n';
      return service::kUsageOrConfig;
    } catch (const std::exception& error) {
      std::cerr << "rtd record: " << error.what() << '\n';
      return service::kRunFailed;
    }
  });
}

struct RecoverOptions {
  std::string input, output;
  bool force = false, json = false;
};

std::string default_output(const fs::path& input) {
  return (input.parent_path() / input.stem()).string() + ".recovered.mcap";
}

nlohmann::json to_json(const mcap::RecoverReport& report, const RecoverOptions& options) {
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

void print(const mcap::RecoverReport& report, const RecoverOptions& options) {
  if (options.json) {
    std::cout << to_json(report, options).dump(2) << '\n';
    return;
  }
  for (const mcap::Problem& problem : report.problems) std::cout << to_string(problem) << '\n';
  std::cout << report.recovered.message_count << " messages recovered to " << options.output;
  if (const auto lost = report.messages_lost())
    std::cout << ", " << *lost << " of those announced in the file are lost";
  std::cout << '\n';
}

int recover(const RecoverOptions& options) {
  const io::FileSource source(options.input);
  if (source.being_written()) {
    std::cerr << "rtd record: " << options.input << " is still being written: stop its recorder first\n";
    return service::kUsageOrConfig;
  }
  io::FileSink sink(options.output, options.force ? io::IfExists::kReplace : io::IfExists::kFail);
  service::Progress progress(std::cerr, "recovering", source.size());
  mcap::RecoverOptions recovering;
  recovering.progress = [&](std::uint64_t bytes) { progress.reach(bytes); };
  const mcap::RecoverReport report = mcap::recover(source, sink, recovering);
  sink.sync();
  print(report, options);
  return report.data_lost ? service::kPartialLoss : service::kOk;
}

int recover_command(int argc, char** argv) {
  RecoverOptions options;
  CLI::App app{"Write what is intact in a damaged or unfinished recording to a well-formed file", "rtd record recover"};
  app.add_option("FILE", options.input, "Recording, MCAP")->required();
  app.add_option("-o,--output", options.output, "New file (default: FILE.recovered.mcap)");
  app.add_flag("--force", options.force, "Replace the new file if it exists");
  app.add_flag("--json", options.json, "Report as JSON");
  return run_on_files(app, argc, argv, [&] {
    if (options.output.empty()) options.output = default_output(options.input);
    return recover(options);
  });
}

struct JoinOptions {
  std::vector<std::string> inputs;
  std::string output;
  bool force = false, json = false;
};

struct Part {
  std::unique_ptr<io::FileSource> source;
  mcap::Timestamp begin = 0;
};

/// The files of the command line; a folder stands for the parts in it.
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
    if (files.size() == before) throw io::IoError(EISDIR, input + ": this folder holds no .mcap file");
  }
  return files;
}

Part open_part(const fs::path& file) {
  Part part{std::make_unique<io::FileSource>(file)};
  if (part.source->being_written()) throw io::IoError(EBUSY, file.string() + ": stop its recorder first");
  const mcap::IndexedReader reader(*part.source);
  for (const mcap::Problem& problem : reader.problems().listed()) {
    if (problem.kind == mcap::ProblemKind::kNotMcap && problem.data_lost)
      throw io::IoError(EINVAL, file.string() + ": this is not an MCAP file");
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

void print(const mcap::JoinReport& report, const JoinOptions& options, std::size_t parts) {
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

int join(const JoinOptions& options) {
  const std::vector<Part> parts = open_parts(options.inputs);
  std::vector<const io::ByteSource*> sources;
  std::uint64_t bytes = 0;
  for (const Part& part : parts) {
    sources.push_back(part.source.get());
    bytes += part.source->size();
  }
  io::FileSink sink(options.output, options.force ? io::IfExists::kReplace : io::IfExists::kFail);
  service::Progress progress(std::cerr, "joining", bytes);
  mcap::JoinOptions joining;
  joining.progress = [&](std::uint64_t done) { progress.reach(done); };
  const mcap::JoinReport report = mcap::join(sources, sink, joining);
  sink.sync();
  print(report, options, parts.size());
  return report.data_lost ? service::kPartialLoss : service::kOk;
}

int join_command(int argc, char** argv) {
  JoinOptions options;
  CLI::App app{"Join the parts of a split recording into one file", "rtd record join"};
  app.add_option("PARTS", options.inputs, "Folder with the parts, or the parts themselves in any order")->required();
  app.add_option("-o,--output", options.output, "New file")->required();
  app.add_flag("--force", options.force, "Replace the new file if it exists");
  app.add_flag("--json", options.json, "Report as JSON");
  return run_on_files(app, argc, argv, [&] { return join(options); });
}

}  // namespace

std::optional<int> run_file_command(int argc, char** argv) {
  const std::string name = argc > 1 ? argv[1] : "";
  if (name == "recover") return recover_command(argc - 1, argv + 1);
  if (name == "join") return join_command(argc - 1, argv + 1);
  return std::nullopt;
}

}  // namespace rtd::recorder
