// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace rtd::bus::fastdds {

/// What the type support of either version asks of a type.
class TypeFunctions {
 public:
  virtual ~TypeFunctions() = default;
  /// CDR header and fields; returns their size, 0: no room.
  virtual std::size_t write(const void* data, std::span<std::uint8_t> to) const = 0;
  virtual bool read(std::span<const std::uint8_t> cdr, void* data) const = 0;
  /// What write() will write.
  virtual std::uint32_t size_of(const void* data) const = 0;
  virtual void* create() const = 0;
  virtual void destroy(void* data) const = 0;
  /// Of a fixed size, the same in memory as in CDR.
  virtual bool plain() const = 0;
};

/// Fills Fast DDS's payload.
template <class Payload>
bool write_payload(const TypeFunctions& type, const void* data, Payload& payload, std::uint16_t little_endian,
                   std::uint16_t big_endian) {
  const std::size_t written = type.write(data, {payload.data, payload.max_size});
  payload.length = static_cast<std::uint32_t>(written);
  if (written > 0) payload.encapsulation = (payload.data[1] & 1U) != 0 ? little_endian : big_endian;
  return written > 0;
}

/// One instance for all keys: which bytes are the key is not known.
template <class Handle>
bool only_instance(Handle& handle) {
  for (int i = 0; i < 16; ++i) handle.value[i] = i == 0 ? 1 : 0;
  return true;
}

}  // namespace rtd::bus::fastdds
