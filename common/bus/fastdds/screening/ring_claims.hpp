// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace rtd::bus {

/// What RTPS messages say about our rings. Fast DDS believes each endpoint that announces their id: a reader that has
/// nothing in our folder then makes a writer look forever for an address to send a frame to. Immutable.
class RingClaims {
 public:
  /// Rings in `folder`; empty: none.
  RingClaims(std::string folder, std::uint64_t id) : folder_(std::move(folder)), id_(id) {}

  /// The message in which only endpoints have our id that have a file in our folder; empty when it is so already.
  /// Nothing when it cannot be checked: a part of an announcement, which no program sends that fits into one.
  std::optional<std::vector<std::byte>> checked(std::span<const std::byte> message) const;

 private:
  bool all_have_rings(std::span<const std::byte> announcement, std::size_t claim) const;

  std::string folder_;
  std::uint64_t id_;
};

}  // namespace rtd::bus
