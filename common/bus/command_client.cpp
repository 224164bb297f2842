// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "common/bus/command_codec.hpp"
#include "common/bus/commands.hpp"
#include "common/bus/port_check.hpp"
#include "common/bus/raw_bus.hpp"
#include "common/bus/robot.hpp"
#include "common/io/text.hpp"

namespace rtd::bus {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using Cause = CommandError::Cause;

constexpr auto kMoment = 5ms;
/// By then every server of the domain has been found.
constexpr auto kDiscovery = 2s;
/// From matching the server here to being matched there: DDS notifies each side for itself.
constexpr auto kSettling = 100ms;

/// The vendor of an endpoint by its GUID (RTPS 2.2, 9.3.1.5), by the names of available_vendors(). Security makes GUIDs
/// of certificates, but there all are of one vendor.
std::string vendor_of(const WriterId& id, const BusOptions& options) {
  if (options.vendor == kInprocess || options.security.enabled()) return options.vendor;
  if (id[0] != 0x01) return {};
  return id[1] == 0x0f ? "fastdds" : id[1] == 0x10 ? "cyclonedds" : "";
}

std::string seconds(int timeout_ms) {
  std::string text = std::to_string(timeout_ms / 100);
  if (text.size() == 1) text.insert(text.begin(), '0');
  return text.insert(text.size() - 1, 1, '.') + " s";
}

/// The calls of one client to one service.
class CallChannel {
 public:
  CallChannel(std::shared_ptr<RawBus> bus, const CallTopics& topics)
      : bus_(std::move(bus)),
        calls_(bus_->create_calls(topics, CallRole::kClient,
                                  [this](const CallId& id, std::span<const std::byte> cdr) { take_reply(id, cdr); })) {}

  bool is_connected() const { return calls_->matched_readers() > 0 && calls_->matched_writers() > 0; }

  /// Waits until the server is connected; false when it is not by then.
  bool connect(Clock::time_point deadline) {
    const std::lock_guard lock(connecting_);
    while (!is_connected() && Clock::now() < deadline) std::this_thread::sleep_for(kMoment);
    if (!is_connected()) return false;
    if (!std::exchange(settled_, true) && bus_->vendor() != kInprocess) std::this_thread::sleep_for(kSettling);
    return true;
  }

  enum class Outcome { kAnswered, kTimeout, kServerGone };
  /// The reply's bytes, for kAnswered.
  std::pair<Outcome, std::vector<std::byte>> call(std::span<const std::byte> request, Clock::time_point deadline) {
    std::unique_lock lock(mutex_);
    const std::optional<CallId> id = calls_->request(request);
    if (!id) throw BusError("the bus (" + bus_->vendor() + ") did not take the request");
    std::optional<std::vector<std::byte>>& reply = replies_[*id];
    while (!reply && is_connected() && Clock::now() < deadline) {
      changed_.wait_until(lock, std::min(deadline, Clock::now() + 100ms), [&reply] { return reply.has_value(); });
    }
    const auto taken = replies_.extract(*id);
    if (taken.mapped()) return {Outcome::kAnswered, *taken.mapped()};
    return {is_connected() ? Outcome::kTimeout : Outcome::kServerGone, {}};
  }

 private:
  void take_reply(const CallId& id, std::span<const std::byte> cdr) {
    const std::lock_guard lock(mutex_);
    if (const auto waits = replies_.find(id); waits != replies_.end()) waits->second.emplace(cdr.begin(), cdr.end());
    changed_.notify_all();
  }

  const std::shared_ptr<RawBus> bus_;
  std::mutex connecting_, mutex_;
  bool settled_ = false;
  std::condition_variable changed_;
  std::map<CallId, std::optional<std::vector<std::byte>>> replies_;  ///< of the calls that wait
  std::unique_ptr<CallEndpoint> calls_;                              // last: it uses the others
};

std::vector<FoundCommand> commands_of(const RawBus& bus, const BusOptions& options) {
  std::map<std::string, FoundCommand> found;
  for (const TopicWriter& writer : bus.writers()) {
    const auto service = service_of(writer.topic.name, writer.topic.type);
    if (!service) continue;
    if (const auto known = found.find(service->full_name); known != found.end()) {
      ++known->second.servers;
      continue;
    }
    const std::string robot = split_robot(writer.topic.name).robot;
    const std::string name = service->full_name.substr(robot.empty() ? 0 : robot.size() + 1);
    found[service->full_name] = {name, robot, service->kind, vendor_of(writer.id, options), 1};
  }
  std::vector<FoundCommand> commands;
  for (auto& [full_name, command] : found) commands.push_back(std::move(command));
  return commands;
}

std::string not_found(const std::string& full_name, const std::vector<FoundCommand>& commands, std::uint32_t domain) {
  const std::string text = "no running program offers " + full_name + " in domain " + std::to_string(domain);
  if (commands.empty()) return text + ", nor any other command" + other_domains_hint(domain);
  std::vector<std::string> names;
  for (const FoundCommand& command : commands) names.push_back(command.full_name());
  const std::string near = io::nearest_name(full_name, names);
  if (!near.empty()) return text + ", did you mean " + near + "?";
  std::string all;
  for (const std::string& name : names) all += (all.empty() ? "" : ", ") + name;
  return text + "; there are " + all;
}

/// The argument as CommandRequest has it.
std::string checked_argument(const FoundCommand& command, const std::string& argument) {
  const auto refuse = [&command](const std::string& problem) {
    throw CommandError(Cause::kWrongArgument, command.full_name() + ' ' + problem);
  };
  if (command.kind == CommandKind::kTrigger && !argument.empty()) refuse("takes no argument");
  if (argument.size() >= kMaxRequestBytes / 2) refuse("takes at most " + std::to_string(kMaxRequestBytes / 2) + " B");
  if (command.kind != CommandKind::kSetBool) return argument;
  const auto state = switch_argument(argument);
  if (!state) refuse("takes true or false, not '" + argument + "'");
  return *state;
}

}  // namespace

std::string FoundCommand::full_name() const {
  return (robot.empty() ? "/" : "/" + robot + "/") + name;
}

class CommandClient::State {
 public:
  explicit State(const BusOptions& options) : options_(options), bus_(connect_raw(options)) {}

  std::vector<FoundCommand> commands() const { return commands_of(*bus_, options_); }
  CommandAnswer call(const std::string& name, const std::string& argument, int timeout_ms);

 private:
  std::string full_name(const std::string& name) const;
  FoundCommand find(const std::string& full_name, Clock::time_point deadline) const;
  std::shared_ptr<RawBus> bus_of(const std::string& vendor);
  std::shared_ptr<CallChannel> channel_to(const FoundCommand& command);

  const BusOptions options_;
  const Clock::time_point start_ = Clock::now();
  const std::shared_ptr<RawBus> bus_;
  std::mutex mutex_;
  std::map<std::string, std::shared_ptr<RawBus>> others_;         ///< by vendor
  std::map<std::string, std::shared_ptr<CallChannel>> channels_;  ///< by vendor, type and name
};

std::string CommandClient::State::full_name(const std::string& name) const {
  const std::string plain = name.starts_with('/') ? name.substr(1) : name;
  const bool has_robot = options_.robot.empty() || plain.starts_with(options_.robot + "/");
  return '/' + (has_robot ? plain : options_.robot + "/" + plain);
}

/// Waits until it is found: discovery takes a moment, and a server that was killed is known for some seconds next to
/// its successor.
FoundCommand CommandClient::State::find(const std::string& full_name, Clock::time_point deadline) const {
  while (true) {
    const std::vector<FoundCommand> all = commands();
    const auto found = std::ranges::find_if(all, [&](const FoundCommand& one) { return one.full_name() == full_name; });
    if (found != all.end() && found->servers == 1) return *found;
    const Clock::time_point now = Clock::now();
    if (found != all.end() && now > deadline)
      throw CommandError(Cause::kSeveral, std::to_string(found->servers) + " programs offer " + full_name +
                                              ": end all but one, or give robots names (--robot)");
    if (found == all.end() && now > std::min(deadline, start_ + kDiscovery))
      throw CommandError(Cause::kNotFound, not_found(full_name, all, options_.domain));
    std::this_thread::sleep_for(kMoment);
  }
}

std::shared_ptr<RawBus> CommandClient::State::bus_of(const std::string& vendor) {
  if (vendor == bus_->vendor()) return bus_;
  std::shared_ptr<RawBus>& other = others_[vendor];
  if (other) return other;
  BusOptions options = options_;
  options.vendor = vendor;
  return other = connect_raw(options);
}

std::shared_ptr<CallChannel> CommandClient::State::channel_to(const FoundCommand& command) {
  if (command.vendor.empty())
    throw BusError(command.full_name() + " is offered through a DDS whose services are unknown here");
  const std::lock_guard lock(mutex_);
  std::shared_ptr<CallChannel>& channel =
      channels_[command.vendor + ' ' + ros_type(command.kind) + ' ' + command.full_name()];
  if (!channel)
    channel =
        std::make_shared<CallChannel>(bus_of(command.vendor), call_topics(command.full_name().substr(1), command.kind));
  return channel;
}

CommandAnswer CommandClient::State::call(const std::string& name, const std::string& argument, int timeout_ms) {
  const Clock::time_point deadline = Clock::now() + std::chrono::milliseconds(timeout_ms);
  const FoundCommand command = find(full_name(name), deadline);
  const CommandRequest request{checked_argument(command, argument)};
  const std::shared_ptr<CallChannel> channel = channel_to(command);
  const std::string called = command.full_name();
  if (!channel->connect(deadline))
    throw CommandError(Cause::kNoAnswer, called + " was found but could not be reached within " + seconds(timeout_ms) +
                                             "; with --secure: both need keys of one keystore that allow it");
  const auto [outcome, reply] = channel->call(encode_request(command.kind, request), deadline);
  if (outcome == CallChannel::Outcome::kTimeout)
    throw CommandError(Cause::kNoAnswer, called + " did not answer within " + seconds(timeout_ms) +
                                             "; it may be busy and still carry it out (--timeout)");
  if (outcome == CallChannel::Outcome::kServerGone)
    throw CommandError(Cause::kNoAnswer, "the program that offers " + called + " ended before it answered");
  try {
    return decode_answer(reply);
  } catch (const std::exception& error) {
    throw CommandError(Cause::kNoAnswer, called + " sent a malformed answer: " + error.what());
  }
}

CommandClient::CommandClient(const BusOptions& options) : state_(std::make_unique<State>(options)) {}
CommandClient::~CommandClient() = default;

std::vector<FoundCommand> CommandClient::commands() const {
  return state_->commands();
}

CommandAnswer CommandClient::call(const std::string& name, const std::string& argument, int timeout_ms) {
  return state_->call(name, argument, timeout_ms);
}

}  // namespace rtd::bus
