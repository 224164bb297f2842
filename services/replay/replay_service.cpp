// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/replay/replay_service.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/prctl.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <limits>

#include "common/bus/frame_topics.hpp"
#include "common/bus/robot.hpp"
#include "common/io/byte_sink.hpp"
#include "common/mcap/codec.hpp"
#include "common/mcap/recording_file.hpp"
#include "common/ros2/names.hpp"
#include "common/service/json_text.hpp"
#include "common/service/log.hpp"
#include "common/service/metric_names.hpp"
#include "common/service/monotonic_clock.hpp"
#include "common/service/pacer.hpp"
#include "services/replay/core/topic_choice.hpp"

namespace rtd::replay {
namespace {

using service::ConfigError;

constexpr std::int64_t kNsPerSecond = 1'000'000'000, kMetricsEveryNs = kNsPerSecond / 5;
constexpr std::chrono::milliseconds kLook{20};
constexpr std::chrono::milliseconds kSettle{200};    // a reader that has matched here may not have matched us yet
constexpr std::chrono::milliseconds kFarewell{300};  // time for the last heartbeats to arrive
constexpr int kLastAcknowledgementMs = 2000;
constexpr std::size_t kMostEvents = 4096;  // that wait for the player
constexpr char kTrackingTopic[] = "rtd/tracking";

std::int64_t to_ns(double seconds) {
  return static_cast<std::int64_t>(seconds * 1e9);
}

/// A time beyond the year 2262 is an error in the file.
std::int64_t signed_time(mcap::Timestamp time) {
  return static_cast<std::int64_t>(std::min<mcap::Timestamp>(time, std::numeric_limits<std::int64_t>::max()));
}

/// "/a (json), /b": the topics, and the encodings that are not CDR.
std::string text_of(const std::map<mcap::ChannelId, mcap::Channel>& channels) {
  if (channels.empty()) return "no topics";
  std::string text;
  for (const auto& [id, channel] : channels) {
    text += (text.empty() ? "" : ", ") + channel.topic;
    if (!is_cdr(channel)) text += " (" + encoding_of(channel) + ")";
  }
  return text;
}

/// How many paced messages may be without an answer; 0: messages go by time.
int window_of(const ServiceConfig& config, service::Pace pace) {
  if (pace == service::Pace::kAsap) return config.asap_window;
  return pace == service::Pace::kLockstep || !config.lockstep.empty() ? 1 : 0;
}

std::uint64_t seq_in(std::span<const std::byte> cdr) {
  constexpr std::size_t kSeqAt = 4;
  return cdr.size() >= kSeqAt + 8 ? io::load<std::uint64_t>(cdr.data() + kSeqAt) : 0;
}

}  // namespace

void ReplayService::add_options(CLI::App& app, std::vector<service::GivenOption>& given) {
  app.add_flag_function(
      "--asap",
      [&given](std::int64_t) {
        given.push_back({"replay.rate", "--asap", {"0"}});
      },
      "As fast as possible: --rate 0");
  app.get_option("--clock")->expected(0, 1)->default_str("40");
  app.footer(
      "Keys: space pauses, right arrow or s steps (paused), up and down arrow change the rate, b and f jump 10 s back "
      "and forward, q ends.\n'rtd replay --viewer' also shows it in the browser, waits for the first page and stays "
      "until Ctrl-C (--viewer=now, --viewer=exit, --set viewer.port=...).\nExit code: 0 "
      "done, 1 no answers (--lockstep), 2 the recording or an option cannot be "
      "used, 3 the recording is damaged and only its readable part was played");
}

ReplayService::ReplayService(const Config& config, service::Runtime& runtime)
    : config_(config),
      runtime_(runtime),
      window_(window_of(config, runtime.pace)),
      inbox_(std::make_shared<Inbox>(kMostEvents, concurrency::Overflow::kDropOldest)) {
  if (config_.file.empty()) throw ConfigError("name a recording: rtd replay FILE (replay.file)");
  if (window_ > 0 && config_.lockstep.empty()) config_.lockstep = kTrackingTopic;
  try {
    open();
  } catch (const mcap::RecordingFileError& error) {
    throw ConfigError(error.what());
  }
  runtime_.stop.on_stop([inbox = inbox_] { inbox->push(Command::kStop); });
}

void ReplayService::open() {
  recording_ = recordings::open(config_.file);
  if (!recording_.imported.empty())
    SPDLOG_INFO("event=recording_imported file={} as=\"{}\"", config_.file, recording_.imported);
  reader_ = std::make_unique<mcap::IndexedReader>(*recording_.source);
  for (const mcap::Problem& problem : reader_->problems().listed())
    if (problem.kind == mcap::ProblemKind::kNotMcap && problem.data_lost)
      throw ConfigError(config_.file + ": this is not an MCAP file; 'rtd info' says more");
  choose_topics();
  choose_span();
  bus::BusOptions options = runtime_.bus_options;
  options.participant_name = "rtd-replay-topics";
  bus_ = bus::connect_raw(options);
  const bool by_time = window_ == 0 && config_.rate > 0;
  outputs_ = std::make_unique<Outputs>(*bus_, channels_, reader_->summary(),
                                       OutputOptions{.remaps = parse_remaps(config_.remap),
                                                     .robot = runtime_.bus.robot(),
                                                     .restamp = config_.restamp,
                                                     .wait_for_readers = window_ == 0 && !by_time,
                                                     .frames_apart = by_time});
  // rtd run reads it before it starts in this domain.
  runtime_.heartbeat.set_metric(service::metric::kRunTopics,
                                static_cast<double>(std::ranges::count_if(
                                    outputs_->all(), [](const auto& output) { return is_run_topic(output.first); })));
  if (window_ > 0) choose_paced_topic();
  choose_step_ends();
}

void ReplayService::choose_topics() {
  std::vector<std::string> exclude = config_.exclude;
  if (!config_.lockstep.empty()) exclude.push_back(config_.lockstep);  // it would answer itself
  const TopicChoice choice(config_.topics, exclude);
  std::vector<std::string> known;
  for (const auto& [id, channel] : reader_->summary().channels) known.push_back(channel.topic);
  const std::string robot = recorded_robot(known);
  for (const auto& [id, channel] : reader_->summary().channels) {
    if (!choice.wants(channel.topic) || (!robot.empty() && !bus::concerns_robot(ros2::dds_topic(channel.topic), robot)))
      continue;
    if (is_cdr(channel)) {
      channels_.push_back(&channel);
    } else {
      left_out_.push_back(&channel);
    }
  }
  const std::string listed = text_of(reader_->summary().channels);
  if (const std::vector<std::string> unmet = choice.unmet(known); !unmet.empty())
    throw ConfigError(fmt::format("--topics {}: not in {}; it has {}", fmt::join(unmet, ", "), config_.file, listed));
  if (channels_.empty())
    throw ConfigError(fmt::format("{}: nothing to play{}; it has {}", config_.file,
                                  left_out_.empty() ? "" : ", for DDS carries only messages in CDR", listed));
  for (const mcap::Channel* channel : left_out_)
    SPDLOG_WARN(
        "event=channel_left_out topic={} channel={} encoding={} cause=\"DDS carries only messages in CDR\" "
        "fix=\"record it in ROS 2 or DDS, or use --exclude {}\"",
        channel->topic, channel->id, encoding_of(*channel), channel->topic);
}

/// Whose topics are played as those of --robot: of several robots, that of this name; "": all that were recorded.
std::string ReplayService::recorded_robot(const std::vector<std::string>& topics) const {
  const std::string& robot = runtime_.bus.robot();
  std::vector<std::string> names;
  for (const std::string& topic : topics) names.push_back(ros2::dds_topic(topic));
  const std::set<std::string> recorded = bus::robots_in(names);
  if (robot.empty() || recorded.size() < 2) return {};
  if (recorded.contains(robot)) return robot;
  throw ConfigError(fmt::format("--robot {}: {} has several robots, but not this one: choose {}", robot, config_.file,
                                fmt::join(recorded, " or ")));
}

void ReplayService::choose_span() {
  const mcap::Summary& summary = reader_->summary();
  if (!summary.statistics || summary.statistics->message_count == 0)
    throw ConfigError(config_.file + ": the recording has no messages");
  first_ns_ = signed_time(summary.statistics->message_start_time);
  const std::int64_t last_ns = signed_time(summary.statistics->message_end_time);
  start_ns_ = first_ns_ + to_ns(config_.start_offset_s);
  if (start_ns_ > last_ns)
    throw ConfigError(fmt::format("--start-offset {}: the recording is {:.3f} s long", config_.start_offset_s,
                                  static_cast<double>(last_ns - first_ns_) * 1e-9));
  end_ns_ = config_.duration_s > 0 ? std::min(last_ns, start_ns_ + to_ns(config_.duration_s)) : last_ns;
}

void ReplayService::choose_paced_topic() {
  std::vector<std::string> candidates;
  if (config_.paced_topic.empty()) {
    for (const bus::FrameTopic& topic : bus::frame_topics()) candidates.emplace_back(topic.name);
    candidates.emplace_back(bus::topics::kFeatures.name);
  } else {
    candidates.push_back(ros2::dds_topic(config_.paced_topic));
  }
  for (const std::string& candidate : candidates)
    for (const auto& [name, output] : outputs_->all())
      if (paced_ == nullptr && (name == candidate || bus::split_robot(name).topic == candidate)) paced_ = &output;
  if (paced_ == nullptr)
    throw ConfigError(
        fmt::format("--lockstep {}: {} is not among the topics that are played; name one with --paced-topic",
                    config_.lockstep, fmt::join(candidates, " or ")));
}

/// A step goes to the next raw frame; without these to the next features, or image, or message of any topic.
void ReplayService::choose_step_ends() {
  const auto take = [this](const auto& wanted) {
    if (!step_ends_.empty()) return;
    for (const mcap::Channel* channel : channels_) {
      const bus::RawTopic& topic = outputs_->of(channel->id).topic;
      if (wanted(bus::split_robot(topic.name).topic, topic.type)) step_ends_.insert(channel->id);
    }
  };
  using Text = const std::string&;
  take([](Text topic, Text) {
    return std::ranges::any_of(bus::frame_topics(), [&](const bus::FrameTopic& frame) { return topic == frame.name; });
  });
  take([](Text topic, Text) { return topic == bus::topics::kFeatures.name; });
  take([](Text, Text type) { return type.starts_with("sensor_msgs::") && type.ends_with("Image_"); });
  take([](Text, Text) { return true; });
}

service::ExitCode ReplayService::run() {
  prctl(PR_SET_TIMERSLACK, 1000UL);  // ns; 50 us by default
  SPDLOG_INFO("event=recording_opened file={} topics={} messages={} duration_s={:.3f} summary={}", config_.file,
              channels_.size(), reader_->summary().statistics->message_count,
              static_cast<double>(end_ns_ - start_ns_) * 1e-9, !reader_->summary().scanned);
  if (recording_.source->being_written())
    SPDLOG_WARN("event=being_written cause=\"only what is in the file now is played\"");
  for (const std::string& service : config_.stand_in) {
    stand_ins_.push_back(std::make_unique<service::Heartbeat>(runtime_.bus, service, runtime_.stop));
    stand_ins_.back()->set_state(msg::ServiceState::kRunning, "played by rtd-replay");
  }
  // Slam is ready only when its answers have a subscriber.
  if (!subscribe_to_answers() || !wait_for_services() || !wait_for_page() || !wait_for_readers())
    return runtime_.stop.stop_requested() ? service::kOk : service::kRunFailed;
  runtime_.heartbeat.set_state(msg::ServiceState::kRunning);
  commands_ = std::make_unique<ReplayCommands>(runtime_.bus, RecordedSpan{first_ns_, start_ns_, end_ns_},
                                               [inbox = inbox_](Request request) { inbox->push(std::move(request)); });
  return play();
}

bool ReplayService::wait_for_services() {
  const std::int64_t deadline_ns = now_ns() + to_ns(config_.start_timeout_s);
  while (true) {
    std::vector<std::string> absent;
    for (const std::string& name : config_.wait_for)
      if (name != "none" && !runtime_.heartbeat.ready(name)) absent.push_back(name);
    if (absent.empty()) return true;
    if (now_ns() > deadline_ns) {
      fail(fmt::format("not ready within {:g} s: {}; start them, or leave them out with --wait-for",
                       config_.start_timeout_s, fmt::join(absent, ", ")));
      return false;
    }
    runtime_.heartbeat.set_state(msg::ServiceState::kReady, fmt::format("waits for {}", fmt::join(absent, ", ")));
    if (runtime_.stop.wait_for(kLook)) return false;
  }
}

bool ReplayService::wait_for_page() {
  const auto is_open = [this] {
    return runtime_.heartbeat.metric_on_this_host("viewer", service::metric::kClientsReady).value_or(0) > 0;
  };
  if (!config_.wait_page || is_open()) return true;
  SPDLOG_INFO("event=waits_for_page fix=\"open the viewer's address, or --viewer=now\"");
  runtime_.heartbeat.set_state(msg::ServiceState::kReady, "waits until a page is open");
  while (!is_open())
    if (runtime_.stop.wait_for(kLook)) return false;
  return true;
}

/// Of the robot whose frames are played.
std::string ReplayService::answers_topic() const {
  const bus::RobotTopic named = bus::split_robot(ros2::dds_topic(config_.lockstep));
  return named.robot.empty() ? bus::topic_of_robot(named.topic, bus::split_robot(paced_->topic.name).robot)
                             : ros2::dds_topic(config_.lockstep);
}

bool ReplayService::subscribe_to_answers() {
  if (window_ == 0) return true;
  const std::string topic = answers_topic();
  const std::int64_t deadline_ns = now_ns() + to_ns(config_.start_timeout_s);
  while (now_ns() <= deadline_ns) {
    for (const bus::TopicWriter& writer : bus_->writers()) {
      if (writer.own || writer.topic.name != topic) continue;
      bus::RawHandlers handlers;
      const bool numbered = paced_->carries_seq && writer.topic.type == "rtd_msgs::msg::dds_::TrackingResult_";
      handlers.on_sample = [inbox = inbox_, numbered](const bus::RawSample& sample) {
        inbox->push(Answer{numbered ? std::optional(seq_in(sample.cdr())) : std::nullopt});
      };
      answers_ = bus_->reader(writer.topic, {.reliable = writer.qos.reliable}, std::move(handlers));
      return true;
    }
    if (runtime_.stop.wait_for(kLook)) return false;
  }
  fail(fmt::format("{} has no publisher after {:g} s: start the service that answers, or leave out --lockstep", topic,
                   config_.start_timeout_s));
  return false;
}

/// A volatile topic reaches only readers that are already there, so reliable topics wait a moment for theirs.
bool ReplayService::wait_for_readers() {
  const std::int64_t deadline_ns = now_ns() + to_ns(config_.wait_readers_s);
  while ((!outputs_->unread().empty() || (answers_ && answers_->matched() == 0)) && now_ns() < deadline_ns)
    if (runtime_.stop.wait_for(kLook)) return false;
  const std::vector<std::string> unread = outputs_->unread();
  if (!unread.empty())
    SPDLOG_INFO("event=without_readers topics={} waited_s={:g}", fmt::join(unread, ","), config_.wait_readers_s);
  return !runtime_.stop.wait_for(kSettle);
}

service::ExitCode ReplayService::play() {
  line_ = std::make_unique<StatusLine>(start_ns_, end_ns_);
  const Keyboard keyboard([inbox = inbox_](Command command) { inbox->push(command); });
  std::set<mcap::ChannelId> wanted;
  for (const mcap::Channel* channel : channels_) wanted.insert(channel->id);
  MessageFeed feed(*reader_,
                   {.read_ahead_bytes = static_cast<std::uint64_t>(config_.read_ahead_mb) * 1'000'000,
                    .start_ns = start_ns_,
                    .end_ns = end_ns_,
                    .wanted = [wanted](const mcap::Channel& channel) { return wanted.contains(channel.id); }});
  PlayerOptions options{.rate = config_.rate,
                        .paused = config_.pause,
                        .loop = config_.loop,
                        .hold = config_.hold,
                        .start_ns = start_ns_,
                        .end_ns = end_ns_};
  options.pacer.window = window_;
  options.pacer.resend_after_ns = std::int64_t{config_.resend_after_ms} * 1'000'000;
  options.pacer.result_timeout_ns = to_ns(config_.result_timeout_s);
  if (config_.clock_hz > 0) options.clock_period_ns = to_ns(1 / config_.clock_hz);
  Player player(feed, *this, options);
  const PlayOutcome outcome = player.run();
  inbox_->close();
  while (inbox_->pop()) {  // who still waits for an answer does so in vain
  }
  line_.reset();
  return finish(player, outcome);
}

service::ExitCode ReplayService::finish(const Player& player, PlayOutcome outcome) {
  outputs_->finish();
  if (outcome == PlayOutcome::kEnded) outputs_->wait_acknowledged(kLastAcknowledgementMs);
  const nlohmann::ordered_json report = report_of(player, *outputs_, config_.file, outcome, reader_->problems());
  SPDLOG_INFO("event=summary {}", log_text(report));
  if (config_.json) std::cout << service::json_text(report) << std::endl;
  for (const mcap::Problem& problem : reader_->problems().listed()) {
    if (!mcap::is_damage(problem)) continue;
    SPDLOG_WARN("event=recording_damaged kind={} cause=\"{}\"", mcap::name_of(problem.kind), mcap::to_string(problem));
  }
  for (const std::string& damage : recording_.damages) {
    SPDLOG_WARN("event=recording_damaged kind=damaged_record cause=\"{}\"", damage);
  }
  if (outcome == PlayOutcome::kUnanswered)
    return fail(fmt::format("no message of {} for number {} of {} within {:g} s: are its publishers alive?",
                            config_.lockstep, player.unanswered_seq(), paced_->topic.name, config_.result_timeout_s));
  runtime_.heartbeat.set_state(msg::ServiceState::kFinished);
  if (outcome == PlayOutcome::kEnded) runtime_.stop.wait_for(kFarewell);
  return reader_->problems().data_lost() || !recording_.damages.empty() ? service::kPartialLoss : service::kOk;
}

service::ExitCode ReplayService::fail(const std::string& message) {
  SPDLOG_ERROR("event=failed cause=\"{}\"", message);
  runtime_.heartbeat.set_state(msg::ServiceState::kFailed, message);
  return service::kRunFailed;
}

std::int64_t ReplayService::now_ns() {
  return service::monotonic_ns();
}

std::optional<std::uint64_t> ReplayService::paced_seq(const PlayedMessage& message) {
  if (paced_ == nullptr || &outputs_->of(message.channel) != paced_) return std::nullopt;
  return paced_->carries_seq ? seq_in(*message.cdr) : static_cast<std::uint64_t>(message.log_ns);
}

void ReplayService::show(const PlayState& state) {
  const std::int64_t time_ns = now_ns();
  if (line_) line_->show(state, time_ns);
  const std::pair set{state.paused, state.rate};
  if (time_ns < next_metrics_ns_ && set == shown_) return;
  next_metrics_ns_ = time_ns + kMetricsEveryNs;
  shown_ = set;
  service::Heartbeat& heartbeat = runtime_.heartbeat;
  heartbeat.set_metric(service::metric::kMessagesSent, static_cast<double>(state.sent));
  heartbeat.set_metric(service::metric::kReplayBeginS, static_cast<double>(first_ns_) * 1e-9);
  heartbeat.set_metric(service::metric::kReplayAtS, static_cast<double>(service::realtime_ns()) * 1e-9);
  heartbeat.set_metric(service::metric::kReplayPositionS, static_cast<double>(state.recorded_ns - first_ns_) * 1e-9);
  heartbeat.set_metric(service::metric::kReplayLengthS, static_cast<double>(end_ns_ - first_ns_) * 1e-9);
  heartbeat.set_metric(service::metric::kReplaySpeed, state.rate);
  heartbeat.set_metric(service::metric::kReplayPaused, state.paused ? 1 : 0);
}

}  // namespace rtd::replay
