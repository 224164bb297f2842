// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <type_traits>

/// The one list of a message's fields. One line next to each struct of common/msg, in namespace rtd::msg:
///   RTD_FIELDS(builtin_interfaces, Time, sec, nanosec)
/// names its ROS package, the struct and all its fields, in the order of the wire. Codecs, schemas, type hashes and
/// tools go by it; tests/unit/bus proves that the IDL files and the code that both DDS vendors generate agree with it.
namespace rtd::msg {

/// Which message type a function is about, where there is no message.
template <class T>
struct TypeOf {};

template <class T>
concept Message = requires {
  type_name(TypeOf<T>());
};

/// Calls visit(name, field) with each field of the message, which may be const.
template <class T, class Visit>
requires Message<std::remove_const_t<T>>
constexpr void for_each_field(T& message, Visit&& visit) {
  for_each_member(TypeOf<std::remove_const_t<T>>(),
                  [&](const char* name, auto member) { visit(name, message.*member); });
}

/// Calls visit.operator()<Field>(name) with the type and the name of each field of T.
template <Message T, class Visit>
constexpr void for_each_field_type(Visit&& visit) {
  for_each_member(TypeOf<T>(),
                  [&]<class Field>(const char* name, Field T::*) { visit.template operator()<Field>(name); });
}

}  // namespace rtd::msg

#define RTD_FIELDS(package, Type, ...) RTD_FIELDS_OF(Type, #package "/" #Type, __VA_ARGS__)

/// The same for a struct that does not have the name of its ROS type.
#define RTD_FIELDS_OF(Type, name, ...)                         \
  constexpr const char* type_name(TypeOf<Type>) {              \
    return name;                                               \
  }                                                            \
  constexpr void for_each_member(TypeOf<Type>, auto&& visit) { \
    RTD_EXPAND(RTD_EACH_FIELD(Type, __VA_ARGS__))              \
  }

#define RTD_EACH_FIELD(Type, field, ...) \
  visit(#field, &Type::field);           \
  __VA_OPT__(RTD_NEXT_FIELD RTD_PARENTHESES(Type, __VA_ARGS__))
#define RTD_NEXT_FIELD() RTD_EACH_FIELD
#define RTD_PARENTHESES ()
#define RTD_EXPAND(...) RTD_EXPAND_9(RTD_EXPAND_9(RTD_EXPAND_9(__VA_ARGS__)))  // 27 fields at most
#define RTD_EXPAND_9(...) RTD_EXPAND_3(RTD_EXPAND_3(RTD_EXPAND_3(__VA_ARGS__)))
#define RTD_EXPAND_3(...) RTD_EXPAND_1(RTD_EXPAND_1(RTD_EXPAND_1(__VA_ARGS__)))
#define RTD_EXPAND_1(...) __VA_ARGS__
