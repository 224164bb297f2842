// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "services/viewer/core/foxglove.hpp"

namespace rtd::viewer::foxglove {
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
