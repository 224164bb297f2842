// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/ros2/message_json.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include <cmath>
#include <map>

#include "common/ros2/names.hpp"
#include "common/ros2/type_description.hpp"

namespace rtd::ros2 {
namespace {

using Json = nlohmann::ordered_json;
using Kind = MessageField::Kind;

constexpr std::size_t kValuesOfMessage = 4;

ros::Bytes body_of(ros::Bytes cdr) {
  constexpr std::size_t kHeaderBytes = 4;
  if (cdr.size() < kHeaderBytes || cdr[0] != 0 || cdr[1] != 1) {
    throw ros::WireError("the bytes are not plain little-endian CDR");
  }
  return cdr.subspan(kHeaderBytes);
}

/// Walks over a message by the fields of its type.
class Walk {
 public:
  Walk(ros::Bytes body, std::size_t most_values) : cursor_(body), most_values_(most_values) {}

  Json message(const std::string& type) {
    const std::vector<MessageField>* const fields = fields_of(type);
    if (fields == nullptr) throw ros::WireError("type " + type + " is unknown");
    Json value = Json::object();
    for (const MessageField& field : *fields) value[field.name] = read(field);
    return value;
  }

 private:
  Json read(const MessageField& field) {
    if (field.kind == Kind::kOne) return one(field);
    return many(field, field.kind == Kind::kSequence ? number<std::uint32_t>() : field.capacity);
  }

  Json one(const MessageField& field) {
    if (field.is_message()) return message(field.type);
    if (field.type == "string") return text();
    return kNumbers.at(field.type)(*this);
  }

  Json many(const MessageField& field, std::size_t count) {
    const std::size_t most =
        field.is_message() ? (most_values_ + kValuesOfMessage - 1) / kValuesOfMessage : most_values_;
    Json values = Json::array();
    for (std::size_t i = 0; i < count; ++i) {  // a wrong count ends in a WireError
      Json value = one(field);
      if (most == 0 || i < most) values.push_back(std::move(value));
    }
    if (values.size() == count) return values;
    return {{"count", count}, {"first", std::move(values)}};
  }

  std::string text() {
    const ros::Bytes bytes = cursor_.take(number<std::uint32_t>());
    const bool ended = !bytes.empty() && bytes.back() == 0;
    return ros::to_text(bytes.first(bytes.size() - (ended ? 1 : 0)));
  }

  template <class T>
  T number() {
    cursor_.take((sizeof(T) - cursor_.position() % sizeof(T)) % sizeof(T));
    return cursor_.read<T>();
  }
  template <class T>
  static Json integer(Walk& walk) {
    return walk.number<T>();
  }
  template <class T>
  static Json real(Walk& walk) {
    const T value = walk.number<T>();
    if (std::isfinite(value)) return std::stod(fmt::format("{}", value));  // 0.1F is 0.1, not 0.10000000149
    return std::isnan(value) ? "nan" : (value > 0 ? "inf" : "-inf");
  }
  static Json truth(Walk& walk) { return walk.number<std::uint8_t>() != 0; }

  static const std::map<std::string, Json (*)(Walk&)> kNumbers;

  ros::ByteCursor cursor_;
  const std::size_t most_values_;
};

const std::map<std::string, Json (*)(Walk&)> Walk::kNumbers = {{"bool", truth},
                                                               {"byte", integer<std::uint8_t>},
                                                               {"uint8", integer<std::uint8_t>},
                                                               {"int8", integer<std::int8_t>},
                                                               {"uint16", integer<std::uint16_t>},
                                                               {"int16", integer<std::int16_t>},
                                                               {"uint32", integer<std::uint32_t>},
                                                               {"int32", integer<std::int32_t>},
                                                               {"uint64", integer<std::uint64_t>},
                                                               {"int64", integer<std::int64_t>},
                                                               {"float32", real<float>},
                                                               {"float64", real<double>}};

}  // namespace

bool can_read(const std::string& dds_type) {
  return fields_of(short_type(dds_type)) != nullptr;
}

Json message_json(const std::string& dds_type, ros::Bytes cdr, std::size_t most_values) {
  if (!can_read(dds_type)) throw ros::WireError("type " + dds_type + " is unknown");
  return Walk(body_of(cdr), most_values).message(short_type(dds_type));
}

}  // namespace rtd::ros2
