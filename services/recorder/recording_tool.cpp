// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>

#include "common/camera/open/source_factory.hpp"
#include "common/camera/source_schemes.hpp"
#include "common/io/printable.hpp"
#include "common/io/recording_forms.hpp"
#include "common/mcap/recording_file.hpp"
#include "common/service/command_line.hpp"
#include "common/service/json_text.hpp"
#include "services/recorder/copy_recording.hpp"
#include "services/recorder/inspect/inspect_commands.hpp"
#include "services/recorder/mcap_export.hpp"

namespace rtd::recordings {
namespace {

using camera::SkipReason;
using camera::SourceError;

/// The command line of `rtd convert`.
struct ConvertOptions {
  std::string source, destination;
  std::string compression = "zstd";  ///< of an MCAP file: none, lz4 or zstd
  std::uint64_t frames = 0;          ///< at most so many, 0 = all
  bool blur_people = false;
  bool json = false;
};

enum class Format { kTum, kMcap };

struct Destination {
  Format format{};
  std::string path;
};

Destination parse_destination(const std::string& text) {
  for (const auto& [scheme, format] : {std::pair{"tum:", Format::kTum}, std::pair{"mcap:", Format::kMcap}}) {
    if (text.starts_with(scheme)) return {format, text.substr(std::string_view(scheme).size())};
  }
  if (text.ends_with(io::kMcapExtension)) return {Format::kMcap, text};
  if (text.starts_with("bag:") || text.ends_with(io::kBagExtension)) {
    throw SourceError("destination '" + io::abridged(text) +
                      "': bags are read, not written; write FILE.mcap or tum:DIR");
  }
  return {Format::kTum, text};
}

/// Counts what the source once had and the result lacks.
std::uint64_t lost(const camera::SourceCounters& counters) {
  return counters.of(SkipReason::kColorUnreadable) + counters.of(SkipReason::kDepthUnreadable) +
         counters.of(SkipReason::kDepthNot16Bit) + counters.of(SkipReason::kSizeMismatch) +
         counters.of(SkipReason::kDamagedRecord) + counters.of(SkipReason::kMalformedLine);
}

std::uint64_t write(camera::FrameSource& source, const ConvertOptions& options, std::ostream& err) {
  const Destination destination = parse_destination(options.destination);
  const std::uint64_t expected = source.info().frames;
  const std::uint64_t total = options.frames == 0 ? expected : std::min(options.frames, expected);
  service::Progress progress(err, "frames", total);
  const camera::OnFrame on_frame = [&progress](std::uint64_t frames) { progress.reach(frames); };
  if (destination.format == Format::kTum) {
    return camera::export_tum(source, destination.path, options.frames, on_frame);
  }
  const auto compression = mcap::compression_of(options.compression == "none" ? "" : options.compression);
  return export_mcap(source, destination.path, compression.value(), options.frames, on_frame);
}

/// A recording that becomes an MCAP file whole: frames are not looked at.
bool copies_recording(const ConvertOptions& options, const std::string& uri) {
  const bool recording = camera::is_of_kind(uri, camera::SourceKind::kRecording);
  return recording && uri.find('?') == std::string::npos && options.frames == 0 &&
         parse_destination(options.destination).format == Format::kMcap;
}

/// Throws SourceError where nothing says where people are.
recorder::PeopleBlur people_of(const Opened& source, const ConvertOptions& options) {
  recorder::PeopleBlur people = people_in(source);
  if (people.knows_people()) return people;
  throw SourceError("--blur-people: " + options.source +
                    " has no detections (/detector/detections): it is unknown where people are in its images; "
                    "make a recording with them: rtd run --source " +
                    options.source + " --out DIR --record NEW.mcap --blur-people");
}

void print(const std::map<std::string, std::uint64_t>& people, std::ostream& out) {
  out << "people are pixelated in " << people.at("blurred") << " images; " << people.at("hidden")
      << " without detections are pixelated as a whole, " << people.at("withheld")
      << " messages that may show people and cannot be read are left out\n";
}

service::ExitCode copy(const ConvertOptions& options, const std::string& path, std::ostream& out, std::ostream& err) {
  const Destination destination = parse_destination(options.destination);
  const auto compression = mcap::compression_of(options.compression == "none" ? "" : options.compression);
  if (std::filesystem::exists(destination.path))
    throw SourceError(destination.path + " exists; name a new file or remove it");
  service::Progress opening(err, "opening", size_of(path));
  const Opened source = open(path, [&](std::uint64_t bytes) { opening.reach(bytes); });
  std::optional<recorder::PeopleBlur> people;
  if (options.blur_people) people = people_of(source, options);
  service::Progress progress(err, "bytes", source.source->size());
  const CopiedRecording copied =
      copy_recording(source, destination.path, compression.value(), people ? &*people : nullptr,
                     [&](std::uint64_t bytes) { progress.reach(bytes); });
  for (const std::string& damage : copied.damages) err << "rtd convert: " << damage << '\n';
  if (options.json) {
    out << service::json_text(nlohmann::json{{"source", options.source},
                                             {"destination", options.destination},
                                             {"messages", copied.messages},
                                             {"topics", copied.topics},
                                             {"from_ros1", copied.from_ros1},
                                             {"left_out", copied.left_out},
                                             {"people", copied.people},
                                             {"damages", copied.damages}})
        << '\n';
  } else {
    out << copied.messages << " messages of " << copied.topics << " topics written to " << options.destination;
    if (copied.from_ros1 > 0) out << ", " << copied.from_ros1 << " of them turned from ROS 1 into CDR";
    out << '\n';
    if (people) print(copied.people, out);
    for (const auto& [topic, cause] : copied.left_out) out << "left out: " << topic << ": " << cause << '\n';
  }
  return copied.damages.empty() && copied.left_out.empty() ? service::kOk : service::kPartialLoss;
}

nlohmann::json to_json(const ConvertOptions& options, std::uint64_t frames, const camera::SourceCounters& counters) {
  nlohmann::json left_out = nlohmann::json::object();
  for (std::size_t i = 0; i < camera::kSkipReasons; ++i) {
    if (counters.skipped[i] > 0) left_out[to_string(static_cast<SkipReason>(i))] = counters.skipped[i];
  }
  return {{"source", options.source},
          {"destination", options.destination},
          {"frames", frames},
          {"left_out", left_out},
          {"lost", lost(counters)}};
}

void print(const ConvertOptions& options, std::uint64_t frames, camera::FrameSource& source, std::ostream& out,
           std::ostream& err) {
  constexpr std::size_t kMaxLines = 10;
  const std::vector<camera::SkippedInput> skipped = source.take_skipped();
  for (std::size_t i = 0; i < std::min(kMaxLines, skipped.size()); ++i) {
    err << "rtd convert: left out (" << to_string(skipped[i].reason) << "): " << skipped[i].detail << '\n';
  }
  if (skipped.size() > kMaxLines) err << "rtd convert: ... and " << skipped.size() - kMaxLines << " more\n";
  if (options.json) {
    out << service::json_text(to_json(options, frames, source.counters())) << '\n';
  } else {
    out << frames << " frames written to " << options.destination << ", " << source.counters().skipped_total()
        << " pieces of the source left out\n";
  }
}

void add_convert_command(CLI::App& app, ConvertOptions& options) {
  CLI::App* command = app.add_subcommand(
      "convert", "Convert a recording with all its topics to MCAP, or the frames of any source to TUM or MCAP");
  command
      ->add_option(
          "source", options.source,
          "FILE.bag, FILE.db3, FILE.mcap, packed with zstd or a folder of rosbag2; tum:FOLDER or any other source")
      ->required();
  command->add_option("destination", options.destination, "New tum:FOLDER or FILE.mcap; nothing is overwritten")
      ->required();
  command->add_option("--frames", options.frames, "At most this many frames, 0 = all");
  command->add_option("--compress", options.compression, "Compression of MCAP chunks: none, lz4, zstd")
      ->check(CLI::IsMember({"none", "lz4", "zstd"}))
      ->capture_default_str();
  command->add_flag("--blur-people", options.blur_people,
                    "Pixelate people in images, by the detections in the recording; images without as a whole");
  command->add_flag("--json", options.json, "Print the summary as JSON");
  command->footer(
      "Exit codes: 0 done, 1 failed while converting, 2 nothing was written, 3 done but part of the source was "
      "damaged");
}

/// Writes a source as a TUM folder or an MCAP file. Returns the exit code: 3 when part of the source was damaged.
int run_convert(const ConvertOptions& options, std::ostream& out, std::ostream& err) {
  return service::report_errors<SourceError, mcap::RecordingFileError>("rtd convert", err, [&] {
    const std::string uri = camera::complete_uri(options.source);
    if (options.blur_people && !copies_recording(options, uri))
      throw SourceError(
          "--blur-people works on a recording that becomes an MCAP file whole: 'rtd convert "
          "RECORDING BLURRED.mcap --blur-people', then convert that");
    if (copies_recording(options, uri)) return copy(options, uri.substr(uri.find(':') + 1), out, err);
    const auto source = camera::make_source(uri);
    const std::uint64_t frames = write(*source, options, err);
    print(options, frames, *source, out, err);
    const std::vector<RecordedTopic> others = camera::auxiliary_topics(uri);
    for (const RecordedTopic& topic : others)
      err << "rtd convert: left out: " << topic.name << " (" << topic.type << ", " << topic.messages << " messages)\n";
    if (!others.empty())
      err << "rtd convert: only frames, and true poses that tf has, are written here; 'rtd convert " << options.source
          << " NEW.mcap' carries all topics\n";
    return lost(source->counters()) > 0 ? service::kPartialLoss : service::kOk;
  });
}

}  // namespace
}  // namespace rtd::recordings

/// rtd-recording: `rtd info`, `rtd diff` and `rtd convert`.
int main(int argc, char** argv) {
  using namespace rtd;
  recordings::InfoOptions info;
  recordings::DiffRequest diff;
  recordings::ConvertOptions convert;
  CLI::App app{"What recordings contain, how they differ, and their conversion", "rtd"};
  app.require_subcommand(1);
  recordings::add_info_command(app, info);
  recordings::add_diff_command(app, diff);
  recordings::add_convert_command(app, convert);
  return service::run_command(app, argc, argv, [&] {
    if (app.got_subcommand("info")) return recordings::run_info(info, std::cout, std::cerr);
    if (app.got_subcommand("diff")) return recordings::run_diff(diff, std::cout, std::cerr);
    return recordings::run_convert(convert, std::cout, std::cerr);
  });
}
