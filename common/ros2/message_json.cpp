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
constexpr std::size_t kFreeSteps = 1'000, kStepsPerByte = 16;  // a value has a byte, and a few messages around it

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
  Walk(const MessageFields& types, ros::Wire wire, ros::Bytes bytes, std::size_t most_values)
      : types_(types),
        wire_(wire),
        cursor_(wire == ros::Wire::kCdr ? body_of(bytes) : bytes),
        most_values_(most_values),
        steps_left_(kFreeSteps + kStepsPerByte * bytes.size()) {}

  Json message(const std::string& type) {
    const auto fields = types_.find(type);
    if (fields == types_.end()) throw ros::WireError("type " + type + " is unknown");
    if (type == "std_msgs/Header" && wire_ == ros::Wire::kRos1 && !counted(fields->second)) number<std::uint32_t>();
    Json value = Json::object();
    for (const MessageField& field : fields->second) value[field.name] = read(field);
    if (fields->second.empty() && wire_ == ros::Wire::kCdr && cursor_.remaining() > 0) number<std::uint8_t>();
    return value;
  }

 private:
  static bool counted(const std::vector<MessageField>& header) {
    return !header.empty() && header.front().name == "seq";
  }

  Json read(const MessageField& field) {
    if (field.kind == Kind::kOne) return one(field);
    return many(field, field.kind == Kind::kSequence ? number<std::uint32_t>() : field.capacity);
  }

  /// Types can be made of nothing: what they claim must not cost more than the bytes are worth.
  Json one(const MessageField& field) {
    if (steps_left_-- == 0) throw ros::WireError("the type claims more fields than the message has bytes");
    if (field.is_message()) return message(field.type);
    if (field.type == "string") return text();
    const auto found = kNumbers.find(field.type);
    if (found == kNumbers.end())
      throw ros::WireError("field " + field.name + " is of type " + field.type + ", which cannot be read");
    return found->second(*this);
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
    const bool ended = wire_ == ros::Wire::kCdr && !bytes.empty() && bytes.back() == 0;
    return ros::to_text(bytes.first(bytes.size() - (ended ? 1 : 0)));
  }

  template <class T>
  T number() {
    if (wire_ == ros::Wire::kCdr) cursor_.take((sizeof(T) - cursor_.position() % sizeof(T)) % sizeof(T));
    return cursor_.read<T>();
  }
  template <class T>
  static Json integer(Walk& walk) {
    return walk.number<T>();
  }
  template <class T>
  static Json real(Walk& walk) {
    const T value = walk.number<T>();
    if (!std::isfinite(value)) return std::isnan(value) ? "nan" : (value > 0 ? "inf" : "-inf");
    if constexpr (std::is_same_v<T, double>) return value;
    return std::stod(fmt::format("{}", value));  // 0.1F is 0.1, not 0.10000000149
  }
  template <class Seconds, class Nanoseconds>
  static Json time(Walk& walk) {
    const Seconds sec = walk.number<Seconds>();
    return {{"sec", sec}, {"nanosec", walk.number<Nanoseconds>()}};
  }
  static Json truth(Walk& walk) { return walk.number<std::uint8_t>() != 0; }

  static const std::map<std::string, Json (*)(Walk&)> kNumbers;

  const MessageFields& types_;
  const ros::Wire wire_;
  ros::ByteCursor cursor_;
  const std::size_t most_values_;
  std::size_t steps_left_;
};

const std::map<std::string, Json (*)(Walk&)> Walk::kNumbers = {{"bool", truth},
                                                               {"byte", integer<std::uint8_t>},
                                                               {"char", integer<std::uint8_t>},
                                                               {"time", time<std::uint32_t, std::uint32_t>},
                                                               {"duration", time<std::int32_t, std::int32_t>},
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
  return message_json(message_fields(), short_type(dds_type), ros::Wire::kCdr, cdr, most_values);
}

Json message_json(const MessageFields& types, const std::string& type, ros::Wire wire, ros::Bytes bytes,
                  std::size_t most_values) {
  return Walk(types, wire, bytes, most_values).message(type);
}

}  // namespace rtd::ros2
