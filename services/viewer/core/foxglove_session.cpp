// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "services/viewer/core/foxglove_hub.hpp"

namespace rtd::viewer {

FoxgloveSession::FoxgloveSession(FoxgloveHub& hub, std::string_view subprotocol, Rights rights)
    : hub_(hub), hooks_(hub.hooks_of(rights)), knows_playback_(subprotocol == foxglove::kSubprotocols[0]) {
  hub_.sessions_.insert(this);
  send(foxglove::server_info(hub_.server_info(hooks_)));
  send(foxglove::advertise(hub_.channels()));
  if (!hooks_.on_call || hub_.services_.empty()) return;
  std::vector<foxglove::Service> services;
  for (const auto& [id, entry] : hub_.services_) services.push_back(entry.second);
  send(foxglove::advertise_services(services));
}

FoxgloveSession::~FoxgloveSession() {
  hub_.remove(this);
}

void FoxgloveSession::on_text(std::string_view text) {
  handle([&] { return foxglove::read_text(text); });
}

void FoxgloveSession::on_binary(std::span<const std::byte> bytes) {
  handle([&] { return foxglove::read_binary(bytes); });
}

void FoxgloveSession::handle(const std::function<foxglove::Request()>& read) {
  try {
    std::visit([this](const auto& chosen) { answer(chosen); }, read());
  } catch (const foxglove::ProtocolError& error) {
    send_error(error.what());
  }
}

bool FoxgloveSession::subscribes(std::uint32_t channel) const {
  return std::ranges::any_of(subscriptions_, [&](const auto& entry) { return entry.second == channel; });
}

void FoxgloveSession::deliver(std::uint32_t channel, std::uint64_t log_time_ns,
                              const std::shared_ptr<const Bytes>& payload) {
  for (const auto& [id, subscribed] : subscriptions_)
    if (subscribed == channel) outbox_.push_data(binary_frame(foxglove::message_data_head(id, log_time_ns), payload));
}

bool FoxgloveSession::watches(const std::string& parameter) const {
  return watches_all_parameters_ || watched_parameters_.contains(parameter);
}

void FoxgloveSession::answer(const foxglove::Subscribe& request) {
  for (const auto& [id, channel] : request.subscriptions) {
    const auto offer = hub_.channels_.find(channel);
    if (offer == hub_.channels_.end() || !offer->second.offered) {
      warn("channel " + std::to_string(channel) + " does not exist");
    } else if (subscriptions_.contains(id)) {
      warn("subscription " + std::to_string(id) + " exists already");
    } else if (subscriptions_.size() >= kMaxSubscriptions) {
      send_error("too many subscriptions");
    } else {
      subscriptions_.emplace(id, channel);
      hub_.update_wanted(channel);
    }
  }
}

void FoxgloveSession::answer(const foxglove::Unsubscribe& request) {
  for (const std::uint32_t id : request.ids) {
    const auto known = subscriptions_.find(id);
    if (known == subscriptions_.end()) {
      warn("subscription " + std::to_string(id) + " does not exist");
      continue;
    }
    const std::uint32_t channel = known->second;
    subscriptions_.erase(known);
    hub_.update_wanted(channel);
  }
}

void FoxgloveSession::answer(const foxglove::ClientAdvertise& request) {
  if (!hooks_.on_publish) return send_error("this viewer only listens: start it with --publish to let clients publish");
  for (const foxglove::Channel& channel : request.channels) {
    if (channel.schema.encoding != "cdr") {
      send_error("channel '" + channel.topic + "': only the encoding cdr can be published");
    } else if (published_.size() >= kMaxSubscriptions) {
      send_error("too many channels");
    } else {
      published_.insert_or_assign(channel.id, channel);
    }
  }
}

void FoxgloveSession::answer(const foxglove::ClientUnadvertise& request) {
  for (const std::uint32_t id : request.ids) published_.erase(id);
}

void FoxgloveSession::answer(const foxglove::ClientMessage& request) {
  const auto channel = published_.find(request.channel);
  if (channel == published_.end())
    return send_error("channel " + std::to_string(request.channel) + " is not advertised");
  const std::string problem = hooks_.on_publish(channel->second.topic, channel->second.schema.name, request.payload);
  if (!problem.empty()) send_error(problem);
}

void FoxgloveSession::answer(const foxglove::GetParameters& request) {
  send(foxglove::parameter_values(hub_.parameters(request.names), request.id));
}

void FoxgloveSession::answer(const foxglove::SetParameters& request) {
  if (!hooks_.on_set) return send_error(kOnlyLooks);
  struct Progress {
    std::vector<foxglove::Parameter> accepted;
    std::size_t answers = 0;
  };
  const auto progress = std::make_shared<Progress>();
  for (const foxglove::Parameter& parameter : request.parameters)
    hooks_.on_set(parameter,
                  [this, alive = std::weak_ptr(alive_), progress, request, parameter](const CommandResult& result) {
                    if (alive.expired()) return;
                    if (result.success) progress->accepted.push_back(parameter);
                    if (!result.success) send_error("parameter '" + parameter.name + "': " + result.message);
                    if (++progress->answers == request.parameters.size())
                      answer_parameters(progress->accepted, request);
                  });
}

/// What was accepted has its new value here: it comes with a heartbeat, later.
void FoxgloveSession::answer_parameters(const std::vector<foxglove::Parameter>& accepted,
                                        const foxglove::SetParameters& request) {
  if (request.id.empty()) return;
  std::vector<std::string> names;
  for (const foxglove::Parameter& parameter : request.parameters) names.push_back(parameter.name);
  std::vector<foxglove::Parameter> values = hub_.parameters(names);
  for (foxglove::Parameter& value : values) {
    const auto found = std::ranges::find(accepted, value.name, &foxglove::Parameter::name);
    if (found != accepted.end()) value = *found;
  }
  send(foxglove::parameter_values(values, request.id));
}

void FoxgloveSession::answer(const foxglove::WatchParameters& request) {
  if (request.names.empty()) watches_all_parameters_ = request.on;
  for (const std::string& name : request.names) {
    if (!request.on) {
      watched_parameters_.erase(name);
    } else if (watched_parameters_.size() < kMaxSubscriptions) {
      watched_parameters_.insert(name);
    }
  }
}

void FoxgloveSession::answer(const foxglove::WatchGraph& request) {
  if (request.on && !watches_graph_) {
    std::string graph = foxglove::connection_graph_update({}, hub_.graph_);
    if (!graph.empty()) send(graph);
  }
  watches_graph_ = request.on;
}

void FoxgloveSession::answer(const foxglove::FetchAsset& request) {
  outbox_.push_control(
      binary_frame(foxglove::fetch_asset_failure(request.request, "'" + request.uri + "': this server has no assets")));
}

void FoxgloveSession::answer(const foxglove::ServiceCall& request) {
  const auto fail = [&](const std::string& why) {
    send(foxglove::service_call_failure(request.service, request.call, why));
  };
  if (!hooks_.on_call) return fail(kOnlyLooks);
  const auto known = hub_.services_.find(request.service);
  if (known == hub_.services_.end()) return fail("service " + std::to_string(request.service) + " does not exist");
  const CommandInfo command = known->second.first;
  const auto argument = read_command_request(command.kind, request.encoding, request.payload);
  if (!argument)
    return fail("'" + command.name + "': the request is not a " + bus::ros_type(command.kind) + " in json or cdr");
  hooks_.on_call(command, *argument,
                 [this, alive = std::weak_ptr(alive_), service = request.service, call = request.call,
                  encoding = request.encoding](const CommandResult& result) {
                   if (alive.expired()) return;
                   outbox_.push_control(binary_frame(
                       foxglove::service_call_response(service, call, encoding, command_response(encoding, result))));
                 });
}

void FoxgloveSession::answer(const foxglove::PlaybackControl& request) {
  knows_playback_ = true;
  if (!hooks_.on_playback) return send_error(kOnlyLooks);
  if (!hub_.played_) return send_error("nothing is being replayed");
  hooks_.on_playback(request, [&hub = hub_, this, alive = std::weak_ptr(alive_), request](const CommandResult& result) {
    if (result.success) return hub.control_done(request);
    if (alive.expired()) return;
    send_error(result.message);
    const foxglove::PlaybackControl refused{.request_id = request.request_id};
    hub.send_playback(&refused);
  });
}

}  // namespace rtd::viewer
