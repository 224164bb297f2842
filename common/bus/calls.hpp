// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>

/// ROS 2 services as pairs of topics: how a request gets to a server and its reply to the client that asked. The two
/// RMWs identify requests in ways of their own, so each backend does as the RMW of its vendor and a client uses the
/// vendor of the server (docs/ros2.md).
namespace rtd::bus {

/// A keep-last history for each direction: the default of ROS 2 services.
inline constexpr int kCallDepth = 10;

/// DDS names: "rq/slam/resetRequest", "std_srvs::srv::dds_::Trigger_Request_", ...
struct CallTopics {
  std::string request, request_type, reply, reply_type;
};

/// Which request of which client.
struct CallId {
  std::array<std::uint8_t, 16> client{};
  std::int64_t sequence = 0;
  auto operator<=>(const CallId&) const = default;
};

enum class CallRole { kServer, kClient };

/// Gets each request (server) or each reply to a request of this client. `cdr`: header and fields, unchecked. Runs on a
/// thread of the bus: queue and return.
using OnCall = std::function<void(const CallId& id, std::span<const std::byte> cdr)>;

/// One end of a service. Thread-safe. After the destructor returns, no callback runs.
class CallEndpoint {
 public:
  virtual ~CallEndpoint() = default;
  /// Client: sends a request and returns its id. Nothing when the bus did not take it.
  virtual std::optional<CallId> request(std::span<const std::byte> cdr) = 0;
  /// Server: sends the reply to a request.
  virtual bool reply(const CallId& id, std::span<const std::byte> cdr) = 0;
  /// How many endpoints receive what this one sends, and how many send what it receives.
  virtual int matched_readers() const = 0;
  virtual int matched_writers() const = 0;
};

/// A connection that services can be offered and called on.
class CallBackend {
 public:
  virtual ~CallBackend() = default;
  /// Throws BusError: refused.
  virtual std::unique_ptr<CallEndpoint> create_calls(const CallTopics& topics, CallRole role, OnCall on_call) = 0;
};

}  // namespace rtd::bus
