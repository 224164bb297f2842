// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace rtd::bus::cyclonedds {

/// Finds in Cyclone's discovery trace the participants that a secured one cannot meet: Cyclone 0.10 tells of them
/// nowhere else. A new participant is announced there with its name and whether it has a certificate, a handshake that
/// goes well with its GUID, one that fails without it: then the only one not yet proven is meant, or else all that
/// have not been for some seconds. Reads no clock; not thread-safe.
class Strangers {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;

  explicit Strangers(std::uint32_t domain) : domain_(domain) {}
  /// What to tell of a line, without its header. Of each stranger once.
  std::vector<std::string> hear(std::string_view line, TimePoint now);

 private:
  struct Participant {
    std::string name;
    TimePoint since;
    bool told = false;
  };
  std::vector<std::string> appeared(std::string_view line, TimePoint now);
  std::vector<std::string> refused(TimePoint now);

  const std::uint32_t domain_;
  std::map<std::string, Participant> unproven_;  ///< by GUID
};

}  // namespace rtd::bus::cyclonedds
