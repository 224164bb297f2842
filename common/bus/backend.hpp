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
#include <stdexcept>
#include <string>
#include <utility>

#include "common/bus/message_types.hpp"
#include "common/bus/qos.hpp"
#include "common/bus/writer_id.hpp"

namespace rtd::bus {

/// The bus cannot do what was asked; what() names the cause and the fix.
class BusError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

template <class Result, class Visitor, class... T>
Result visit_message_type(MessageId id, Visitor& visitor, TypeList<T...>) {
  using Call = Result (*)(Visitor&);
  static constexpr Call kCalls[] = {[](Visitor& chosen) -> Result { return chosen.template operator()<T>(); }...};
  const auto place = static_cast<std::size_t>(id);
  if (place < sizeof...(T)) return kCalls[place](visitor);
  throw BusError("message id " + std::to_string(place) + " is not one of common/bus/message_types.hpp");
}

/// Calls visitor.operator()<T>() with the plain struct T that belongs to `id`: the way from a run-time id back to a
/// type.
template <class Visitor>
decltype(auto) visit_message_type(MessageId id, Visitor&& visitor) {
  using Result = decltype(visitor.template operator()<msg::RgbdFrame>());
  return visit_message_type<Result>(id, visitor, MessageTypes());
}

/// The name under which every vendor registers the type, e.g. "nav_msgs::msg::dds_::Odometry_".
inline std::string dds_type_name(MessageId id) {
  std::string name = visit_message_type(id, []<class T>() -> const char* { return msg::type_name(msg::TypeOf<T>()); });
  return name.replace(name.find('/'), 1, "::msg::dds_::") + '_';
}

/// What a vendor implements. Messages cross as pointers to the plain structs of common/msg, typed by MessageId.
class WriterBackend {
 public:
  virtual ~WriterBackend() = default;
  virtual bool write(const void* message) = 0;
  virtual void* loan() = 0;                   ///< plain types only
  virtual bool write_loaned(void* slot) = 0;  ///< takes the slot back in any case
  virtual void discard_loan(void* slot) = 0;
  virtual int matched() const = 0;
  virtual bool wait_acknowledged(int timeout_ms) = 0;
  virtual WriterId id() const = 0;
};

class ReaderBackend {
 public:
  virtual ~ReaderBackend() = default;  ///< afterwards no callback runs
  virtual int matched() const = 0;
};

using ErasedCallback = std::function<void(std::shared_ptr<const void>, const WriterId& writer)>;

// ROS 2 services as pairs of topics: how a request gets to a server and its reply to the client that asked. The two
// RMWs identify requests in their own ways, so each backend does as the RMW of its vendor and a client uses the
// vendor of the server (docs/ros2.md).

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
  /// Server: whether the client of a request receives its reply already. Where the id does not name its reader: whether
  /// there are as many readers as writers.
  virtual bool reaches(const CallId&) const { return matched_readers() >= matched_writers(); }
};

/// A connection that services can be offered and called on.
class CallBackend {
 public:
  virtual ~CallBackend() = default;
  /// Throws BusError: refused.
  virtual std::unique_ptr<CallEndpoint> create_calls(const CallTopics& topics, CallRole role, OnCall on_call) = 0;
};

class BusBackend : public CallBackend {
 public:
  explicit BusBackend(std::string vendor) : vendor_(std::move(vendor)) {}
  const std::string& vendor() const { return vendor_; }
  virtual std::unique_ptr<WriterBackend> create_writer(MessageId id, const std::string& topic, QosProfile profile,
                                                       StatusCallbacks callbacks) = 0;
  virtual std::unique_ptr<ReaderBackend> create_reader(MessageId id, const std::string& topic, QosProfile profile,
                                                       ErasedCallback on_message, StatusCallbacks callbacks) = 0;

 private:
  const std::string vendor_;
};

}  // namespace rtd::bus
