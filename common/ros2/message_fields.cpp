// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/ros2/message_fields.hpp"

#include <array>

#include "common/bus/message_types.hpp"
#include "common/ros_codec/wire.hpp"

namespace rtd::ros2 {
namespace {

template <class Number>
std::string word_of() {
  if constexpr (std::is_same_v<Number, bool>) return "bool";
  const std::string kind = std::is_floating_point_v<Number> ? "float" : std::is_signed_v<Number> ? "int" : "uint";
  return kind + std::to_string(8 * sizeof(Number));
}

/// Collects types from the lists of fields of their structs.
class Collector {
 public:
  template <class T>
  void add() {
    const std::string type = msg::type_name(msg::TypeOf<T>());
    if (types_.contains(type)) return;
    std::vector<MessageField> fields;
    msg::for_each_field_type<T>([&]<class Field>(const char* name) {
      MessageField& field = fields.emplace_back();
      field.name = name;
      describe(field, msg::TypeOf<Field>());
    });
    if (type == "diagnostic_msgs/DiagnosticStatus") fields.front().type = "byte";  // on the wire a uint8
    types_[type] = std::move(fields);
  }
  MessageFields take() { return std::move(types_); }

 private:
  template <class T>
  void describe(MessageField& field, msg::TypeOf<T>) {
    if constexpr (msg::Message<T>) {
      field.type = msg::type_name(msg::TypeOf<T>());
      add<T>();
    } else if constexpr (std::is_enum_v<T>) {
      field.type = word_of<std::underlying_type_t<T>>();
    } else if constexpr (ros::UnalignedNumber<T>) {
      field.type = word_of<typename T::Number>();
    } else {
      field.type = word_of<T>();
    }
  }
  void describe(MessageField& field, msg::TypeOf<std::string>) { field.type = "string"; }
  template <class T>
  void describe(MessageField& field, msg::TypeOf<std::vector<T>>) {
    describe(field, msg::TypeOf<T>());
    field.kind = MessageField::Kind::kSequence;
  }
  template <class T, std::size_t kSize>
  void describe(MessageField& field, msg::TypeOf<std::array<T, kSize>>) {
    describe(field, msg::TypeOf<T>());
    field.kind = MessageField::Kind::kArray;
    field.capacity = kSize;
  }

  MessageFields types_;
};

template <class... T>
MessageFields fields_of_all(bus::TypeList<T...>) {
  Collector collector;
  (collector.add<T>(), ...);
  return collector.take();
}

}  // namespace

const MessageFields& message_fields() {
  static const MessageFields kTypes = fields_of_all(bus::MessageTypes());
  return kTypes;
}

const std::vector<MessageField>* fields_of(const std::string& type) {
  const auto found = message_fields().find(type);
  return found == message_fields().end() ? nullptr : &found->second;
}

}  // namespace rtd::ros2
