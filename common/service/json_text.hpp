// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace rtd::service {

/// A value of nlohmann's JSON as the tools print it. Names and texts from files of other programs need not be UTF-8:
/// each of their invalid bytes becomes U+FFFD, where dump() alone throws.
template <class Json>
std::string json_text(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace);
}

/// The same on one line.
template <class Json = nlohmann::json>
std::string json_line(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace rtd::service
