// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "common/service/json_text.hpp"
#include "services/viewer/core/foxglove.hpp"
#include "services/viewer/core/outbox.hpp"

namespace rtd::viewer::foxglove {
namespace {

using nlohmann::json;
using service::json_line;

json time_of(std::uint64_t time_ns) {
  constexpr std::uint64_t kNsPerS = 1'000'000'000;
  return {{"sec", time_ns / kNsPerS}, {"nsec", time_ns % kNsPerS}};
}

json to_json(const Schema& schema) {
  return {{"encoding", schema.encoding},
          {"schemaName", schema.name},
          {"schemaEncoding", schema.schema_encoding},
          {"schema", schema.text}};
}

json to_json(const Parameter& parameter) {
  json entry = {{"name", parameter.name}};
  if (const auto* flag = std::get_if<bool>(&parameter.value)) entry["value"] = *flag;
  if (const auto* text = std::get_if<std::string>(&parameter.value)) entry["value"] = *text;
  if (const auto* number = std::get_if<double>(&parameter.value)) {
    entry["value"] = *number;
    entry["type"] = "float64";
  }
  return entry;
}

/// The entries that are new or differ, and the names of those that are gone.
json changed_entries(const GraphEntries& before, const GraphEntries& now, const char* ids) {
  json changed = json::array();
  for (const auto& [name, who] : now) {
    const auto known = before.find(name);
    if (known == before.end() || known->second != who) changed.push_back({{"name", name}, {ids, who}});
  }
  return changed;
}

json gone_entries(const GraphEntries& before, const GraphEntries& now) {
  json gone = json::array();
  for (const auto& [name, who] : before)
    if (!now.contains(name)) gone.push_back(name);
  return gone;
}

json gone_topics(const ConnectionGraph& before, const ConnectionGraph& now) {
  GraphEntries earlier = before.published, later = now.published;
  earlier.insert(before.subscribed.begin(), before.subscribed.end());
  later.insert(now.subscribed.begin(), now.subscribed.end());
  return gone_entries(earlier, later);
}

}  // namespace

std::string server_info(const ServerInfo& info) {
  json message = {{"op", "serverInfo"},
                  {"name", info.name},
                  {"capabilities", info.capabilities},
                  {"supportedEncodings", info.supported_encodings},
                  {"metadata", info.metadata},
                  {"sessionId", info.session_id}};
  if (info.played_ns) {
    message["dataStartTime"] = time_of(info.played_ns->first);
    message["dataEndTime"] = time_of(info.played_ns->second);
  }
  return json_line(message);
}

std::string advertise(std::span<const Channel> channels) {
  json list = json::array();
  for (const Channel& channel : channels) {
    json entry = to_json(channel.schema);
    entry["id"] = channel.id;
    entry["topic"] = channel.topic;
    list.push_back(std::move(entry));
  }
  return json_line({{"op", "advertise"}, {"channels", std::move(list)}});
}

std::string unadvertise(std::span<const std::uint32_t> channel_ids) {
  return json_line({{"op", "unadvertise"}, {"channelIds", json(std::vector(channel_ids.begin(), channel_ids.end()))}});
}

std::string status(StatusLevel level, const std::string& message, const std::string& id) {
  json entry = {{"op", "status"}, {"level", static_cast<int>(level)}, {"message", message}};
  if (!id.empty()) entry["id"] = id;
  return json_line(entry);
}

std::string parameter_values(std::span<const Parameter> parameters, const std::string& id) {
  json message = {{"op", "parameterValues"}, {"parameters", json::array()}};
  for (const Parameter& parameter : parameters) message["parameters"].push_back(to_json(parameter));
  if (!id.empty()) message["id"] = id;
  return json_line(message);
}

std::string advertise_services(std::span<const Service> services) {
  json list = json::array();
  for (const Service& service : services)
    list.push_back({{"id", service.id},
                    {"name", service.name},
                    {"type", service.type},
                    {"request", to_json(service.request)},
                    {"response", to_json(service.response)}});
  return json_line({{"op", "advertiseServices"}, {"services", std::move(list)}});
}

std::string unadvertise_services(std::span<const std::uint32_t> ids) {
  return json_line({{"op", "unadvertiseServices"}, {"serviceIds", json(std::vector(ids.begin(), ids.end()))}});
}

std::string service_call_failure(std::uint32_t service, std::uint32_t call, const std::string& message) {
  return json_line({{"op", "serviceCallFailure"}, {"serviceId", service}, {"callId", call}, {"message", message}});
}

std::string connection_graph_update(const ConnectionGraph& before, const ConnectionGraph& now) {
  const json published = changed_entries(before.published, now.published, "publisherIds");
  const json subscribed = changed_entries(before.subscribed, now.subscribed, "subscriberIds");
  const json services = changed_entries(before.services, now.services, "providerIds");
  const json removed_topics = gone_topics(before, now), removed_services = gone_entries(before.services, now.services);
  if (published.empty() && subscribed.empty() && services.empty() && removed_topics.empty() && removed_services.empty())
    return {};
  return json_line({{"op", "connectionGraphUpdate"},
                    {"publishedTopics", published},
                    {"subscribedTopics", subscribed},
                    {"advertisedServices", services},
                    {"removedTopics", removed_topics},
                    {"removedServices", removed_services}});
}

Bytes message_data_head(std::uint32_t subscription, std::uint64_t log_time_ns) {
  return ByteWriter(std::uint8_t{1}, subscription, log_time_ns).take();
}

Bytes time(std::uint64_t now_ns) {
  return ByteWriter(std::uint8_t{2}, now_ns).take();
}

Bytes service_call_response(std::uint32_t service, std::uint32_t call, const std::string& encoding,
                            std::span<const std::byte> payload) {
  ByteWriter writer(std::uint8_t{3}, service, call);
  writer.put_text(encoding);
  writer.put_bytes(payload.data(), payload.size());
  return writer.take();
}

Bytes fetch_asset_failure(std::uint32_t request, const std::string& message) {
  ByteWriter writer(std::uint8_t{4}, request, std::uint8_t{1});
  writer.put_text(message);
  return writer.take();
}

Bytes playback_state(const PlaybackState& state) {
  ByteWriter writer(std::uint8_t{5}, state.status, state.now_ns, state.speed,
                    static_cast<std::uint8_t>(state.did_seek));
  writer.put_text(state.request_id);
  return writer.take();
}

}  // namespace rtd::viewer::foxglove
