// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/viewer/core/command_forms.hpp"

#include <cstring>
#include <nlohmann/json.hpp>

#include "common/service/json_text.hpp"

namespace rtd::viewer {
namespace {

using nlohmann::json;

constexpr std::size_t kCdrHeader = 4;

std::optional<std::string> read_json(ArgumentKind kind, std::span<const std::byte> payload) {
  const auto* text = reinterpret_cast<const char*>(payload.data());
  const json request = json::parse(text, text + payload.size(), nullptr, false);
  if (kind == ArgumentKind::kNone) return "";
  if (!request.is_object()) return std::nullopt;
  const auto value = request.find(kind == ArgumentKind::kBool ? "data" : "argument");
  if (value == request.end()) return std::nullopt;
  if (kind == ArgumentKind::kBool && value->is_boolean()) return value->get<bool>() ? "true" : "false";
  if (kind == ArgumentKind::kText && value->is_string()) return value->get<std::string>();
  return std::nullopt;
}

std::optional<std::string> read_cdr(ArgumentKind kind, std::span<const std::byte> payload) {
  if (kind == ArgumentKind::kNone) return "";
  if (payload.size() <= kCdrHeader || payload[1] != std::byte{1}) return std::nullopt;  // little-endian only
  payload = payload.subspan(kCdrHeader);
  if (kind == ArgumentKind::kBool) return payload[0] != std::byte{0} ? "true" : "false";
  std::uint32_t size = 0;
  if (payload.size() < sizeof(size)) return std::nullopt;
  std::memcpy(&size, payload.data(), sizeof(size));
  if (size == 0 || size > payload.size() - sizeof(size)) return std::nullopt;
  return std::string(reinterpret_cast<const char*>(payload.data()) + sizeof(size), size - 1);
}

}  // namespace

const char* service_type(ArgumentKind kind) {
  if (kind == ArgumentKind::kBool) return "std_srvs/srv/SetBool";
  return kind == ArgumentKind::kText ? "rtd_msgs/srv/Command" : "std_srvs/srv/Trigger";
}

const char* request_schema(ArgumentKind kind) {
  if (kind == ArgumentKind::kBool) return "bool data\n";
  return kind == ArgumentKind::kText ? "string argument\n" : "";
}

const char* response_schema() {
  return "bool success\nstring message\n";
}

std::optional<std::string> read_command_request(ArgumentKind kind, const std::string& encoding,
                                                std::span<const std::byte> payload) {
  if (encoding == "json") return read_json(kind, payload);
  return encoding == "cdr" ? read_cdr(kind, payload) : std::nullopt;
}

Bytes command_response(const std::string& encoding, const CommandResult& result) {
  ByteWriter writer;
  if (encoding == "json") {
    const std::string text = service::json_line({{"success", result.success}, {"message", result.message}});
    writer.put_bytes(text.data(), text.size());
    return writer.take();
  }
  writer.put(std::uint32_t{0x00000100});  // CDR, little-endian
  writer.put(std::uint32_t{result.success});
  writer.put(static_cast<std::uint32_t>(result.message.size() + 1));
  writer.put_bytes(result.message.c_str(), result.message.size() + 1);
  return writer.take();
}

}  // namespace rtd::viewer
