// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

namespace rtd::bus {

/// GUID of a writer: prefix of its participant and its entity id.
using WriterGuid = std::array<std::byte, 16>;

struct WriterNumber {
  WriterGuid writer;
  std::uint64_t number;
};

/// Of discovery and the like, in bytes.
constexpr std::uint32_t kLargestBuiltinSample = 1U << 20U;

/// A DATA_FRAG whose fragments are whole.
struct SampleFragments {
  WriterGuid writer;
  std::uint32_t first_fragment = 0;  ///< they count from 1
  std::uint32_t sample_bytes = 0;
  std::size_t at = 0;                             ///< in the datagram
  static constexpr std::size_t kSizeBehind = 32;  ///< from there to the 4 bytes of sample_bytes
};

/// What a datagram has in it, as far as Fast DDS relies on it without a check.
struct RtpsMessage {
  /// The frame of an RTPS message: header, known submessages one behind the other, each of a whole number of words, the
  /// last one ending with the datagram.
  bool well_formed = false;
  /// Each DATA_FRAG carries the fragments that it announces, of a sample that is not too large. By its first fragment
  /// alone the readers of a larger one give it up: without that they would ask for it again and again.
  bool whole_fragments = true;
  /// The largest sequence number that DATA, DATA_FRAG, HEARTBEAT, HEARTBEAT_FRAG and GAP name, for each writer.
  /// Submessages too short for their numbers are passed over.
  std::vector<WriterNumber> numbers;
  std::vector<SampleFragments> fragments;
};

/// Reads up to the first submessage that breaks the frame.
RtpsMessage read_rtps_message(std::span<const std::byte> datagram);

/// A message without its last submessage when that has so many bytes, with its header, whatever it is; else all of it.
std::span<const std::byte> without_last(std::span<const std::byte> message, std::size_t bytes);

/// Whether a writer may have come to a sequence number: none is far beyond all that it has named so far, unless it goes
/// on naming such numbers and no others, as one does that has been writing for days before it is first matched.
class NumberGuard {
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
  NumberGuard guard_;
};

}  // namespace rtd::bus
