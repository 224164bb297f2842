// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/viewer/core/command_forms.hpp"

#include <nlohmann/json.hpp>
#include <stdexcept>

#include "common/bus/command_codec.hpp"
#include "common/service/json_text.hpp"

namespace rtd::viewer {
namespace {

using nlohmann::json;

std::optional<std::string> read_json(CommandKind kind, std::span<const std::byte> payload) {
  const auto* text = reinterpret_cast<const char*>(payload.data());
  const json request = json::parse(text, text + payload.size(), nullptr, false);
  if (kind == CommandKind::kTrigger) return "";
  if (!request.is_object()) return std::nullopt;
  const auto value = request.find(kind == CommandKind::kSetBool ? "data" : "argument");
  if (value == request.end()) return std::nullopt;
  if (kind == CommandKind::kSetBool && value->is_boolean()) return value->get<bool>() ? "true" : "false";
  if (kind == CommandKind::kText && value->is_string()) return value->get<std::string>();
  return std::nullopt;
}

std::optional<std::string> read_cdr(CommandKind kind, std::span<const std::byte> payload) {
  try {
    return bus::decode_request(kind, payload).argument;
  } catch (const std::runtime_error&) {
    return std::nullopt;
  }
}

}  // namespace

const char* request_schema(CommandKind kind) {
  if (kind == CommandKind::kSetBool) return "bool data\n";
  return kind == CommandKind::kText ? "string argument\n" : "";
}

const char* response_schema() {
  return "bool success\nstring message\n";
}

std::optional<std::string> read_command_request(CommandKind kind, const std::string& encoding,
                                                std::span<const std::byte> payload) {
  if (encoding == "json") return read_json(kind, payload);
  return encoding == "cdr" ? read_cdr(kind, payload) : std::nullopt;
}

Bytes command_response(const std::string& encoding, const CommandResult& result) {
  if (encoding == "cdr") return bus::encode_answer(result);
  const std::string text = service::json_line({{"success", result.success}, {"message", result.message}});
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

}  // namespace rtd::viewer
