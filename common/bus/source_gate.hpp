// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "common/bus/qos.hpp"
#include "common/bus/writer_id.hpp"

namespace rtd::bus {

/// Lets the messages of one source pass: of the connection that came first. It keeps its place while its writer is
/// matched, whatever others send, and loses it when its writer or its process is gone, or after a long silence. Its
/// successor has the place at once; one that sent next to it waits for the long silence. One that only fell silent has
/// its place back with its next message. Sources are identified by their writers' ids, not by their messages' content.
///
/// Thread-safe; several readers may share a gate, then all their messages come from one connection.
class SourceGate : public std::enable_shared_from_this<SourceGate> {
 public:
  using Clock = std::function<std::int64_t()>;
  /// What happens to the place; `source` has it now, `other` does not.
  enum class Event {
    kFirst,    ///< the first source of all
    kTaken,    ///< by `source`, for `other` has gone
    kSilent,   ///< by `source`, for `other` fell silent
    kBack,     ///< by `source`, which had it before `other`
    kRefused,  ///< `other` sends, too
  };
  using Report = std::function<void(Event event, const ParticipantId& source, const ParticipantId& other)>;

  struct Options {
    /// So long does a matched source that sends nothing keep its place.
    std::int64_t silence_ns = kSilenceNs;
    /// Whether one that sent next to a source waits for the silence after that source's end, too.
    bool successors_only = true;
    Clock clock;  ///< monotonic, ns
    /// Whether the process of a connection is known to have ended before its writers are given up. May be empty.
    std::function<bool(const ParticipantId&)> gone;
    /// Called under no lock, on the thread of the message. May be empty.
    Report report;
  };
  static constexpr std::int64_t kSilenceNs = 10'000'000'000;

  explicit SourceGate(Options options) : options_(std::move(options)) {}

  /// Whether a message of this writer passes.
  bool accepts(const WriterId& writer);
  /// As StatusCallbacks::on_writer.
  void note(const WriterId& writer, bool matched);
  /// The callbacks of a reader behind this gate. They share the gate, which a shared_ptr must own: an endpoint may
  /// report until it ends.
  StatusCallbacks callbacks();
  /// Grows whenever messages begin to come from another source, the first not counted: what was learned from the one
  /// before may not fit.
  std::uint64_t changes() const;
  /// Messages that did not pass.
  std::uint64_t refused() const;
  std::optional<ParticipantId> source() const;
  /// Whether a writer of that connection is matched. In a secured domain its permissions allow the topic then.
  bool matched(const ParticipantId& connection) const;

 private:
  struct Claim {
    ParticipantId source{};
    std::int64_t received_ns = 0;
    bool present = true;
  };
  struct Verdict {
    bool passes = false;
    std::optional<Event> event;
    ParticipantId source{}, other{};
  };
  Verdict judge(const WriterId& writer, std::int64_t now_ns);
  Verdict take(std::size_t place, std::int64_t now_ns, Event event);
  Verdict refuse(const ParticipantId& source, std::int64_t now_ns);
  bool sent_beside_holder(const ParticipantId& source) const;
  std::size_t place_of(const ParticipantId& source) const;
  std::size_t claim(const ParticipantId& source);
  bool holder_gone(std::int64_t now_ns) const;
  bool holder_silent(std::int64_t now_ns) const;

  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

  const Options options_;
  mutable std::mutex mutex_;
  std::vector<Claim> claims_;                               ///< sources that had the place, by their first message
  std::size_t holder_ = kNone;                              ///< in claims_
  std::map<ParticipantId, int> matched_;                    ///< how many of its writers
  std::map<ParticipantId, std::int64_t> refused_since_ns_;  ///< sources that this holder's presence kept out
  std::deque<WriterId> departed_;  ///< writers that are gone, newest last: their last messages claim nothing
  std::uint64_t changes_ = 0, refused_ = 0;
};

}  // namespace rtd::bus
