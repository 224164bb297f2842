// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "common/bus/commands.hpp"
#include "services/viewer/core/outbox.hpp"

/// Requests and answers of the three service types behind the buttons, as Foxglove clients send them: JSON or CDR.
namespace rtd::viewer {

using bus::CommandKind;
using CommandResult = bus::CommandAnswer;

/// A command as it can be called now.
struct CommandInfo {
  std::string name;  ///< of the ROS 2 service: "/slam/reset"
  CommandKind kind = CommandKind::kTrigger;
  bool operator==(const CommandInfo&) const = default;
};

/// The texts of request and response in the encoding ros2msg.
const char* request_schema(CommandKind kind);
const char* response_schema();

/// The argument of a request: "", "true" or "false", or a text. Empty when the bytes are none of that type.
std::optional<std::string> read_command_request(CommandKind kind, const std::string& encoding,
                                                std::span<const std::byte> payload);
Bytes command_response(const std::string& encoding, const CommandResult& result);

}  // namespace rtd::viewer
