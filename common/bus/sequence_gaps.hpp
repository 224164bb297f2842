// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>

#include "common/bus/raw_bus.hpp"

namespace rtd::bus {

/// Finds the samples that a reader did not get by the numbers that their writers gave them. The first number heard of a
/// writer is where its count begins: what it sent to others before is not lost.
class SequenceGaps {
 public:
  /// The samples missing before this one.
  std::optional<RawLoss> next(const WriterId& writer, std::int64_t sequence);
  void forget(const WriterId& writer) { newest_.erase(writer); }

 private:
  std::map<WriterId, std::int64_t> newest_;
};

}  // namespace rtd::bus
