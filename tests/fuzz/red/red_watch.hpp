// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "common/msg/plausible.hpp"

namespace rtd::testing {

/// What an attacker process counts and demands: `NAME [MESSAGES [SEED]]`. No call takes more than a second of
/// computing time, the memory of the process grows by at most 64 MiB once it has settled (both limits do not hold in
/// builds with sanitizers, which are slower and larger), and a third of the messages pass the bus's edge, so that the
/// core is reached.
class RedWatch {
 public:
  RedWatch(const char* name, std::uint64_t messages, int argc, char** argv);

  std::uint64_t seed() const { return seed_; }
  /// Whether the attack continues.
  bool more() const { return messages_ < wanted_; }
  std::uint64_t messages() const { return messages_; }

  /// Counts a message; whether it passes the edge of the bus.
  template <class Message>
  bool passes(const Message& message) {
    ++messages_;
    const bool plausible = msg::is_plausible(message);
    passed_ += plausible ? 1 : 0;
    return plausible;
  }
  /// What the core does with a message.
  void call(const char* what, const std::function<void()>& core);
  /// From now on memory counts.
  void settled();
  /// Prints the figures; the exit code.
  int finish();

 private:
  const std::string name_;
  std::uint64_t wanted_, seed_;
  std::uint64_t messages_ = 0, passed_ = 0, calls_ = 0;
  double longest_s_ = 0;
  std::string longest_;
  std::uint64_t settled_kib_ = 0;
};

}  // namespace rtd::testing
