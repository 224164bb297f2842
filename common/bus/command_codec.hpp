// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/bus/commands.hpp"

/// Commands on the wire: names of topics and types as ROS 2 forms them, requests and replies as XCDR1.
namespace rtd::bus {

/// `full_name` without a slash before it: "slam/reset", "anna/slam/reset".
CallTopics call_topics(const std::string& full_name, CommandKind kind);

/// The service that a reply's topic and type belong to, its name without a slash before it; nothing for others.
struct ServiceName {
  std::string full_name;
  CommandKind kind = CommandKind::kTrigger;
};
std::optional<ServiceName> service_of(const std::string& reply_topic, const std::string& reply_type);

/// The argument of a switch, "true" or "false"; nothing for a text that is neither.
std::optional<std::string> switch_argument(const std::string& text);

/// `request.argument` fits the kind. The bytes begin with the CDR header.
std::vector<std::byte> encode_request(CommandKind kind, const CommandRequest& request);
std::vector<std::byte> encode_answer(const CommandAnswer& answer);
/// Throw std::runtime_error for bytes that do not hold one, whatever they claim.
CommandRequest decode_request(CommandKind kind, std::span<const std::byte> cdr);
CommandAnswer decode_answer(std::span<const std::byte> cdr);

}  // namespace rtd::bus
