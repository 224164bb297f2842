// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace rtd::recorder {

/// When a new file begins. Both 0: never.
struct SplitPolicy {
  std::uint64_t bytes = 0;        ///< a file does not grow beyond this, unless one message does
  std::uint64_t duration_ns = 0;  ///< between the first and the last message of a file

  bool on() const { return bytes > 0 || duration_ns > 0; }
  /// Whether a file of that size, whose first message has that time, has room for one more message.
  bool has_room(std::uint64_t file_bytes, std::uint64_t message_bytes, std::uint64_t first_ns,
                std::uint64_t now_ns) const;
};

/// "500MB", "1GiB", "60s", "5min", "1h"; empty: no text of that kind.
std::optional<SplitPolicy> parse_split(const std::string& text);

}  // namespace rtd::recorder
