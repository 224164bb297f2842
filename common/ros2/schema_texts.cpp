// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/ros2/schema_texts.hpp"

#include <utility>

#include "common/msg/fields.hpp"
#include "common/ros_codec/wire.hpp"

namespace rtd::msg {

struct WireSchema {
  std::string dds_type, name, encoding, text;
};
RTD_FIELDS(rtd_msgs, WireSchema, dds_type, name, encoding, text)
struct WireSchemas {
  std::vector<WireSchema> schemas;
};
RTD_FIELDS(rtd_msgs, WireSchemas, schemas)

}  // namespace rtd::msg

namespace rtd::ros2 {

std::vector<std::byte> encode_schemas(const std::vector<SchemaText>& schemas) {
  msg::WireSchemas message;
  for (const auto& [dds_type, definition] : schemas)
    message.schemas.push_back({dds_type, definition.name, definition.encoding, definition.text});
  return ros::encode_cdr(message);
}

std::vector<SchemaText> decode_schemas(std::span<const std::byte> cdr) {
  const std::span bytes(reinterpret_cast<const std::uint8_t*>(cdr.data()), cdr.size());
  auto message = ros::decode<msg::WireSchemas>(ros::Wire::kCdr, bytes);
  std::vector<SchemaText> schemas;
  for (msg::WireSchema& schema : message.schemas)
    schemas.push_back(
        {std::move(schema.dds_type), {std::move(schema.name), std::move(schema.encoding), std::move(schema.text)}});
  return schemas;
}

}  // namespace rtd::ros2
