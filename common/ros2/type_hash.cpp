// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/ros2/type_hash.hpp"

#include <fmt/format.h>
#include <openssl/sha.h>

#include <set>

#include "common/ros2/names.hpp"

namespace rtd::ros2 {
namespace {

const std::string kPrefix = "RIHS01_", kKey = "typehash=";

/// The numbers of type_description_interfaces/msg/FieldType.
int type_id(const MessageField& field) {
  static const std::map<std::string, int> kPrimitive = {
      {"int8", 2},   {"uint8", 3},    {"int16", 4},    {"uint16", 5}, {"int32", 6}, {"uint32", 7}, {"int64", 8},
      {"uint64", 9}, {"float32", 10}, {"float64", 11}, {"bool", 15},  {"byte", 16}, {"string", 17}};
  constexpr int kMessage = 1;
  constexpr int kOffset[] = {0, 48, 144};  // by MessageField::Kind
  return (field.is_message() ? kMessage : kPrimitive.at(field.type)) + kOffset[static_cast<int>(field.kind)];
}

/// "package/Type" as descriptions name it.
std::string full_name(const std::string& type) {
  const std::size_t slash = type.find('/');
  return type.substr(0, slash) + "/msg" + type.substr(slash);
}

std::string describe(const MessageField& field) {
  return fmt::format(
      R"({{"name": "{}", "type": {{"type_id": {}, "capacity": {}, "string_capacity": 0, "nested_type_name": "{}"}}}})",
      field.name, type_id(field), field.capacity, field.is_message() ? full_name(field.type) : "");
}

std::string describe(const std::string& type, const MessageFields& types) {
  std::string fields;
  for (const MessageField& field : types.at(type)) {
    fields += (fields.empty() ? "" : ", ") + describe(field);
  }
  return fmt::format(R"({{"type_name": "{}", "fields": [{}]}})", full_name(type), fields);
}

/// The messages that one is made of, in the order of their names.
void add_parts(const std::string& type, const MessageFields& types, std::set<std::string>& parts) {
  for (const MessageField& field : types.at(type)) {
    if (field.is_message() && parts.insert(field.type).second) add_parts(field.type, types, parts);
  }
}

std::string description(const std::string& type, const MessageFields& types) {
  std::set<std::string> parts;
  add_parts(type, types, parts);
  std::string referenced;
  for (const std::string& part : parts) referenced += (referenced.empty() ? "" : ", ") + describe(part, types);
  return fmt::format(R"({{"type_description": {}, "referenced_type_descriptions": [{}]}})", describe(type, types),
                     referenced);
}

}  // namespace

std::string type_hash(const std::string& type, const MessageFields& types) {
  const std::string text = description(type, types);
  unsigned char digest[SHA256_DIGEST_LENGTH];
  SHA256(reinterpret_cast<const unsigned char*>(text.data()), text.size(), digest);
  std::string hash = kPrefix;
  for (const unsigned char byte : digest) hash += fmt::format("{:02x}", byte);
  return hash;
}

std::string type_hash(const std::string& dds_type) {
  const std::string type = short_type(dds_type);
  const bool known = fields_of(type) != nullptr && !type.starts_with("rtd_msgs/");
  return known ? type_hash(type, message_fields()) : std::string();
}

std::string user_data_of(const std::string& dds_type) {
  const std::string hash = type_hash(dds_type);
  return hash.empty() ? std::string() : kKey + hash + ';';
}

std::string hash_in(const std::string& user_data) {
  const std::size_t begin = user_data.find(kKey);
  const bool is_key = begin == 0 || (begin != std::string::npos && user_data[begin - 1] == ';');
  if (!is_key) return {};
  const std::size_t value = begin + kKey.size();
  return user_data.substr(value, user_data.find(';', value) - value);
}

}  // namespace rtd::ros2
