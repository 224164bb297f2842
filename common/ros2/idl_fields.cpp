// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/ros2/idl_fields.hpp"

#include <regex>

#include "common/ros2/definition_texts.hpp"
#include "common/ros2/names.hpp"

namespace rtd::ros2 {
namespace {

using Types = std::map<std::string, std::vector<MessageField>>;
constexpr const char* kOwnPackage = "rtd_msgs";

/// In the words of .msg files.
std::string msg_type(const std::string& idl_type, const std::string& package) {
  static const std::map<std::string, std::string> kWords = {{"octet", "uint8"},     {"boolean", "bool"},
                                                            {"short", "int16"},     {"unsigned short", "uint16"},
                                                            {"long", "int32"},      {"unsigned long", "uint32"},
                                                            {"float", "float32"},   {"double", "float64"},
                                                            {"long long", "int64"}, {"unsigned long long", "uint64"},
                                                            {"string", "string"}};
  if (const auto word = kWords.find(idl_type); word != kWords.end()) return word->second;
  const std::string other = short_type(idl_type);
  if (!other.empty()) return other;
  return package + '/' + idl_type.substr(0, idl_type.size() - 1);
}

std::vector<MessageField> fields_of_body(const std::string& body, const std::string& package) {
  static const std::regex kField(R"((sequence<)?(\w[\w: ]*\w)(>)?\s+(\w+)(?:\[(\d+)\])?;)");
  using Kind = MessageField::Kind;
  std::vector<MessageField> fields;
  for (std::sregex_iterator f(body.begin(), body.end(), kField), end; f != end; ++f) {
    MessageField field{msg_type((*f)[2], package), (*f)[4], Kind::kOne, 0};
    if ((*f)[1].matched) field.kind = Kind::kSequence;
    if ((*f)[5].matched) {
      field.kind = Kind::kArray;
      field.capacity = static_cast<std::uint32_t>(std::stoul((*f)[5]));
    }
    fields.push_back(field);
  }
  return fields;
}

Types all_types() {
  Types types = idl_fields(own_idl(), kOwnPackage);
  for (const auto& [type, text] : message_texts()) types[type] = fields_of(text, type.substr(0, type.find('/')));
  return types;
}

}  // namespace

Types idl_fields(const std::string& idl, const std::string& package) {
  static const std::regex kStruct(R"(struct (\w+)_ \{([^}]*)\})");
  Types types;
  for (std::sregex_iterator s(idl.begin(), idl.end(), kStruct), end; s != end; ++s) {
    types[package + '/' + (*s)[1].str()] = fields_of_body((*s)[2], package);
  }
  return types;
}

const std::vector<MessageField>* known_fields(const std::string& type) {
  static const Types kTypes = all_types();
  const auto found = kTypes.find(type);
  return found == kTypes.end() ? nullptr : &found->second;
}

std::string short_type(const std::string& dds_type) {
  const std::string name = ros_type(dds_type);
  const std::size_t infix = name.find("/msg/");
  return infix == std::string::npos ? std::string() : name.substr(0, infix) + name.substr(infix + 4);
}

}  // namespace rtd::ros2
