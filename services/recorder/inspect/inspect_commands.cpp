// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/recorder/inspect/inspect_commands.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <map>
#include <memory>
#include <ostream>
#include <utility>

#include "common/mcap/recording_file.hpp"
#include "common/recordings/open.hpp"
#include "common/recordings/reader.hpp"
#include "common/service/command_line.hpp"
#include "common/service/exit_code.hpp"
#include "common/service/json_text.hpp"
#include "services/recorder/inspect/recording_diff.hpp"

namespace rtd::recordings {
namespace {

Opened open_showing(const std::string& path, std::ostream& err) {
  service::Progress progress(err, "opening " + path, size_of(path));
  return open(path, [&](std::uint64_t bytes) { progress.reach(bytes); });
}

Contents read(const Opened& opened, const std::string& path, std::ostream& err) {
  service::Progress progress(err, "reading " + path, opened.source->size());
  Contents contents = contents_of(*opened.source, [&](std::uint64_t bytes) { progress.reach(bytes); });
  for (const std::string& damage : opened.damages) {
    contents.data_lost = true;
    contents.problems.push_back({mcap::ProblemKind::kDamagedRecord, 0, damage, "it is left out", true});
  }
  return contents;
}

void warn(const Contents& contents, const std::string& path, std::ostream& err) {
  constexpr std::size_t kMaxProblems = 5;
  if (contents.data_lost)
    err << "rtd diff: " << path << " is damaged, only its readable part is compared:"
        << problems_text(contents.problems, contents.problems.size(), kMaxProblems);
}

int diff_recordings(const DiffRequest& request, std::ostream& out, std::ostream& err) {
  const Opened a = open_showing(request.a, err), b = open_showing(request.b, err);
  const Contents in_a = read(a, request.a, err), in_b = read(b, request.b, err);
  const auto ignored = [&](const char* what) { return std::ranges::count(request.ignore, what) > 0; };
  RecordingDiff difference =
      diff(in_a, in_b, {.ignore_run_fields = ignored("run"), .ignore_stamps = ignored("stamps")});
  explain(difference, *a.source, *b.source);
  warn(in_a, request.a, err);
  warn(in_b, request.b, err);
  out << (request.json ? service::json_text(to_json(difference)) + '\n' : to_text(difference));
  if (!difference.equal()) return service::kRunFailed;
  return in_a.data_lost || in_b.data_lost ? service::kPartialLoss : service::kOk;
}

constexpr char kCompared[] =
    "'rtd diff' compares two recordings (MCAP, rosbag2, ROS 1 bag); two trajectories: cmp, or 'rtd eval A B'";

void require_recording(const std::string& path) {
  if (is_recording(path)) return;
  const std::string other = mcap::other_format(path);
  throw mcap::RecordingFileError(path + " is " + (other.empty() ? "not a recording" : other) + "; " + kCompared);
}

}  // namespace

CLI::App* add_diff_command(CLI::App& parent, DiffRequest& request) {
  CLI::App* command = parent.add_subcommand("diff", "Compare two recordings (MCAP, rosbag2, ROS 1 bag)");
  command->add_option("a", request.a, "Recording, or a folder with one")->required();
  command->add_option("b", request.b, "Another")->required();
  command->add_flag("--json", request.json, "Print JSON instead of text");
  command
      ->add_option("--ignore", request.ignore,
                   "stamps (publish times), run (fields that depend on the process and time of a run: "
                   "published_ns, finished_ns, stage_ms, source_id)")
      ->delimiter(',')
      ->check(CLI::IsMember({"stamps", "run"}));
  command->footer(
      "Exit code: 0 equal, 1 different, 2 a file cannot be used, 3 equal in the readable part of damaged files");
  return command;
}

int run_diff(const DiffRequest& request, std::ostream& out, std::ostream& err) {
  return service::report_errors<mcap::RecordingFileError>("rtd diff", err, [&] {
    for (const std::string& path : {request.a, request.b}) require_recording(path);
    return diff_recordings(request, out, err);
  });
}

CLI::App* add_info_command(CLI::App& parent, InfoOptions& options) {
  CLI::App* command = parent.add_subcommand(
      "info",
      "Show what a recording (MCAP, ROS 1 bag, rosbag2 file or folder) contains: topics, rates, gaps, losses, damage");
  command->add_option("file", options.file, "Recording, or a folder with one")->required();
  command->add_flag("--json", options.json, "Print JSON instead of text");
  command->add_flag("--check", options.check,
                    "Read everything and compare all checksums (always done for files up to 64 MB)");
  return command;
}

std::optional<RecordingReport> report_on_other_format(const std::filesystem::path& file) {
  const Form form = form_of(file);
  if (form != Form::kBag && form != Form::kDb3) return std::nullopt;
  const std::unique_ptr<Reader> recording = open_reader(file, form);
  RecordingReport report;
  report.format = form == Form::kBag ? "ROS 1 bag" : "rosbag2 sqlite3";
  report.file_bytes = std::filesystem::file_size(file);
  report.read_all = true;
  std::map<std::string, ChannelReport> channels;
  std::map<std::string, std::vector<mcap::Timestamp>> times_ns;
  std::vector<std::string> names;
  for (const RecordedTopic& topic : recording->topics()) {
    ChannelReport& channel = channels[topic.name];
    channel.channel.topic = topic.name;
    channel.type = topic.type;
    channel.payload_bytes = 0;
    names.push_back(topic.name);
  }
  recording->play(names);
  while (const std::optional<RecordedMessage> message = recording->next()) {
    times_ns[message->topic].push_back(static_cast<mcap::Timestamp>(std::max<std::int64_t>(0, message->recorded_ns)));
    *channels.at(message->topic).payload_bytes += message->bytes.size();
  }
  for (auto& [topic, channel] : channels) {
    channel.timing = timing_of(std::move(times_ns[topic]));
    report.channels.push_back(std::move(channel));
  }
  report.count_messages();
  for (const std::string& damage : recording->take_damages()) report.add_damage(damage);
  return report;
}

int run_info(const InfoOptions& options, std::ostream& out, std::ostream& err) {
  return service::report_errors<mcap::RecordingFileError>("rtd info", err, [&] {
    const auto print_report = [&](const RecordingReport& report) {
      out << (options.json ? service::json_text(to_json(report, options.file)) + '\n' : to_text(report, options.file));
      return report.damaged() ? service::kPartialLoss : service::kOk;
    };
    if (const auto other_format = report_on_other_format(options.file)) return print_report(*other_format);
    const Opened opened = open_showing(options.file, err);
    const io::FileSource& source = *opened.source;
    service::Progress progress(err, "reading", source.size());
    ReportOptions how;
    how.check = options.check;
    how.on_progress = [&](std::uint64_t bytes) { progress.reach(bytes); };
    RecordingReport report = report_on(source, how);
    report.being_written = source.being_written();
    if (!opened.imported.empty()) {
      report.format = opened.imported;
      report.file_bytes = size_of(options.file);
    }
    for (const std::string& damage : opened.damages) report.add_damage(damage);
    return print_report(report);
  });
}

}  // namespace rtd::recordings
