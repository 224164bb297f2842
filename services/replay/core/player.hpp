// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "common/service/pacer.hpp"
#include "services/replay/core/message_feed.hpp"

namespace rtd::replay {

/// What a key press asks for.
enum class Command { kTogglePause, kStep, kFaster, kSlower, kBack, kForward, kStop };

/// Turns the bytes of a terminal into commands, also when an escape sequence arrives in pieces. Keys as in rosbag2:
/// space, right arrow (or s), up, down; also b and f (10 s back, forward) and q.
class KeyCommands {
 public:
  std::optional<Command> next(char byte);

 private:
  std::string pending_;  ///< an escape sequence so far
};

/// Maps recorded times to due times on the caller's clock. Every time is computed from one anchor, so errors do not
/// add up.
class Schedule {
 public:
  /// `rate` > 0: 2 is twice as fast as recorded.
  explicit Schedule(double rate) : rate_(rate) {}

  /// The playhead is at `recorded_ns` now.
  void jump(std::int64_t recorded_ns, std::int64_t now_ns);
  void pause(std::int64_t now_ns);
  void resume(std::int64_t now_ns);
  void set_rate(double rate, std::int64_t now_ns);

  bool paused() const { return paused_; }
  double rate() const { return rate_; }
  /// When a recorded time is due; not for use while paused.
  std::int64_t due_ns(std::int64_t recorded_ns) const;
  /// Where the playhead is.
  std::int64_t recorded_ns(std::int64_t now_ns) const;

 private:
  double rate_;
  bool paused_ = false;
  std::int64_t anchor_recorded_ns_ = 0, anchor_ns_ = 0;
};

/// Measures by how much the time between consecutive messages differs from the recorded one. Percentiles are exact to
/// 10 us up to 1 s.
class TimingError {
 public:
  void add(std::int64_t due_ns, std::int64_t sent_ns);
  /// The next message follows a pause or a jump: the time before it does not count.
  void interrupt() { any_ = false; }

  std::uint64_t count() const { return count_; }
  double percentile_ms(double percent) const;  ///< 0 when nothing was measured
  double max_ms() const { return static_cast<double>(max_ns_) * 1e-6; }

 private:
  static constexpr std::int64_t kBinNs = 10'000;
  static constexpr std::size_t kBins = 100'000;
  std::vector<std::uint32_t> bins_ = std::vector<std::uint32_t>(kBins);
  std::uint64_t count_ = 0;
  std::int64_t max_ns_ = 0, last_due_ns_ = 0, last_sent_ns_ = 0;
  bool any_ = false;
};

struct PlayerOptions {
  double rate = 1;             ///< 0: as fast as possible
  service::PacerConfig pacer;  ///< window > 0: the paced topic waits for answers instead of times
  bool paused = false, loop = false;
  bool hold = false;                      ///< pauses at the end instead of ending; to resume there is to begin again
  std::int64_t start_ns = 0, end_ns = 0;  ///< log_time of the first and last message
  std::int64_t clock_period_ns = 0;       ///< 0: no clock
};

/// A consumer has answered the paced message with this number and all earlier ones; without a number: the oldest one.
struct Answer {
  std::optional<std::uint64_t> seq;
};

struct PlayState {
  std::int64_t recorded_ns = 0;  ///< where the playhead is
  double rate = 1;
  bool paused = false;
  std::uint64_t sent = 0;
};

/// What another program asks for.
struct Request {
  enum class Action { kPause, kResume, kStepFrame, kSeek, kSetRate };
  Action action = Action::kPause;
  std::int64_t to_ns = 0;  ///< kSeek: recorded time
  double rate = 1;         ///< kSetRate
  /// Called by the player, once: where it is then, and why it did not do it; empty when it did.
  std::function<void(const PlayState& state, const std::string& problem)> done;
};
using Event = std::variant<Command, Answer, Request>;

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
  /// Whether a step to the next frame ends with this message.
  virtual bool ends_step(const PlayedMessage& message) = 0;
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
  void handle(Request request);
  std::string change_rate_to(double rate);
  void end_step(const std::string& problem);
  bool stepping() const { return steps_ > 0 || stepped_frame_.has_value(); }
  void answered(std::uint64_t seq);
  void toggle_pause();
  void change_rate(double factor);
  void seek(std::int64_t recorded_ns);
  void play_head();
  bool may_go(const PlayedMessage& message);
  bool follow(const service::PaceDecision& decision);
  void send_head(std::int64_t due_ns);
  void end_of_feed();
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
  bool held_ = false;                     ///< at the end
  std::optional<Request> stepped_frame_;  ///< until the frame has gone
  std::optional<PlayOutcome> outcome_;
};

}  // namespace rtd::replay
