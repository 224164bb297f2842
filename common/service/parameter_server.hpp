// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "common/bus/commands.hpp"
#include "common/msg/parameters.hpp"
#include "common/service/runtime.hpp"
#include "common/service/settings.hpp"

namespace rtd::service {

/// Of one request.
inline constexpr std::size_t kMaxParameters = 16;

/// The settings of a service as parameters of ROS 2: `ros2 param list`, `get`, `set` and `describe`. A value is read
/// from the service's own heartbeat and set by its command, as everywhere; one that has the value already is left
/// alone, and of several values for one name in a request the last counts. A request of more than kMaxParameters is
/// refused: the reply to one that sets says so, that to one that asks is empty. Thread-safe.
class Parameters {
 public:
  Parameters(std::string service, Heartbeat& heartbeat, std::shared_ptr<bus::CommandRegistry> commands);

  msg::ListParametersReply list(const msg::ListParametersRequest& asked) const;
  msg::GetParametersReply get(const msg::ParameterNames& asked) const;
  msg::GetParameterTypesReply types(const msg::ParameterNames& asked) const;
  msg::DescribeParametersReply describe(const msg::ParameterNames& asked) const;
  msg::SetParametersReply set(const msg::ParameterList& asked);
  /// All or none.
  msg::SetParametersAtomicallyReply set_all(const msg::ParameterList& asked);

 private:
  /// The setting of that name that this service has now.
  const Setting* find(const std::string& name) const;
  std::optional<SettingValue> value_of(const Setting& setting) const;
  msg::SetParametersResult set_one(const msg::Parameter& parameter);
  msg::SetParametersResult apply(const Setting& setting, const SettingValue& value);

  const std::string service_;
  Heartbeat& heartbeat_;
  const std::shared_ptr<bus::CommandRegistry> commands_;
};

/// Offers the six services of a node's parameters while it lives.
class ParameterServer {
 public:
  /// `service`: "slam", of the node rtd_slam. Throws BusError: refused.
  ParameterServer(bus::Bus& bus, const std::string& service, Heartbeat& heartbeat);

 private:
  Parameters parameters_;
  bus::CommandServer server_;  // last: it uses the other
};

}  // namespace rtd::service
