// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/viewer/core/foxglove_hub.hpp"

#include <algorithm>
#include <utility>

namespace rtd::viewer {

using foxglove::Channel;

std::uint64_t Played::position_at(std::int64_t realtime_ns) const {
  if (ended) return end_ns;
  const double passed_ns = paused ? 0.0 : speed * static_cast<double>(realtime_ns - at_ns);
  constexpr double kMost_ns = 1e18;  // what other programs say may be anything
  const auto position = static_cast<std::int64_t>(position_ns) +
                        static_cast<std::int64_t>(std::max(-kMost_ns, std::min(kMost_ns, passed_ns)));
  return static_cast<std::uint64_t>(
      std::clamp(position, static_cast<std::int64_t>(begin_ns), static_cast<std::int64_t>(end_ns)));
}

FoxgloveHub::FoxgloveHub(std::string name, std::string session_id, std::map<std::string, std::string> metadata,
                         FoxgloveHooks hooks)
    : name_(std::move(name)),
      session_id_(std::move(session_id)),
      metadata_(std::move(metadata)),
      hooks_(std::move(hooks)),
      looking_{.on_wanted = hooks_.on_wanted, .realtime_ns = hooks_.realtime_ns} {}

std::unique_ptr<Session> FoxgloveHub::open(std::string_view subprotocol, Rights rights) {
  return std::make_unique<FoxgloveSession>(*this, subprotocol, rights);
}

foxglove::ServerInfo FoxgloveHub::server_info(const FoxgloveHooks& hooks) const {
  foxglove::ServerInfo info{.name = name_,
                            .session_id = session_id_,
                            .capabilities = {"time", "parameters", "parametersSubscribe", "connectionGraph"},
                            .supported_encodings = {"json", "cdr"},
                            .metadata = metadata_};
  if (hooks.on_call) info.capabilities.emplace_back("services");
  if (hooks.on_publish) info.capabilities.emplace_back("clientPublish");
  if (played_) info.played_ns.emplace(played_->begin_ns, played_->end_ns);
  if (played_ && hooks.on_playback) info.capabilities.emplace_back("playbackControl");
  return info;
}

std::vector<Channel> FoxgloveHub::channels() const {
  std::vector<Channel> offered;
  for (const auto& [id, offer] : channels_)
    if (offer.offered) offered.push_back(offer.channel);
  return offered;
}

std::uint32_t FoxgloveHub::add_channel(const std::string& topic, const foxglove::Schema& schema) {
  const auto same = [&](const auto& entry) {
    const Channel& channel = entry.second.channel;
    return channel.topic == topic && channel.schema.name == schema.name && channel.schema.text == schema.text;
  };
  auto known = std::ranges::find_if(channels_, same);
  if (known == channels_.end()) {
    const auto id = static_cast<std::uint32_t>(channels_.size() + 1);
    known = channels_.emplace(id, Offer{{id, topic, schema}, false}).first;
  }
  if (!std::exchange(known->second.offered, true)) broadcast(foxglove::advertise(std::span(&known->second.channel, 1)));
  return known->first;
}

void FoxgloveHub::remove_channel(std::uint32_t id) {
  const auto known = channels_.find(id);
  if (known == channels_.end() || !std::exchange(known->second.offered, false)) return;
  broadcast(foxglove::unadvertise(std::span(&id, 1)));
  for (FoxgloveSession* session : sessions_)
    std::erase_if(session->subscriptions_, [&](const auto& subscription) { return subscription.second == id; });
  update_wanted(id);
}

bool FoxgloveHub::wanted(std::uint32_t channel) const {
  return wanted_.contains(channel);
}

void FoxgloveHub::update_wanted(std::uint32_t channel) {
  const bool now =
      std::ranges::any_of(sessions_, [&](const FoxgloveSession* session) { return session->subscribes(channel); });
  if (now == wanted_.contains(channel)) return;
  if (now) {
    wanted_.insert(channel);
  } else {
    wanted_.erase(channel);
  }
  if (hooks_.on_wanted) hooks_.on_wanted(channel, now);
}

void FoxgloveHub::publish(std::uint32_t channel, std::int64_t source_ns, std::shared_ptr<const Bytes> payload) {
  auto log_time_ns = static_cast<std::uint64_t>(source_ns);
  if (played_ && (log_time_ns < played_->begin_ns || log_time_ns > played_->end_ns))
    log_time_ns = played_->position_at(source_ns);
  for (FoxgloveSession* session : sessions_) session->deliver(channel, log_time_ns, payload);
}

void FoxgloveHub::set_commands(const std::vector<CommandInfo>& commands) {
  std::vector<std::uint32_t> gone;
  std::erase_if(services_, [&](const auto& entry) {
    if (std::ranges::count(commands, entry.second.first) > 0) return false;
    gone.push_back(entry.first);
    return true;
  });
  std::vector<foxglove::Service> added;
  for (const CommandInfo& command : commands) {
    const std::string type = bus::ros_type(command.kind);
    const auto id = service_ids_.try_emplace(command.name + ' ' + type, service_ids_.size() + 1).first->second;
    if (services_.contains(id)) continue;
    added.push_back({.id = id,
                     .name = command.name,
                     .type = type,
                     .request = {"cdr", type + "_Request", "ros2msg", request_schema(command.kind)},
                     .response = {"cdr", type + "_Response", "ros2msg", response_schema()}});
    services_.emplace(id, std::pair(command, added.back()));
  }
  for (FoxgloveSession* session : sessions_) {
    if (!session->hooks_.on_call) continue;
    if (!gone.empty()) session->send(foxglove::unadvertise_services(gone));
    if (!added.empty()) session->send(foxglove::advertise_services(added));
  }
}

void FoxgloveHub::set_parameters(std::vector<foxglove::Parameter> parameters) {
  const auto before = std::exchange(parameters_, std::move(parameters));
  for (FoxgloveSession* session : sessions_) {
    std::vector<foxglove::Parameter> changed;
    for (const foxglove::Parameter& parameter : parameters_) {
      const auto same = [&](const auto& other) {
        return other.name == parameter.name && other.value == parameter.value;
      };
      if (session->watches(parameter.name) && std::ranges::none_of(before, same)) changed.push_back(parameter);
    }
    if (!changed.empty()) session->send(foxglove::parameter_values(changed));
  }
}

std::vector<foxglove::Parameter> FoxgloveHub::parameters(const std::vector<std::string>& names) const {
  if (names.empty()) return parameters_;
  std::vector<foxglove::Parameter> chosen;
  for (const foxglove::Parameter& parameter : parameters_)
    if (std::ranges::count(names, parameter.name) > 0) chosen.push_back(parameter);
  return chosen;
}

void FoxgloveHub::set_graph(foxglove::ConnectionGraph graph) {
  const std::string update = foxglove::connection_graph_update(graph_, graph);
  graph_ = std::move(graph);
  if (update.empty()) return;
  for (FoxgloveSession* session : sessions_)
    if (session->watches_graph_) session->send(update);
}

void FoxgloveHub::set_played(const std::optional<Played>& played) {
  if (played && played_ && played->at_ns < played_->at_ns) return;
  const auto range = [](const std::optional<Played>& of) {
    return of ? std::pair(of->begin_ns, of->end_ns) : std::pair<std::uint64_t, std::uint64_t>();
  };
  const bool other = played.has_value() != played_.has_value() || range(played) != range(played_);
  played_ = played;
  for (FoxgloveSession* session : sessions_)
    if (other) session->send(foxglove::server_info(server_info(session->hooks_)));
  if (played_) send_playback();
}

void FoxgloveHub::control_done(const foxglove::PlaybackControl& request) {
  if (!played_) return;
  const std::int64_t now_ns = hooks_.realtime_ns();
  played_->position_ns =
      request.seek_ns ? std::clamp(*request.seek_ns, played_->begin_ns, played_->end_ns) : played_->position_at(now_ns);
  if (played_->speed > 0) played_->speed = request.speed;
  played_->paused = request.pause;
  played_->at_ns = now_ns;
  send_playback(&request);
}

void FoxgloveHub::send_playback(const foxglove::PlaybackControl* answered) {
  using Status = foxglove::PlaybackStatus;
  if (!played_) return;
  foxglove::PlaybackState state{.status = played_->ended    ? Status::kEnded
                                          : played_->paused ? Status::kPaused
                                                            : Status::kPlaying,
                                .now_ns = played_->position_at(hooks_.realtime_ns()),
                                .speed = played_->shown_speed()};
  if (answered != nullptr) {
    state.did_seek = answered->seek_ns.has_value();
    state.request_id = answered->request_id;
  }
  for (FoxgloveSession* session : sessions_)
    if (session->knows_playback_) session->outbox_.push_control(binary_frame(foxglove::playback_state(state)));
}

void FoxgloveHub::send_time() {
  const std::int64_t now_ns = hooks_.realtime_ns();
  const std::uint64_t time_ns = played_ ? played_->position_at(now_ns) : static_cast<std::uint64_t>(now_ns);
  for (FoxgloveSession* session : sessions_) session->outbox_.push_data(binary_frame(foxglove::time(time_ns)));
}

std::uint64_t FoxgloveHub::dropped() const {
  std::uint64_t dropped = 0;
  for (const FoxgloveSession* session : sessions_) dropped += session->outbox_.dropped();
  return dropped;
}

void FoxgloveHub::broadcast(const std::string& text) {
  for (FoxgloveSession* session : sessions_) session->send(text);
}

void FoxgloveHub::remove(FoxgloveSession* session) {
  sessions_.erase(session);
  for (const auto& [id, channel] : session->subscriptions_) update_wanted(channel);
}

}  // namespace rtd::viewer
