// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/command_codec.hpp"

#include <array>
#include <string_view>

#include "common/msg/commands.hpp"
#include "common/ros_codec/wire.hpp"

namespace rtd::bus {
namespace {

constexpr std::string_view kResponseEnd = "_Response_";

struct ServiceType {
  CommandKind kind;
  const char* package;
  const char* name;
  std::string dds(const char* part) const { return std::string(package) + "::srv::dds_::" + name + part; }
};
constexpr std::array<ServiceType, 3> kTypes = {{{CommandKind::kTrigger, "std_srvs", "Trigger"},
                                                {CommandKind::kSetBool, "std_srvs", "SetBool"},
                                                {CommandKind::kText, "rtd_msgs", "Command"}}};

const ServiceType& type_of(CommandKind kind) {
  for (const ServiceType& type : kTypes) {
    if (type.kind == kind) return type;
  }
  throw BusError("command kind " + std::to_string(static_cast<int>(kind)) + " is not one of common/bus/commands.hpp");
}

template <class Message>
Message decode(std::span<const std::byte> cdr) {
  return ros::decode<Message>(ros::Wire::kCdr, {reinterpret_cast<const std::uint8_t*>(cdr.data()), cdr.size()});
}

}  // namespace

std::string ros_type(CommandKind kind) {
  const ServiceType& type = type_of(kind);
  return std::string(type.package) + "/srv/" + type.name;
}

CallTopics call_topics(const std::string& full_name, CommandKind kind) {
  const ServiceType& type = type_of(kind);
  return {"rq/" + full_name + "Request", type.dds("_Request_"), "rr/" + full_name + "Reply", type.dds("_Response_")};
}

std::optional<ServiceName> service_of(const std::string& reply_topic, const std::string& reply_type) {
  const std::string name(service_of_reply(reply_topic));
  if (name.empty()) return std::nullopt;
  for (const ServiceType& type : kTypes) {
    if (reply_type == type.dds("_Response_")) return ServiceName{name, type.kind};
  }
  return std::nullopt;
}

std::optional<std::string> switch_argument(const std::string& text) {
  for (const char* on : {"true", "on", "1"}) {
    if (text == on) return "true";
  }
  for (const char* off : {"false", "off", "0"}) {
    if (text == off) return "false";
  }
  return std::nullopt;
}

std::vector<std::byte> encode_request(CommandKind kind, const CommandRequest& request) {
  switch (kind) {
    case CommandKind::kTrigger:
      return ros::encode_cdr(msg::TriggerRequest{});
    case CommandKind::kSetBool:
      return ros::encode_cdr(msg::SetBoolRequest{request.argument == "true"});
    case CommandKind::kText:
      return ros::encode_cdr(msg::CommandRequest{request.argument});
  }
  return {};
}

std::vector<std::byte> encode_answer(const CommandAnswer& answer) {
  return ros::encode_cdr(msg::CommandReply{answer.success, answer.message});
}

CommandRequest decode_request(CommandKind kind, std::span<const std::byte> cdr) {
  switch (kind) {
    case CommandKind::kTrigger:
      break;  // its one byte means nothing
    case CommandKind::kSetBool:
      return {decode<msg::SetBoolRequest>(cdr).data ? "true" : "false"};
    case CommandKind::kText:
      return {decode<msg::CommandRequest>(cdr).argument};
  }
  return {};
}

CommandAnswer decode_answer(std::span<const std::byte> cdr) {
  msg::CommandReply reply = decode<msg::CommandReply>(cdr);
  return {reply.success, std::move(reply.message)};
}

}  // namespace rtd::bus
