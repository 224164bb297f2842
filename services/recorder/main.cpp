// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <functional>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "common/io/atomic_file.hpp"
#include "common/io/folder_walk.hpp"
#include "common/io/recording_forms.hpp"
#include "common/mcap/copy.hpp"
#include "common/mcap/indexed_reader.hpp"
#include "common/mcap/recording_file.hpp"
#include "common/service/command_line.hpp"
#include "common/service/json_text.hpp"
#include "common/service/run_service.hpp"
#include "services/recorder/recorder_service.hpp"

/// The commands of rtd-record that work on files and need no bus: 'recover' and 'join'. Their exit code: 0; 1 failed;
/// 2 wrong options, or a file that cannot be used; 3 something in a file is lost.
namespace rtd::recorder {
namespace {

namespace fs = std::filesystem;

/// The command line of both.
struct FileOptions {
  std::string input;               ///< recover
  std::vector<std::string> parts;  ///< join
  std::string output;
  bool force = false, json = false;
};

void add_output_options(CLI::App& app, FileOptions& options) {
  app.add_flag("--force", options.force, "Replace the new file if it exists");
  app.add_flag("--json", options.json, "Report as JSON");
}

/// The new file; it gets its name when it is whole.
io::AtomicOptions output_options(const FileOptions& options) {
  return {.named_by = io::NamedBy::kOperator,
          .if_exists = options.force ? io::IfExists::kReplace : io::IfExists::kFail};
}

/// The same for both commands: a file that cannot be used is exit code 2, another failure 1.
int run_on_files(CLI::App& app, int argc, char** argv, const std::function<int()>& work) {
  return service::run_command(app, argc, argv, [&] {
    return service::report_errors<io::IoError, mcap::RecordingFileError>("rtd record", std::cerr, work);
  });
}

std::string default_output(const fs::path& input) {
  return (input.parent_path() / input.stem()).string() + ".recovered.mcap";
}

/// The problems as text, or `summary` with them as JSON.
void print(const mcap::CopyReport& report, const FileOptions& options, nlohmann::json summary, std::string text) {
  if (const auto lost = report.messages_lost()) {
    summary["messages_lost"] = *lost;
    if (*lost > 0) text += ", " + std::to_string(*lost) + " of those announced are lost";
  }
  if (!options.json) {
    for (const mcap::Problem& problem : report.problems) std::cout << to_string(problem) << '\n';
    std::cout << text << '\n';
    return;
  }
  summary.update({{"output", options.output},
                  {"messages", report.copied.message_count},
                  {"data_lost", report.data_lost},
                  {"problem_count", report.problem_count},
                  {"problems", nlohmann::json::array()}});
  for (const mcap::Problem& problem : report.problems) summary["problems"].push_back(to_string(problem));
  std::cout << service::json_text(summary) << '\n';
}

int recover(const FileOptions& options) {
  const io::FileSource source = mcap::open_recording(options.input);
  if (source.being_written()) {
    std::cerr << "rtd record: " << options.input << " is still being written: stop its recorder first\n";
    return service::kUsageOrConfig;
  }
  io::AtomicFile sink(options.output, output_options(options));
  service::Progress progress(std::cerr, "recovering", source.size());
  mcap::CopyOptions recovering;
  recovering.progress = [&](std::uint64_t bytes) { progress.reach(bytes); };
  const mcap::CopyReport report = mcap::recover(source, sink, recovering);
  sink.commit();
  print(report, options, {{"input", options.input}, {"chunks", report.copied.chunk_count}},
        std::to_string(report.copied.message_count) + " messages recovered to " + options.output);
  return report.data_lost ? service::kPartialLoss : service::kOk;
}

int recover_command(int argc, char** argv) {
  FileOptions options;
  CLI::App app{"Write what is intact in a damaged or unfinished recording to a well-formed file", "rtd record recover"};
  app.add_option("FILE", options.input, "Recording (MCAP), or a folder with one")->required();
  app.add_option("-o,--output", options.output, "New file (default: FILE.recovered.mcap)");
  add_output_options(app, options);
  return run_on_files(app, argc, argv, [&] {
    if (options.output.empty()) options.output = default_output(mcap::recording_path(options.input));
    return recover(options);
  });
}

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
    for (const fs::path& file : io::FolderWalk().paths(input))
      if (file.extension() == io::kMcapExtension) files.push_back(file);
    if (files.size() == before)
      throw io::IoError(EISDIR, input + ": this folder holds no .mcap file: name the parts, or their folder");
  }
  return files;
}

Part open_part(const fs::path& file) {
  Part part{std::make_unique<io::FileSource>(file)};
  if (part.source->being_written()) throw io::IoError(EBUSY, file.string() + ": stop its recorder first");
  mcap::require_recording(*part.source, file.string());
  const mcap::IndexedReader reader(*part.source);
  if (reader.summary().statistics) part.begin = reader.summary().statistics->message_start_time;
  return part;
}

std::vector<Part> open_parts(const std::vector<std::string>& inputs) {
  std::vector<Part> parts;
  for (const fs::path& file : files_of(inputs)) parts.push_back(open_part(file));
  std::ranges::stable_sort(parts, {}, &Part::begin);
  return parts;
}

int join(const FileOptions& options) {
  const std::vector<Part> parts = open_parts(options.parts);
  std::vector<const io::ByteSource*> sources;
  std::uint64_t bytes = 0;
  for (const Part& part : parts) {
    sources.push_back(part.source.get());
    bytes += part.source->size();
  }
  io::AtomicFile sink(options.output, output_options(options));
  service::Progress progress(std::cerr, "joining", bytes);
  mcap::CopyOptions joining;
  joining.progress = [&](std::uint64_t done) { progress.reach(done); };
  const mcap::CopyReport report = mcap::join(sources, sink, joining);
  sink.commit();
  print(report, options, {{"parts", parts.size()}},
        std::to_string(report.copied.message_count) + " messages of " + std::to_string(parts.size()) + " parts in " +
            options.output);
  return report.data_lost ? service::kPartialLoss : service::kOk;
}

int join_command(int argc, char** argv) {
  FileOptions options;
  CLI::App app{"Join the parts of a split recording into one file", "rtd record join"};
  app.add_option("PARTS", options.parts, "Folder with the parts, or the parts themselves in any order")->required();
  app.add_option("-o,--output", options.output, "New file")->required();
  add_output_options(app, options);
  return run_on_files(app, argc, argv, [&] { return join(options); });
}

}  // namespace
}  // namespace rtd::recorder

int main(int argc, char** argv) {
  const std::string command = argc > 1 ? argv[1] : "";
  if (command == "recover") return rtd::recorder::recover_command(argc - 1, argv + 1);
  if (command == "join") return rtd::recorder::join_command(argc - 1, argv + 1);
  return rtd::service::run_service<rtd::recorder::RecorderService>(argc, argv);
}
