// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>

#include "common/bus/fastdds/screening/rtps_message.hpp"

namespace rtd::bus {

/// Whether a writer may have come to a sequence number: none is far beyond all that it has named so far, unless it goes
/// on naming such numbers and no others, as one does that has been writing for days before it is first matched.
class SequenceGuard {
 public:
  /// The largest of one message.
  bool plausible(const WriterGuid& writer, std::uint64_t number);

  static constexpr std::uint64_t kFar = 1 << 20;  ///< Fast DDS goes through them one by one, in about half a second
  static constexpr int kMessages = 4;             ///< with far numbers in a row until they are believed
  static constexpr std::size_t kWriters = 4096;   ///< remembered

 private:
  struct Known {
    std::uint64_t highest = 0, doubtful = 0;
    int in_a_row = 0;
  };
  std::map<WriterGuid, Known> known_;
};

/// Checks the datagrams of a participant, one at a time.
class RtpsScreen {
 public:
  /// Whether it is an RTPS message whose fragments are whole and whose sequence numbers are plausible.
  bool passes(std::span<const std::byte> datagram);

 private:
  SequenceGuard guard_;
};

}  // namespace rtd::bus
