// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "services/viewer/core/outbox.hpp"

/// Requests and answers of the three service types behind the buttons, as Foxglove clients send them: JSON or CDR.
namespace rtd::viewer {

/// What a command takes.
enum class ArgumentKind { kNone, kBool, kText };

/// A command as it can be called now.
struct CommandInfo {
  std::string name;  ///< of the ROS 2 service: "/slam/reset"
  ArgumentKind kind = ArgumentKind::kNone;
  bool operator==(const CommandInfo&) const = default;
};

struct CommandResult {
  bool success = false;
  std::string message;
};

/// "std_srvs/srv/Trigger" and the like.
const char* service_type(ArgumentKind kind);
/// The texts of request and response in the encoding ros2msg.
const char* request_schema(ArgumentKind kind);
const char* response_schema();

/// The argument of a request: "", "true" or "false", or a text. Empty when the bytes are none of that type.
std::optional<std::string> read_command_request(ArgumentKind kind, const std::string& encoding,
                                                std::span<const std::byte> payload);
Bytes command_response(const std::string& encoding, const CommandResult& result);

}  // namespace rtd::viewer
