// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace rtd::service {

/// "1.54 MB", "812 B": decimal units, three digits.
std::string bytes_text(std::uint64_t bytes);
/// "12.345 s" of a duration.
std::string seconds_text(std::uint64_t duration_ns);
/// "2026-11-21 14:03:12.512 UTC" for times of this century, else seconds.
std::string time_text(std::uint64_t time_ns);

}  // namespace rtd::service
