// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "services/viewer/core/outbox.hpp"

/// The messages of the Foxglove WebSocket protocol, version 1: JSON as text, little-endian binary.
namespace rtd::viewer::foxglove {

inline constexpr const char* kSubprotocols[] = {"foxglove.sdk.v1", "foxglove.websocket.v1"};

/// A message of a client that cannot be read; what() names the cause.
class ProtocolError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// --- From the server

struct ServerInfo {
  std::string name, session_id;
  std::vector<std::string> capabilities, supported_encodings;
  std::map<std::string, std::string> metadata;
  /// Begin and end of what is played, ns; only with the capability playbackControl.
  std::optional<std::pair<std::uint64_t, std::uint64_t>> played_ns;
};
std::string server_info(const ServerInfo& info);

struct Schema {
  std::string encoding, name, schema_encoding, text;
};
struct Channel {
  std::uint32_t id = 0;
  std::string topic;
  Schema schema;
};
std::string advertise(std::span<const Channel> channels);
std::string unadvertise(std::span<const std::uint32_t> channel_ids);

enum class StatusLevel { kInfo = 0, kWarning = 1, kError = 2 };
std::string status(StatusLevel level, const std::string& message, const std::string& id = {});

using ParameterValue = std::variant<std::monostate, bool, double, std::string>;
struct Parameter {
  std::string name;
  ParameterValue value;  ///< empty: not set
};
/// `id`: of the request that this answers, or empty.
std::string parameter_values(std::span<const Parameter> parameters, const std::string& id = {});

struct Service {
  std::uint32_t id = 0;
  std::string name, type;
  Schema request, response;
};
std::string advertise_services(std::span<const Service> services);
std::string unadvertise_services(std::span<const std::uint32_t> ids);
std::string service_call_failure(std::uint32_t service, std::uint32_t call, const std::string& message);

/// Who publishes or subscribes to a topic, or provides a service, by name.
using GraphEntries = std::map<std::string, std::vector<std::string>>;
struct ConnectionGraph {
  GraphEntries published, subscribed, services;
};
/// What has changed since `before`; empty when nothing has.
std::string connection_graph_update(const ConnectionGraph& before, const ConnectionGraph& now);

Bytes message_data_head(std::uint32_t subscription, std::uint64_t log_time_ns);
Bytes time(std::uint64_t now_ns);
Bytes service_call_response(std::uint32_t service, std::uint32_t call, const std::string& encoding,
                            std::span<const std::byte> payload);
Bytes fetch_asset_failure(std::uint32_t request, const std::string& message);

enum class PlaybackStatus : std::uint8_t { kPlaying = 0, kPaused = 1, kBuffering = 2, kEnded = 3 };
struct PlaybackState {
  PlaybackStatus status = PlaybackStatus::kPaused;
  std::uint64_t now_ns = 0;
  float speed = 1;
  bool did_seek = false;
  std::string request_id;
};
Bytes playback_state(const PlaybackState& state);

// --- From a client

struct Subscribe {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> subscriptions;  ///< id chosen by the client, channel
};
struct Unsubscribe {
  std::vector<std::uint32_t> ids;
};
struct ClientAdvertise {
  std::vector<Channel> channels;  ///< with ids of the client's own
};
struct ClientUnadvertise {
  std::vector<std::uint32_t> ids;
};
struct GetParameters {
  std::vector<std::string> names;  ///< empty: all
  std::string id;
};
struct SetParameters {
  std::vector<Parameter> parameters;
  std::string id;
};
struct WatchParameters {
  bool on = true;
  std::vector<std::string> names;  ///< empty: all
};
struct WatchGraph {
  bool on = true;
};
struct FetchAsset {
  std::string uri;
  std::uint32_t request = 0;
};
struct ClientMessage {
  std::uint32_t channel = 0;
  std::span<const std::byte> payload;  ///< of the bytes that were read
};
struct ServiceCall {
  std::uint32_t service = 0, call = 0;
  std::string encoding;
  std::span<const std::byte> payload;  ///< of the bytes that were read
};
struct PlaybackControl {
  bool pause = false;
  float speed = 1;
  std::optional<std::uint64_t> seek_ns;
  std::string request_id;
};

using Request = std::variant<Subscribe, Unsubscribe, ClientAdvertise, ClientUnadvertise, GetParameters, SetParameters,
                             WatchParameters, WatchGraph, FetchAsset, ClientMessage, ServiceCall, PlaybackControl>;

/// Throw ProtocolError.
Request read_text(std::string_view text);
Request read_binary(std::span<const std::byte> bytes);

}  // namespace rtd::viewer::foxglove
