// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/viewer/viewer_service.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spawn.h>
#include <sys/random.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <iostream>
#include <set>
#include <utility>

#include "common/io/atomic_file.hpp"
#include "common/service/log.hpp"
#include "common/service/metric_names.hpp"
#include "common/service/monotonic_clock.hpp"
#include "services/viewer/core/page_messages.hpp"
#include "services/viewer/settings.hpp"

namespace rtd::viewer {
namespace {

std::string variable(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

/// In a session of its own: the browser outlives the viewer, and Ctrl-C is not for it.
bool start_detached(const char* program, std::string argument) {
  posix_spawnattr_t attributes;
  posix_spawn_file_actions_t files;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSID);
  posix_spawn_file_actions_init(&files);
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    posix_spawn_file_actions_addopen(&files, descriptor, "/dev/null", O_RDWR, 0);
  std::string name = program;
  const std::array<char*, 3> arguments{name.data(), argument.data(), nullptr};
  pid_t process = 0;
  const bool started = posix_spawnp(&process, program, &files, &attributes, arguments.data(), environ) == 0;
  posix_spawn_file_actions_destroy(&files);
  posix_spawnattr_destroy(&attributes);
  return started;
}

/// Opens an address with xdg-open. False where no desktop of this user is at hand: no display, a login over SSH, no
/// xdg-open. The address, with its token, is in a file in the user's own run-time folder and not on a command
/// line, which all users can read.
bool open_in_browser(const std::string& address) {
  const std::string folder = variable("XDG_RUNTIME_DIR");
  const bool display = !variable("DISPLAY").empty() || !variable("WAYLAND_DISPLAY").empty();
  if (folder.empty() || !display || !variable("SSH_CONNECTION").empty()) return false;
  const std::string file = folder + "/rtd-viewer.html";
  try {
    io::write_file(file, fmt::format("<!doctype html><meta http-equiv=refresh content=\"0; url={}\">\n", address));
  } catch (const io::IoError&) {
    return false;
  }
  return start_detached("xdg-open", file);
}

using service::ConfigError;

constexpr std::chrono::milliseconds kTick{8}, kIdleTick{40};  // with and without clients
constexpr std::int64_t kRefreshPeriodNs = 500'000'000;

std::string random_text() {
  std::array<unsigned char, 16> bytes{};
  if (getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
    throw ConfigError("no random numbers for a token: give one with --token");
  return fmt::format("{:02x}", fmt::join(bytes, ""));
}

/// On loopback any program and, through a browser, many a page can connect: without a token of the operator's own they
/// may look. On other interfaces every client must know the token.
bool look_freely(const ServiceConfig& config) {
  return config.token.empty() && is_loopback(config.bind_address);
}

/// None where every client may look and none may do more.
std::string token_of(const ServiceConfig& config) {
  const bool nothing_to_do = config.read_only && !config.publish;
  if (!config.token.empty() || (look_freely(config) && nothing_to_do)) return config.token;
  return random_text();
}

WebOptions web_options(const ServiceConfig& config, const std::string& token, const std::string& look_token) {
  WebOptions options;
  options.address = config.bind_address;
  options.port = static_cast<std::uint16_t>(config.port);
  options.access = {.hosts = config.hosts,
                    .origins = config.origins,
                    .token = token,
                    .look_token = look_token,
                    .look_freely = look_freely(config)};
  if (is_loopback(config.bind_address) && options.access.hosts.empty()) options.access.hosts = {"localhost"};
  if (config.publish) options.longest_message_bytes = 16U << 20U;
  return options;
}

PageLimits page_limits(const ServiceConfig& config) {
  PageLimits limits;
  limits.bytes_per_s = 1e3 * config.max_kbps;
  limits.view_bytes_per_s = 0.7 * limits.bytes_per_s;
  limits.burst_bytes = 2 * limits.bytes_per_s;
  limits.views_per_s = config.image_hz;
  return limits;
}

bus::BusOptions raw_options(const service::Runtime& runtime) {
  bus::BusOptions options = runtime.bus_options;
  options.participant_name = "rtd-viewer-topics";
  return options;
}

std::uint64_t to_ns(double seconds) {
  constexpr double kMost_s = 4e9;
  return static_cast<std::uint64_t>(1e9 * std::max(0.0, std::min(kMost_s, seconds)));
}

/// For Foxglove clients; none when a camera has taken over.
std::optional<Played> played(const page::Playback& playback) {
  if (playback.replaced) return std::nullopt;
  const std::uint64_t begin_ns = to_ns(playback.begin_s);
  return Played{.begin_ns = begin_ns,
                .end_ns = begin_ns + to_ns(playback.length_s),
                .position_ns = begin_ns + to_ns(playback.position_s),
                .speed = playback.speed,
                .paused = playback.paused,
                .ended = playback.ended,
                .at_ns = static_cast<std::int64_t>(to_ns(playback.at_s))};
}

/// Seconds from the beginning, within the recording.
std::string seek_argument(const Played& played, std::uint64_t to_ns) {
  const std::uint64_t offset_ns = std::clamp(to_ns, played.begin_ns, played.end_ns) - played.begin_ns;
  return fmt::format("{:.6f}", 1e-9 * static_cast<double>(offset_ns));
}

}  // namespace

void ViewerService::add_options(CLI::App& app, std::vector<service::GivenOption>&) {
  app.footer("Open the printed address in a browser, or ws://HOST:PORT in Foxglove (docs/viewer.md).");
}

ViewerService::ViewerService(const Config& config, service::Runtime& runtime)
    : config_(config),
      runtime_(runtime),
      token_(token_of(config)),
      look_token_(look_freely(config) ? "" : random_text()),
      site_(RTD_THREE_DIR),
      foxglove_("RTD-SLAM " RTD_VERSION, random_text(),
                {{"vendor", runtime.bus.vendor()}, {"domain", std::to_string(runtime.bus_options.domain)}},
                foxglove_hooks()),
      page_({.version = RTD_VERSION,
             .vendor = runtime.bus.vendor(),
             .domain = runtime.bus_options.domain,
             .control = !config.read_only,
             .look_token = look_token_},
            page_limits(config),
            {.on_call =
                 [this](const std::string& robot, const std::string& name, const std::string& argument, auto answer) {
                   call(robot.empty() ? name : '/' + robot + name, argument, std::move(answer));
                 },
             .now_ms = wall_clock_ms}) {
  try {
    server_ = WebServer::listen(
        web_options(config_, token_, look_token_), site_,
        [this](const std::string& subprotocol, Rights rights) { return open(subprotocol, rights); }, reports());
  } catch (const WebError& error) {
    throw ConfigError(error.what());
  }
  if (!site_.has_three())
    SPDLOG_WARN("event=no_three cause=\"{} has no three.js\" fix=\"apt-get install libjs-three\"", RTD_THREE_DIR);
  dispatcher_.emplace([this](Dispatcher::Task task) { server_->post(std::move(task)); });
  raw_ = bus::connect_raw(raw_options(runtime_));
  topics_.emplace(*raw_, foxglove_, *dispatcher_, config_.topics, [this] { robots_changed_ = true; });
  if (!config_.read_only) commands_.emplace(runtime_.bus_options, *dispatcher_);
  read_atlas();
}

/// What the bus's threads have posted runs before the server ends, so the feeds are there until then.
ViewerService::~ViewerService() {
  commands_.reset();
  atlas_ = {};
  robots_.clear();
  topics_->stop();
  server_.reset();
}

FoxgloveHooks ViewerService::foxglove_hooks() {
  FoxgloveHooks hooks;
  hooks.realtime_ns = service::realtime_ns;
  hooks.on_wanted = [this](std::uint32_t channel, bool wanted) { topics_->want(channel, wanted); };
  if (!config_.read_only) {
    hooks.on_call = [this](const CommandInfo& command, const std::string& argument, auto answer) {
      call(command.name, argument, std::move(answer));
    };
    hooks.on_set = [this](const foxglove::Parameter& parameter, auto answer) {
      const auto setting = call_for(parameter);
      if (!setting) return answer({false, "it does not exist, or does not take this kind of value"});
      call(setting->command, setting->argument, std::move(answer));
    };
    hooks.on_playback = [this](const foxglove::PlaybackControl& control, auto answer) {
      control_playback(control, std::move(answer));
    };
  }
  if (config_.publish)
    hooks.on_publish = [this](const std::string& topic, const std::string& schema, std::span<const std::byte> cdr) {
      return topics_->publish(topic, schema, cdr);
    };
  return hooks;
}

std::unique_ptr<Session> ViewerService::open(const std::string& subprotocol, Rights rights) {
  return subprotocol == page::kSubprotocol ? page_.open(rights) : foxglove_.open(subprotocol, rights);
}

Reports ViewerService::reports() const {
  return {{"/metrics",
           [this] {
             return Report{metrics_text(watched_services()), "text/plain; version=0.0.4; charset=utf-8"};
           }},
          {"/healthz", [this] {
             Health health = health_of(watched_services());
             return Report{std::move(health.json), "application/json", health.well};
           }}};
}

std::vector<WatchedService> ViewerService::watched_services() const {
  std::vector<WatchedService> all;
  for (const auto& [name, feed] : robots_)
    for (page::ServiceLine& line : feed->mirror().services(service::monotonic_ns()))
      all.push_back({name, std::move(line)});
  return all;
}

/// Where the robots of a building are; in a keystore without an atlas it may not be read.
void ViewerService::read_atlas() {
  try {
    atlas_ = runtime_.bus.reader(bus::topics::kAtlas, [this](std::shared_ptr<const msg::AtlasState> state) {
      std::string text = page::atlas(*state);
      const std::size_t bytes = text.size();
      dispatcher_->deliver([this, text = std::move(text)] { page_.set_atlas(text); }, bytes);
    });
  } catch (const bus::BusError& error) {
    SPDLOG_WARN("event=not_read topic={} cause=\"{}\"", bus::topics::kAtlas.name, error.what());
  }
}

/// The robot that was asked for, or every one that has topics.
void ViewerService::find_robots() {
  if (!std::exchange(robots_changed_, false)) return;
  const std::string own = runtime_.bus.robot();
  const std::set<std::string> names = own.empty() ? shown_robots(topics_->topics()) : std::set{own};
  for (const std::string& name : names) {
    if (robots_.contains(name)) continue;
    RobotMirror* mirror = page_.robot(name);
    if (mirror == nullptr) continue;
    robots_.emplace(name, std::make_unique<RobotFeed>(runtime_.bus.of_robot(name), *mirror, *dispatcher_));
  }
}

void ViewerService::apply_options() {
  const std::int64_t now_ns = service::monotonic_ns();
  for (auto& [name, feed] : robots_) {
    const RobotMirror& mirror = feed->mirror();
    feed->set_options(page_.options(mirror.index()).value_or(PageOptions::for_later(now_ns, mirror.has_image())));
  }
}

void ViewerService::refresh(std::int64_t now) {
  if (now - refreshed_ns_ < kRefreshPeriodNs) return;
  refreshed_ns_ = now;
  if (page_.clients() > 0)
    for (auto& [name, feed] : robots_) feed->mirror().refresh(now);
  refresh_commands();
  refresh_playback();
  if (foxglove_.clients() > 0) topics_->update_graph();
  foxglove_.send_time();
  report();
}

void ViewerService::call(const std::string& name, const std::string& argument, CommandQueue::Answer answer) {
  if (!commands_) return answer({false, "this viewer was started with --read-only"});
  commands_->call(name, argument, std::move(answer));
}

/// One call after the other, pausing first so that a position that is sought stays; the answer comes with the last
/// one's.
void ViewerService::control_playback(const foxglove::PlaybackControl& control, CommandQueue::Answer answer) {
  const auto& played = foxglove_.played();
  std::vector<std::pair<const char*, std::string>> calls;
  if (control.pause) calls.emplace_back("/replay/pause", "true");
  if (control.seek_ns) calls.emplace_back("/replay/seek", seek_argument(*played, *control.seek_ns));
  if (control.speed != played->shown_speed()) calls.emplace_back("/replay/speed", fmt::format("{}", control.speed));
  if (!control.pause) calls.emplace_back("/replay/pause", "false");
  const std::string robot = runtime_.bus.robot().empty() ? "" : '/' + runtime_.bus.robot();
  const auto problem = std::make_shared<std::string>();
  for (std::size_t place = 0; place < calls.size(); ++place)
    call(robot + calls[place].first, calls[place].second,
         [problem, answer, last = place + 1 == calls.size()](const CommandResult& result) {
           if (!result.success && problem->empty()) *problem = result.message;
           if (last) answer({problem->empty(), *problem});
         });
}

void ViewerService::refresh_commands() {
  if (!commands_) return;
  const std::vector<bus::FoundCommand> found = commands_->commands();
  std::vector<CommandInfo> all;
  std::map<std::string, std::vector<CommandInfo>> by_robot;
  for (const bus::FoundCommand& command : found) {
    if (command.vendor.empty()) continue;  // not callable
    all.push_back({command.full_name(), command.kind});
    by_robot[command.robot].push_back({'/' + command.name, all.back().kind});
  }
  foxglove_.set_commands(all);
  for (auto& [name, feed] : robots_) feed->mirror().set_commands(by_robot[name]);
}

void ViewerService::refresh_playback() {
  std::vector<foxglove::Parameter> parameters;
  for (auto& [name, feed] : robots_) {
    const std::vector<page::ServiceLine> services = feed->mirror().services(service::monotonic_ns());
    const auto settings = settings_of(name, services);
    parameters.insert(parameters.end(), settings.begin(), settings.end());
    const auto playback = playback_of(services);
    if (playback) feed->mirror().set(Item::kPlayback, page::playback(feed->mirror().index(), *playback));
    if (name == runtime_.bus.robot()) foxglove_.set_played(playback ? played(*playback) : std::nullopt);
  }
  foxglove_.set_parameters(std::move(parameters));
}

void ViewerService::report() {
  const WebCounts counts = server_->counts();
  const auto clients = static_cast<double>(counts.clients);
  runtime_.heartbeat.set_state(counts.clients > 0 ? msg::ServiceState::kRunning : msg::ServiceState::kReady,
                               fmt::format("port {}, {} clients", server_->port(), counts.clients));
  runtime_.heartbeat.set_metric(service::metric::kClients, clients);
  const std::size_t ready = page_.ready() + foxglove_.clients();
  runtime_.heartbeat.set_metric(service::metric::kClientsReady, static_cast<double>(ready));
  runtime_.heartbeat.set_metric(service::metric::kSentMb, 1e-6 * static_cast<double>(counts.sent_bytes));
  runtime_.heartbeat.set_metric(service::metric::kRequests, static_cast<double>(counts.requests));
  runtime_.heartbeat.set_metric(service::metric::kRequestsRefused, static_cast<double>(counts.refused));
  runtime_.heartbeat.set_metric(service::metric::kClientsTooSlow, static_cast<double>(counts.closed_slow));
  std::uint64_t left_out = 0;
  for (const auto& [name, feed] : robots_) left_out += feed->mirror().map().left_out();
  runtime_.heartbeat.set_metric(service::metric::kMapItemsLeftOut, static_cast<double>(left_out));
  runtime_.heartbeat.set_metric(service::metric::kMessagesDropped,
                                static_cast<double>(dispatcher_->dropped() + foxglove_.dropped()));
}

void ViewerService::print_address() const {
  const bool any = config_.bind_address == "0.0.0.0" || config_.bind_address == "::";
  const std::string host = any ? service::host_name() : config_.bind_address;
  const std::string place =
      fmt::format("{}:{}", host.find(':') == std::string::npos ? host : '[' + host + ']', server_->port());
  const std::string token = token_.empty() ? "" : "?token=" + token_;
  const std::string page = fmt::format("http://{}/{}", place, token);
  std::cout << fmt::format("viewer: {}   Foxglove: ws://{}/{}\n", page, place, token) << std::flush;
  if (config_.open && !open_in_browser(page)) SPDLOG_DEBUG("event=no_browser cause=\"no desktop of this user\"");
  SPDLOG_INFO("event=listening address={} port={} token={} commands={}", config_.bind_address, server_->port(),
              token_.empty()         ? "none"
              : look_freely(config_) ? "for commands"
                                     : "asked",
              config_.read_only ? "off" : "on");
}

service::ExitCode ViewerService::run() {
  print_address();
  while (!runtime_.stop.stop_requested()) {
    server_->run_for(server_->counts().clients > 0 ? kTick : kIdleTick);
    runtime_.heartbeat.tick();
    find_robots();
    apply_options();
    refresh(service::monotonic_ns());
    server_->pump();
  }
  return service::kOk;
}

}  // namespace rtd::viewer
