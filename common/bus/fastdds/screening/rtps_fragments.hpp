// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace rtd::bus {

constexpr std::uint32_t kMaxFragmentedSample = 256U << 20U;

/// Whether each DATA_FRAG of a message, one by is_rtps_message(), carries the fragments that it announces, of a sample
/// of at most kMaxFragmentedSample octets.
bool has_whole_fragments(std::span<const std::byte> message);

}  // namespace rtd::bus
