// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/pace.hpp"

#include "common/service/config.hpp"

namespace rtd::service {

Pace parse_pace(const std::string& text) {
  if (text == "realtime") return Pace::kRealtime;
  if (text == "asap") return Pace::kAsap;
  if (text == "lockstep") return Pace::kLockstep;
  throw ConfigError("unknown pace '" + text + "': use realtime, asap or lockstep");
}

const char* to_string(Pace pace) {
  switch (pace) {
    case Pace::kRealtime:
      return "realtime";
    case Pace::kAsap:
      return "asap";
    case Pace::kLockstep:
      return "lockstep";
  }
  return "unknown";
}

}  // namespace rtd::service
