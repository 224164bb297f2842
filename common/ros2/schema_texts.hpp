// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "common/ros2/type_description.hpp"

/// DDS carries the names of types, but not their texts. A replay publishes those of its recording, latched, so that a
/// recorder keeps the texts of types that are not built in.
namespace rtd::ros2 {

inline constexpr char kSchemasTopic[] = "rtd/schemas";
inline constexpr char kSchemasType[] = "rtd_msgs::msg::dds_::SchemaTexts_";

/// A type by its DDS name, and how a recording describes it.
struct SchemaText {
  std::string dds_type;
  TypeDefinition definition;
};

/// As a sample in CDR.
std::vector<std::byte> encode_schemas(const std::vector<SchemaText>& schemas);

/// Throws ros::WireError when the bytes are no such sample.
std::vector<SchemaText> decode_schemas(std::span<const std::byte> cdr);

}  // namespace rtd::ros2
