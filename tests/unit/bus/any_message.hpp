// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "common/bus/message_cdr.hpp"
#include "tests/unit/bus/recorded_samples.hpp"

/// Messages of a type that is known at run time, so that a test's body is compiled once for all types.
namespace rtd::bus {

struct AnyMessageType {
  std::string name;  ///< "rtd_msgs/RgbdFrame"
  MessageId id;
  bool plain;
  std::size_t bytes;                                                   ///< of a plain one in memory
  std::shared_ptr<void> (*make)(int number, std::mt19937_64& random);  ///< make_message()
  std::size_t (*size)(const void* message);                            ///< cdr_size()
  std::size_t (*write)(const void* message, std::span<std::uint8_t>);  ///< write_cdr()
  bool (*read)(ros::Bytes, void* message);                             ///< read_cdr()
  std::uint64_t (*fingerprint)(const void* message);
};

template <class T>
AnyMessageType any_message_type() {
  using Traits = MessageTraits<T>;
  return {
      msg::type_name(msg::TypeOf<T>()),
      Traits::kId,
      Traits::kPlain,
      sizeof(T),
      [](int number, std::mt19937_64& random) -> std::shared_ptr<void> { return make_message<T>(number, random); },
      [](const void* message) { return cdr_size(*static_cast<const T*>(message)); },
      [](const void* message, std::span<std::uint8_t> cdr) { return write_cdr(*static_cast<const T*>(message), cdr); },
      [](ros::Bytes cdr, void* message) { return read_cdr(cdr, *static_cast<T*>(message)); },
      [](const void* message) -> std::uint64_t {
        if constexpr (Traits::kPlain)
          return 0;  // random bytes: compared in memory
        else
          return reflect::fingerprint(*static_cast<const T*>(message));
      }};
}

template <class... T>
std::vector<AnyMessageType> any_message_types(TypeList<T...>) {
  return {any_message_type<T>()...};
}

}  // namespace rtd::bus
