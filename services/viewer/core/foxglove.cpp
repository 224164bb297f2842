// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/viewer/core/foxglove.hpp"

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "common/service/json_text.hpp"
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

namespace {

using nlohmann::json;

constexpr std::size_t kMaxEntries = 10'000;  ///< of one list in one message

const json& field(const json& object, const char* name) {
  if (!object.is_object()) throw ProtocolError("an object is missing");
  const auto found = object.find(name);
  if (found == object.end()) throw ProtocolError(std::string("field '") + name + "' is missing");
  return *found;
}

const json& list(const json& object, const char* name) {
  const json& entries = field(object, name);
  if (!entries.is_array()) throw ProtocolError(std::string("field '") + name + "' is not a list");
  if (entries.size() > kMaxEntries) throw ProtocolError(std::string("field '") + name + "' has too many entries");
  return entries;
}

std::uint32_t id_of(const json& value) {
  if (!value.is_number_unsigned() || value.get<std::uint64_t>() > UINT32_MAX)
    throw ProtocolError("an id is not a number from 0 to 4294967295");
  return value.get<std::uint32_t>();
}

std::string text_of(const json& value) {
  if (!value.is_string()) throw ProtocolError("a name is not a text");
  return value.get<std::string>();
}

std::string optional_text(const json& object, const char* name) {
  const auto found = object.find(name);
  return found == object.end() || !found->is_string() ? std::string() : found->get<std::string>();
}

std::vector<std::uint32_t> ids(const json& object, const char* name) {
  std::vector<std::uint32_t> result;
  for (const json& entry : list(object, name)) result.push_back(id_of(entry));
  return result;
}

std::vector<std::string> names(const json& object, const char* name) {
  std::vector<std::string> result;
  for (const json& entry : list(object, name)) result.push_back(text_of(entry));
  return result;
}

ParameterValue value_of(const json& value) {
  if (value.is_boolean()) return value.get<bool>();
  if (value.is_number()) return value.get<double>();
  if (value.is_string()) return value.get<std::string>();
  if (value.is_null()) return {};
  throw ProtocolError("a parameter is a truth value, a number or a text here");
}

Subscribe read_subscribe(const json& message) {
  Subscribe request;
  for (const json& entry : list(message, "subscriptions"))
    request.subscriptions.emplace_back(id_of(field(entry, "id")), id_of(field(entry, "channelId")));
  return request;
}

ClientAdvertise read_advertise(const json& message) {
  ClientAdvertise request;
  for (const json& entry : list(message, "channels"))
    request.channels.push_back({.id = id_of(field(entry, "id")),
                                .topic = text_of(field(entry, "topic")),
                                .schema = {.encoding = text_of(field(entry, "encoding")),
                                           .name = text_of(field(entry, "schemaName")),
                                           .schema_encoding = optional_text(entry, "schemaEncoding"),
                                           .text = optional_text(entry, "schema")}});
  return request;
}

SetParameters read_set_parameters(const json& message) {
  SetParameters request;
  for (const json& entry : list(message, "parameters")) {
    const auto value = entry.find("value");
    request.parameters.push_back(
        {text_of(field(entry, "name")), value == entry.end() ? ParameterValue() : value_of(*value)});
  }
  request.id = optional_text(message, "id");
  return request;
}

/// Little-endian values from the front of a message.
class BinaryReader {
 public:
  explicit BinaryReader(std::span<const std::byte> bytes) : rest_(bytes) {}
  template <class T>
  T get() {
    T value;
    std::memcpy(&value, take(sizeof(T)).data(), sizeof(T));
    return value;
  }
  std::string get_text() {
    const auto bytes = take(get<std::uint32_t>());
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }
  std::span<const std::byte> rest() const { return rest_; }

 private:
  std::span<const std::byte> take(std::size_t size) {
    if (size > rest_.size()) throw ProtocolError("a binary message is too short");
    const auto taken = rest_.first(size);
    rest_ = rest_.subspan(size);
    return taken;
  }
  std::span<const std::byte> rest_;
};

PlaybackControl read_playback_control(BinaryReader& reader) {
  PlaybackControl request;
  request.pause = reader.get<std::uint8_t>() == 1;
  request.speed = reader.get<float>();
  const bool seeks = reader.get<std::uint8_t>() != 0;
  const auto seek_ns = reader.get<std::uint64_t>();
  if (seeks) request.seek_ns = seek_ns;
  request.request_id = reader.get_text();
  if (!std::isfinite(request.speed) || request.speed <= 0) throw ProtocolError("a speed must be above 0");
  return request;
}

Request read_op(const std::string& op, const json& message) {
  if (op == "subscribe") return read_subscribe(message);
  if (op == "unsubscribe") return Unsubscribe{ids(message, "subscriptionIds")};
  if (op == "advertise") return read_advertise(message);
  if (op == "unadvertise") return ClientUnadvertise{ids(message, "channelIds")};
  if (op == "getParameters") return GetParameters{names(message, "parameterNames"), optional_text(message, "id")};
  if (op == "setParameters") return read_set_parameters(message);
  if (op == "subscribeParameterUpdates") return WatchParameters{true, names(message, "parameterNames")};
  if (op == "unsubscribeParameterUpdates") return WatchParameters{false, names(message, "parameterNames")};
  if (op == "subscribeConnectionGraph") return WatchGraph{true};
  if (op == "unsubscribeConnectionGraph") return WatchGraph{false};
  if (op == "fetchAsset") return FetchAsset{text_of(field(message, "uri")), id_of(field(message, "requestId"))};
  throw ProtocolError("op '" + op.substr(0, 40) + "' is unknown");
}

}  // namespace

Request read_text(std::string_view text) {
  const json message = json::parse(text, nullptr, false);
  if (message.is_discarded()) throw ProtocolError("a text message is not JSON");
  return read_op(text_of(field(message, "op")), message);
}

Request read_binary(std::span<const std::byte> bytes) {
  BinaryReader reader(bytes);
  const auto opcode = reader.get<std::uint8_t>();
  if (opcode == 1) {
    const auto channel = reader.get<std::uint32_t>();
    return ClientMessage{channel, reader.rest()};
  }
  if (opcode == 2) {
    ServiceCall call{.service = reader.get<std::uint32_t>(), .call = reader.get<std::uint32_t>()};
    call.encoding = reader.get_text();
    call.payload = reader.rest();
    return call;
  }
  if (opcode == 3) return read_playback_control(reader);
  throw ProtocolError("opcode " + std::to_string(opcode) + " of a binary message is unknown");
}

}  // namespace rtd::viewer::foxglove
