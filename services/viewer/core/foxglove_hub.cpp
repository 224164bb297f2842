// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/viewer/core/foxglove_hub.hpp"

#include <algorithm>
#include <utility>

namespace rtd::viewer {

using foxglove::Channel;

FoxgloveHub::FoxgloveHub(std::string name, std::string session_id, std::map<std::string, std::string> metadata,
                         FoxgloveHooks hooks)
    : name_(std::move(name)),
      session_id_(std::move(session_id)),
      metadata_(std::move(metadata)),
      hooks_(std::move(hooks)) {}

std::unique_ptr<Session> FoxgloveHub::open() {
  return std::make_unique<FoxgloveSession>(*this);
}

foxglove::ServerInfo FoxgloveHub::server_info() const {
  foxglove::ServerInfo info{.name = name_,
                            .session_id = session_id_,
                            .capabilities = {"time", "parameters", "parametersSubscribe", "connectionGraph"},
                            .supported_encodings = {"json", "cdr"},
                            .metadata = metadata_,
                            .played_ns = played_ns_};
  if (hooks_.on_call) info.capabilities.emplace_back("services");
  if (hooks_.on_publish) info.capabilities.emplace_back("clientPublish");
  if (played_ns_ && hooks_.on_playback) info.capabilities.emplace_back("playbackControl");
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

void FoxgloveHub::publish(std::uint32_t channel, std::uint64_t log_time_ns, std::shared_ptr<const Bytes> payload) {
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
    const std::string type = service_type(command.kind);
    const auto id = service_ids_.try_emplace(command.name + ' ' + type, service_ids_.size() + 1).first->second;
    if (services_.contains(id)) continue;
    added.push_back({.id = id,
                     .name = command.name,
                     .type = type,
                     .request = {"cdr", type + "_Request", "ros2msg", request_schema(command.kind)},
                     .response = {"cdr", type + "_Response", "ros2msg", response_schema()}});
    services_.emplace(id, std::pair(command, added.back()));
  }
  if (!hooks_.on_call) return;
  if (!gone.empty()) broadcast(foxglove::unadvertise_services(gone));
  if (!added.empty()) broadcast(foxglove::advertise_services(added));
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

void FoxgloveHub::set_played(std::uint64_t begin_ns, std::uint64_t end_ns) {
  const std::pair played(begin_ns, end_ns);
  if (std::exchange(played_ns_, played) != played) broadcast(foxglove::server_info(server_info()));
}

void FoxgloveHub::set_playback(const foxglove::PlaybackState& state) {
  for (FoxgloveSession* session : sessions_)
    session->outbox_.push_control(binary_frame(foxglove::playback_state(state)));
}

void FoxgloveHub::send_time(std::uint64_t now_ns) {
  for (FoxgloveSession* session : sessions_) session->outbox_.push_data(binary_frame(foxglove::time(now_ns)));
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
