// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace rtd::eval {

/// RFC 4648 base64.
std::string to_base64(const std::vector<std::uint8_t>& bytes);

/// The bytes of a base64 text with padding. Throws std::invalid_argument when it is not one.
std::vector<std::uint8_t> from_base64(std::string_view text);

}  // namespace rtd::eval
