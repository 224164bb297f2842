// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <span>

#include "common/bus/writer_id.hpp"

namespace rtd::bus::cyclonedds {

/// What the readers of this process take from each writer at most. Thread-safe.
class SampleLimits {
 public:
  /// Cyclone has one largest sample for a domain. When a datagram arrives for it, the first fragment of a sample that
  /// is too large for its own topic is made to say that the sample is larger than that: Cyclone then gives it up, as if
  /// the writer had said that it is gone. Its other fragments become padding. Not with AddressSanitizer or
  /// ThreadSanitizer, and not what is encrypted: that is refused when it is complete.
  static SampleLimits& of_process();

  /// A reader that takes so many bytes is matched with these writers, and no others.
  void note(const void* reader, const std::set<WriterId>& writers, std::size_t largest);
  /// The most that a reader takes; nothing: none is matched with that writer.
  std::optional<std::size_t> of(const WriterId& writer) const;
  /// Changes a datagram that has arrived.
  void mark_too_large(std::span<std::byte> datagram) const;

 private:
  mutable std::mutex mutex_;
  std::map<WriterId, std::map<const void*, std::size_t>> largest_;  ///< by reader
};

}  // namespace rtd::bus::cyclonedds
