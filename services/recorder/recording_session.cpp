// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/recorder/recording_session.hpp"

#include <fmt/chrono.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <ctime>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>

#include "common/bus/raw_bus.hpp"
#include "common/concurrency/thread_priority.hpp"
#include "common/io/atomic_file.hpp"
#include "common/io/named_files.hpp"
#include "common/io/printable.hpp"
#include "common/mcap/records.hpp"
#include "common/service/config.hpp"
#include "common/service/json_text.hpp"
#include "common/service/log.hpp"
#include "common/service/metric_names.hpp"
#include "common/service/monotonic_clock.hpp"
#include "services/recorder/core/recording.hpp"

namespace rtd::recorder {
namespace {

namespace fs = std::filesystem;
using service::ConfigError;

constexpr std::chrono::milliseconds kPatience{20};  // for a chunk's worth of messages
constexpr std::int64_t kReportPeriodNs = 200'000'000, kProgressPeriodNs = 1'000'000'000, kLogPeriodNs = 10'000'000'000;
constexpr std::uint64_t kMib = 1024 * 1024;

std::string output_of(const ServiceConfig& config) {
  return config.output.empty() ? dated_name() : config.output;
}

SplitPolicy split_of(const ServiceConfig& config) {
  if (config.split.empty()) return {};
  if (const auto policy = parse_split(config.split)) return *policy;
  throw ConfigError("--split " + config.split + ": give a size or a duration, e.g. 500MB, 1GB, 2GiB, 60s, 5min, 1h");
}

OutputFiles files_of(const ServiceConfig& config) {
  const std::string output = output_of(config);
  const bool split = split_of(config).on();
  return config.beside ? OutputFiles::free_beside(output, split) : OutputFiles(output, split);
}

RecordingOptions options_of(const ServiceConfig& config) {
  RecordingOptions options;
  options.compression = mcap::compression_of(config.compression == "none" ? "" : config.compression).value();
  options.chunk_bytes = static_cast<std::uint64_t>(config.chunk_kib) * 1024;
  options.chunk_age_ns = std::int64_t{config.chunk_ms} * 1'000'000;
  options.split = split_of(config);
  return options;
}

/// Makes room for the recording. Throws ConfigError when it cannot.
void prepare(const OutputFiles& files, bool force) {
  const auto earlier = files.existing();
  if (!earlier.empty() && !force) {
    throw ConfigError(earlier.front().string() +
                      " exists already: choose another name with -o, or replace it with --force");
  }
  for (const fs::path& file : earlier) {
    if (io::look_at(file, mcap::kMagic) == io::Found::kOther)
      throw ConfigError(file.string() + " exists and is not a recording, so it is not replaced: choose another name");
  }
  std::error_code error;
  fs::create_directories(files.folder(), error);
  if (error)
    throw ConfigError("folder " + files.folder().string() + ": " + error.message() + "; choose another with -o");
  // The sink replaces the first file: it notices when another recorder is writing it.
  for (const fs::path& file : earlier) {
    if (file != files.file(0)) fs::remove(file, error);
  }
}

nlohmann::json to_json(const RecordedTopic& topic) {
  return {{"name", topic.name},
          {"type", topic.type.name},
          {"definition", topic.type.encoding},
          {"messages", topic.counts.written},
          {"bytes", topic.counts.written_bytes},
          {"acknowledged", topic.counts.acknowledged},
          {"lost_in_transit", topic.counts.lost_in_transit},
          {"lost_in_queue", topic.counts.lost_in_queue}};
}

/// The losses, as metadata of the file.
mcap::Metadata loss_metadata(const std::vector<RecordedTopic>& topics) {
  mcap::Metadata record{"rtd:losses", {}};
  std::uint64_t total = 0;
  for (const RecordedTopic& topic : topics) {
    total += topic.counts.lost();
    if (topic.counts.lost() == 0) continue;
    record.metadata[topic.name] =
        fmt::format("in_transit={} in_queue={}", topic.counts.lost_in_transit, topic.counts.lost_in_queue);
  }
  record.metadata["total"] = std::to_string(total);
  return record;
}

void log_people(const std::map<std::string, std::uint64_t>& people) {
  SPDLOG_INFO("event=people_blurred images={} hidden={} withheld={}", people.at("blurred"), people.at("hidden"),
              people.at("withheld"));
  if (people.at("hidden") == 0) return;
  SPDLOG_WARN(
      "event=images_hidden images={} cause=\"no detections for them\" fix=\"record while the detector runs; "
      "it sees every image with --pace asap or lockstep\"",
      people.at("hidden"));
}

mcap::Metadata people_metadata(const PeopleBlur& people) {
  mcap::Metadata record{"rtd:people", {}};
  for (const auto& [fate, messages] : people.counts()) record.metadata[fate] = std::to_string(messages);
  return record;
}

std::string size_text(std::uint64_t bytes) {
  const double megabytes = static_cast<double>(bytes) * 1e-6;
  return megabytes < 10'000 ? fmt::format("{:.1f} MB", megabytes) : fmt::format("{:.1f} GB", megabytes * 1e-3);
}

}  // namespace

std::string dated_name() {
  return fmt::format("rtd_{:%Y_%m_%d-%H_%M_%S}", fmt::localtime(std::time(nullptr)));
}

RecordingSession::RecordingSession(const ServiceConfig& config, service::Runtime& runtime)
    : config_(config),
      runtime_(runtime),
      files_(files_of(config)),
      queue_(static_cast<std::uint64_t>(config.queue_mib) * kMib),
      interactive_(isatty(STDERR_FILENO) == 1) {
  prepare(files_, config_.force);
  if (config_.blur_people) blur_line_.emplace(book_);
  const auto open = [this](std::size_t number) { return open_sink(number); };
  sync_.emplace(std::chrono::milliseconds(config_.sync_pause_ms));
  try {
    recording_.emplace(options_of(config_), open, book_, *sync_);
  } catch (const io::IoError& error) {
    throw ConfigError(error.what());
  }
}

std::shared_ptr<io::ByteSink> RecordingSession::open_sink(std::size_t number) const {
  const auto if_exists = config_.force ? io::IfExists::kReplace : io::IfExists::kFail;
  auto sink = std::make_shared<io::FileSink>(files_.file(number), if_exists, io::Cached::kDrop);
  SPDLOG_INFO("event=file_begun path={}", files_.file(number).string());
  return sink;
}

void RecordingSession::listen(bus::RawBus& bus) {
  started_ns_ = progress_ns_ = service::monotonic_ns();
  readers_.emplace(bus, TopicFilter(config_.topics, runtime_.bus.robot()), config_.in_place, book_, queue_);
}

/// A write error of the disk ends the recording; what was written before stays.
bool RecordingSession::turn() {
  try {
    if (failure_.empty()) write_messages();
  } catch (const io::IoError& error) {
    failure_ = error.what();
  }
  return failure_.empty();
}

void RecordingSession::write_queued(bool ended) {
  while (auto message = queue_.pop()) {
    const std::int64_t now_ns = service::monotonic_ns();
    blur_line_ ? blur_line_->push(std::move(*message), now_ns) : recording_->write(*message, now_ns);
  }
  while (blur_line_) {
    const auto message = blur_line_->pop(service::monotonic_ns(), ended);
    if (!message) return;
    recording_->write(*message, service::monotonic_ns());
  }
}

void RecordingSession::write_messages() {
  queue_.wait_for(kPatience);
  write_queued(false);
  const std::int64_t now_ns = service::monotonic_ns();
  recording_->tick(now_ns);
  readers_->tick(now_ns);
  if (now_ns - reported_ns_ >= kReportPeriodNs) report_state(now_ns);
}

service::ExitCode RecordingSession::finish() {
  readers_->stop();
  try {
    write_rest();
  } catch (const io::IoError& error) {
    if (failure_.empty()) failure_ = error.what();
    SPDLOG_ERROR("event=file_without_summary cause=\"{}\" fix=\"rtd record recover {}\"", error.what(),
                 files_.file(recording_->files().size() - 1).string());
  }
  sync_->finish();
  if (failure_.empty()) failure_ = sync_->failure();
  return conclude();
}

void RecordingSession::write_rest() {
  queue_.close();
  write_queued(true);
  std::vector<mcap::Metadata> metadata{loss_metadata(book_.topics())};
  if (blur_line_) metadata.push_back(people_metadata(blur_line_->people()));
  recording_->finish(metadata);
}

std::string RecordingSession::path() const {
  return fs::absolute(files_.file(0)).lexically_normal().string();
}

void RecordingSession::report_state(std::int64_t now_ns) {
  reported_ns_ = now_ns;
  const Acknowledged acknowledged = sync_->acknowledged();
  book_.count_acknowledged(acknowledged.messages);
  const TopicCounts totals = book_.totals();
  publish_metrics(acknowledged, totals);
  set_state(totals);
  if (now_ns - progress_ns_ >= (interactive_ ? kProgressPeriodNs : kLogPeriodNs)) show_progress(now_ns, totals);
  if (failure_.empty()) failure_ = sync_->failure();
  watch_disk();
}

void RecordingSession::publish_metrics(const Acknowledged& acknowledged, const TopicCounts& totals) {
  service::Heartbeat& heartbeat = runtime_.heartbeat;
  heartbeat.set_metric(service::metric::kMessages, static_cast<double>(totals.written));
  heartbeat.set_metric(service::metric::kBytes, static_cast<double>(recording_->bytes()));
  heartbeat.set_metric(service::metric::kLostInTransit, static_cast<double>(totals.lost_in_transit));
  heartbeat.set_metric(service::metric::kLostInQueue, static_cast<double>(totals.lost_in_queue));
  heartbeat.set_metric(service::metric::kQueueBytes, static_cast<double>(queue_.bytes()));
  heartbeat.set_metric(service::metric::kAcknowledged, static_cast<double>(totals.acknowledged));
  heartbeat.set_metric(service::metric::kAcknowledgedBytes, static_cast<double>(acknowledged.bytes));
  for (const RecordedTopic& topic : book_.topics()) {
    heartbeat.set_metric(service::metric::kAcknowledgedPrefix + topic.name,
                         static_cast<double>(topic.counts.acknowledged));
  }
}

void RecordingSession::set_state(const TopicCounts& totals) {
  if (totals.lost() > 0) {
    return runtime_.heartbeat.set_state(msg::ServiceState::kDegraded, fmt::format("{} messages lost", totals.lost()));
  }
  if (!readers_->settled()) return runtime_.heartbeat.set_state(msg::ServiceState::kStarting, "subscribing");
  if (!stepped_back_ && readers_->any()) {  // not earlier: a late subscriber misses the first messages
    concurrency::lower_process_priority(config_.niceness);
    stepped_back_ = true;
  }
  if (totals.written > 0) return runtime_.heartbeat.set_state(msg::ServiceState::kRunning);
  const bool any = readers_->any();
  if (!any && !waiting_logged_) {
    waiting_logged_ = true;
    SPDLOG_INFO("event=waiting cause=\"no topic matches {}\"", fmt::join(config_.topics, " "));
  }
  runtime_.heartbeat.set_state(msg::ServiceState::kReady, any ? "" : "no topic matches yet");
}

void RecordingSession::show_progress(std::int64_t now_ns, const TopicCounts& totals) {
  const std::uint64_t bytes = recording_->bytes();
  const double bytes_per_s =
      static_cast<double>(bytes - progress_bytes_) / (static_cast<double>(now_ns - progress_ns_) * 1e-9);
  const std::string text = fmt::format("recording {:.0f} s  {} messages  {}/s  {}  lost {}  free {}",
                                       static_cast<double>(now_ns - started_ns_) * 1e-9, totals.written,
                                       size_text(static_cast<std::uint64_t>(bytes_per_s)), size_text(bytes),
                                       totals.lost(), size_text(free_bytes_));
  progress_ns_ = now_ns;
  progress_bytes_ = bytes;
  if (interactive_) {
    io::rewrite_terminal_line(text);
  } else {
    SPDLOG_INFO("event=progress {}", text);
  }
}

/// Ends the recording while there is still room for the summary.
void RecordingSession::watch_disk() {
  std::error_code error;
  const fs::space_info space = fs::space(files_.folder(), error);
  if (error) return;
  free_bytes_ = space.available;
  const std::uint64_t least = static_cast<std::uint64_t>(config_.min_free_mib) * kMib;
  if (free_bytes_ < least && failure_.empty()) {
    failure_ = fmt::format("the disk is nearly full: {} MiB left, record.min_free_mib is {}", free_bytes_ / kMib,
                           config_.min_free_mib);
  }
}

/// Next to the files, unless another file has the name.
void RecordingSession::write_metadata(const std::string& text) const {
  if (files_.metadata().empty()) return;
  std::string cause = "it is not of this recording";
  try {
    if (files_.owns_metadata()) return io::write_file(files_.metadata(), text);
  } catch (const io::IoError& error) {
    cause = error.what();
  }
  SPDLOG_WARN(
      "event=metadata_not_written path={} cause=\"{}\" "
      "fix=\"give each recording its own folder: -o NAME without .mcap\"",
      files_.metadata().string(), cause);
}

nlohmann::json RecordingSession::report() const {
  auto files = nlohmann::json::array(), topics = nlohmann::json::array();
  for (const FileSummary& file : recording_->files())
    files.push_back(
        {{"name", files_.file(files.size()).filename().string()}, {"bytes", file.bytes}, {"messages", file.messages}});
  for (const RecordedTopic& topic : book_.topics()) topics.push_back(to_json(topic));
  const TopicCounts totals = book_.totals();
  return {{"folder", files_.folder().string()},
          {"duration_s", static_cast<double>(service::monotonic_ns() - started_ns_) * 1e-9},
          {"acknowledged_bytes", sync_->acknowledged().bytes},
          {"partial", is_partial(totals)},
          {"failure", failure_},
          {"messages", totals.written},
          {"lost", totals.lost()},
          {"bytes", recording_->bytes()},
          {"files", files},
          {"people", blur_line_ ? blur_line_->people().counts() : std::map<std::string, std::uint64_t>()},
          {"topics", topics}};
}

service::ExitCode RecordingSession::conclude() {
  book_.count_acknowledged(sync_->acknowledged().messages);
  const std::vector<FileSummary> files = recording_->files();
  const std::vector<RecordedTopic> topics = book_.topics();
  const TopicCounts totals = book_.totals();
  std::vector<std::string> names;
  for (std::size_t i = 0; i < files.size(); ++i) names.push_back(files_.file(i).filename());
  write_metadata(bag_metadata_text(names, files, topics));
  if (interactive_) io::rewrite_terminal_line("");
  for (const RecordedTopic& topic : topics) {
    SPDLOG_INFO("event=topic topic={} messages={} lost_in_transit={} lost_in_queue={}", topic.name,
                topic.counts.written, topic.counts.lost_in_transit, topic.counts.lost_in_queue);
  }
  if (blur_line_) log_people(blur_line_->people().counts());
  if (!failure_.empty()) SPDLOG_ERROR("event=ended_early cause=\"{}\"", failure_);
  SPDLOG_INFO("event=summary files={} messages={} acknowledged={} bytes={} lost={}", files.size(), totals.written,
              totals.acknowledged, recording_->bytes(), totals.lost());
  if (config_.json) std::cout << service::json_text(report()) << '\n';
  return is_partial(totals) ? service::kPartialLoss : service::kOk;
}

}  // namespace rtd::recorder
