// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <optional>
#include <variant>

#include "common/service/pacer.hpp"
#include "services/replay/core/key_commands.hpp"
#include "services/replay/core/message_feed.hpp"
#include "services/replay/core/schedule.hpp"

namespace rtd::replay {

struct PlayerOptions {
  double rate = 1;             ///< 0: as fast as possible
  service::PacerConfig pacer;  ///< window > 0: the paced topic waits for answers instead of times
  bool paused = false, loop = false;
  std::int64_t start_ns = 0, end_ns = 0;  ///< log_time of the first and last message
  std::int64_t clock_period_ns = 0;       ///< 0: no clock
};

/// A consumer has answered the paced message with this number and all earlier ones; without a number: the oldest one.
struct Answer {
  std::optional<std::uint64_t> seq;
};
using Event = std::variant<Command, Answer>;

struct PlayState {
  std::int64_t recorded_ns = 0;  ///< where the playhead is
  double rate = 1;
  bool paused = false;
  std::uint64_t sent = 0;
};

/// The world of the player: time, outputs, events.
class PlayerHost {
 public:
  virtual ~PlayerHost() = default;
  virtual std::int64_t now_ns() = 0;
  /// The next event; waits for one until the deadline, not at all when that has passed.
  virtual std::optional<Event> wait_until(std::int64_t deadline_ns) = 0;
  virtual void send(const PlayedMessage& message) = 0;
  virtual void send_clock(std::int64_t recorded_ns) = 0;
  /// The number by which a message of the paced topic is answered; empty for other topics.
  virtual std::optional<std::uint64_t> paced_seq(const PlayedMessage& message) = 0;
  virtual void show(const PlayState& state) = 0;
};

enum class PlayOutcome { kEnded, kStopped, kUnanswered };

/// Plays a feed: decides when which message goes out and what the keys do. No thread and no clock of its own.
class Player {
 public:
  Player(MessageFeed& feed, PlayerHost& host, const PlayerOptions& options);

  PlayOutcome run();

  const TimingError& timing() const { return timing_; }
  std::uint64_t sent() const { return sent_; }
  std::uint64_t resends() const { return pacer_.resends(); }
  /// The paced message that was not answered, for kUnanswered.
  std::uint64_t unanswered_seq() const { return pacer_.in_flight().front(); }

 private:
  bool by_answers() const { return options_.pacer.window > 0; }
  bool by_time() const { return !by_answers() && schedule_.rate() > 0; }
  void take_head();
  void wait_until(std::int64_t deadline_ns);
  void handle_events(std::int64_t deadline_ns);
  void handle(Command command);
  std::uint64_t oldest_in_flight() const;
  void answered(std::uint64_t seq);
  void toggle_pause();
  void change_rate(double factor);
  void seek(std::int64_t recorded_ns);
  void play_head();
  bool may_go(const PlayedMessage& message);
  bool follow(const service::PaceDecision& decision);
  void send_head(std::int64_t due_ns);
  void end_of_feed();
  void resend();
  void tick_clock(std::int64_t now_ns);
  PlayState state() const;

  MessageFeed& feed_;
  PlayerHost& host_;
  const PlayerOptions options_;
  Schedule schedule_;
  service::Pacer pacer_;
  TimingError timing_;
  std::optional<PlayedMessage> head_;     ///< the next one
  std::deque<PlayedMessage> unanswered_;  ///< from the oldest paced message without an answer on
  std::optional<std::int64_t> jump_to_;   ///< where the playhead is put with the next message
  std::int64_t last_recorded_ns_, next_tick_ns_ = 0;
  std::uint64_t sent_ = 0, steps_ = 0;
  std::optional<PlayOutcome> outcome_;
};

}  // namespace rtd::replay
