// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/replay/core/player.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <utility>

namespace rtd::replay {
namespace {

using Keys = std::map<char, Command>;

std::optional<Command> find(const Keys& keys, char byte) {
  const auto key = keys.find(byte);
  return key == keys.end() ? std::nullopt : std::optional(key->second);
}

}  // namespace

std::optional<Command> KeyCommands::next(char byte) {
  static const Keys kArrows = {{'A', Command::kFaster}, {'B', Command::kSlower}, {'C', Command::kStep}};
  static const Keys kLetters = {{' ', Command::kTogglePause},
                                {'s', Command::kStep},
                                {'b', Command::kBack},
                                {'f', Command::kForward},
                                {'q', Command::kStop}};
  constexpr char kEscape = '\x1b';
  if (byte == kEscape) {
    pending_ = byte;
    return std::nullopt;
  }
  if (pending_.empty()) return find(kLetters, byte);
  const bool introduced = pending_.size() > 1;
  if (!introduced && (byte == '[' || byte == 'O')) {
    pending_ += byte;
    return std::nullopt;
  }
  const bool ends = !introduced || (byte >= '@' && byte <= '~');  // parameters such as "1;5" come before
  if (!ends) return std::nullopt;
  pending_.clear();
  return find(introduced ? kArrows : kLetters, byte);
}

namespace {

constexpr std::int64_t kShowEveryNs = 200'000'000;
constexpr std::int64_t kSeekStepNs = 10'000'000'000;
constexpr double kRateStep = 1.1, kLowestRate = 0.01, kHighestRate = 1000;

}  // namespace

void Schedule::jump(std::int64_t recorded_ns, std::int64_t now_ns) {
  anchor_recorded_ns_ = recorded_ns;
  anchor_ns_ = now_ns;
}

void Schedule::pause(std::int64_t now_ns) {
  jump(recorded_ns(now_ns), now_ns);
  paused_ = true;
}

void Schedule::resume(std::int64_t now_ns) {
  anchor_ns_ = now_ns;
  paused_ = false;
}

void Schedule::set_rate(double rate, std::int64_t now_ns) {
  jump(recorded_ns(now_ns), now_ns);
  rate_ = rate;
}

std::int64_t Schedule::due_ns(std::int64_t recorded_ns) const {
  return anchor_ns_ + std::llround(static_cast<double>(recorded_ns - anchor_recorded_ns_) / rate_);
}

std::int64_t Schedule::recorded_ns(std::int64_t now_ns) const {
  if (paused_) return anchor_recorded_ns_;
  return anchor_recorded_ns_ + std::llround(static_cast<double>(now_ns - anchor_ns_) * rate_);
}

void TimingError::add(std::int64_t due_ns, std::int64_t sent_ns) {
  if (any_) {
    const std::int64_t error_ns = std::abs((sent_ns - last_sent_ns_) - (due_ns - last_due_ns_));
    ++bins_[std::min(static_cast<std::size_t>(error_ns / kBinNs), kBins - 1)];
    ++count_;
    max_ns_ = std::max(max_ns_, error_ns);
  }
  last_due_ns_ = due_ns;
  last_sent_ns_ = sent_ns;
  any_ = true;
}

double TimingError::percentile_ms(double percent) const {
  const auto rank = static_cast<std::uint64_t>(percent / 100 * static_cast<double>(count_));
  std::uint64_t seen = 0;
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    seen += bins_[bin];
    if (seen > rank || (seen == count_ && count_ > 0)) return static_cast<double>((bin + 1) * kBinNs) * 1e-6;
  }
  return 0;
}

Player::Player(MessageFeed& feed, PlayerHost& host, const PlayerOptions& options)
    : feed_(feed),
      host_(host),
      options_(options),
      schedule_(options.rate),
      pacer_(options.pacer, [&host] { return host.now_ns(); }),
      jump_to_(options.start_ns),
      last_recorded_ns_(options.start_ns) {}

PlayOutcome Player::run() {
  if (options_.paused) schedule_.pause(host_.now_ns());
  while (!outcome_) {
    handle_events(host_.now_ns());
    if (outcome_) break;
    if (!head_) take_head();
    if (head_) {
      play_head();
    } else {
      end_of_feed();
    }
  }
  end_step("the replay has ended");
  host_.show(state());
  return *outcome_;
}

/// The time that the disk needs for a jump does not count.
void Player::take_head() {
  head_ = feed_.next();
  if (jump_to_) schedule_.jump(*jump_to_, host_.now_ns());
  jump_to_.reset();
}

/// Sends the next message, or waits for what has to come before it.
void Player::play_head() {
  const std::int64_t now_ns = host_.now_ns();
  tick_clock(now_ns);
  std::int64_t latest_ns = now_ns + kShowEveryNs;
  if (options_.clock_period_ns > 0) latest_ns = std::min(latest_ns, next_tick_ns_);
  if (schedule_.paused() && !stepping()) return wait_until(latest_ns);
  const std::int64_t due_ns = by_time() && !stepping() ? schedule_.due_ns(head_->log_ns) : now_ns;
  if (due_ns > now_ns) return wait_until(std::min(due_ns, latest_ns));
  if (may_go(*head_)) send_head(due_ns);
}

/// False while a paced message waits for its turn; it has then waited until something changed.
bool Player::may_go(const PlayedMessage& message) {
  if (!by_answers() || !host_.paced_seq(message)) return true;
  return follow(pacer_.next(message.log_ns));
}

bool Player::follow(const service::PaceDecision& decision) {
  switch (decision.action) {
    case service::PaceAction::kWait:
      wait_until(host_.now_ns() + std::min(decision.wait_ns, kShowEveryNs));
      return false;
    case service::PaceAction::kResend:
      for (const PlayedMessage& message : unanswered_) host_.send(message);
      pacer_.resent();
      return false;
    case service::PaceAction::kGiveUp:
      outcome_ = PlayOutcome::kUnanswered;
      return false;
    default:
      return true;
  }
}

void Player::send_head(std::int64_t due_ns) {
  if (by_time() && !schedule_.paused()) timing_.add(due_ns, host_.now_ns());
  host_.send(*head_);
  ++sent_;
  last_recorded_ns_ = head_->log_ns;
  if (stepping()) {
    schedule_.jump(head_->log_ns, host_.now_ns());
    if (steps_ > 0) --steps_;
    if (host_.ends_step(*head_)) end_step("");
  }
  if (by_answers()) {
    const std::optional<std::uint64_t> seq = host_.paced_seq(*head_);
    if (seq) pacer_.sent(*seq);
    if (seq || !unanswered_.empty()) unanswered_.push_back(*head_);
  }
  head_.reset();
  host_.show(state());
}

/// After the last message: waits for missing answers, then starts again or ends.
void Player::end_of_feed() {
  if (by_answers() && !pacer_.in_flight().empty() && !follow(pacer_.drain())) return;
  if (options_.loop && sent_ > 0) return seek(options_.start_ns);
  if (!options_.hold) {
    outcome_ = PlayOutcome::kEnded;
  } else if (schedule_.paused()) {
    held_ = true;
    steps_ = 0;
    end_step("the recording is at its end");
    wait_until(host_.now_ns() + kShowEveryNs);
  } else if (held_) {
    seek(options_.start_ns);
  } else {
    toggle_pause();
  }
}

void Player::wait_until(std::int64_t deadline_ns) {
  host_.show(state());
  handle_events(deadline_ns);
}

void Player::handle_events(std::int64_t deadline_ns) {
  std::optional<Event> event = host_.wait_until(deadline_ns);
  while (event) {
    if (const auto* answer = std::get_if<Answer>(&*event)) {
      const std::deque<std::uint64_t>& in_flight = pacer_.in_flight();
      answered(answer->seq.value_or(in_flight.empty() ? 0 : in_flight.front()));  // 0: nothing is answered
    } else if (auto* request = std::get_if<Request>(&*event)) {
      handle(std::move(*request));
    } else {
      handle(std::get<Command>(*event));
    }
    event = host_.wait_until(host_.now_ns());
  }
}

void Player::handle(Command command) {
  switch (command) {
    case Command::kTogglePause:
      return toggle_pause();
    case Command::kStep:
      if (schedule_.paused()) ++steps_;
      return;
    case Command::kFaster:
      return change_rate(kRateStep);
    case Command::kSlower:
      return change_rate(1 / kRateStep);
    case Command::kBack:
      return seek(state().recorded_ns - kSeekStepNs);
    case Command::kForward:
      return seek(state().recorded_ns + kSeekStepNs);
    case Command::kStop:
      outcome_ = PlayOutcome::kStopped;
      return;
  }
}

void Player::handle(Request request) {
  using Action = Request::Action;
  std::string problem;
  if (request.action == Action::kStepFrame) {
    end_step("another step came in between");
    if (!schedule_.paused()) toggle_pause();
    stepped_frame_ = std::move(request);
    return;
  }
  const bool pause = request.action == Action::kPause, resume = request.action == Action::kResume;
  if ((pause && !schedule_.paused()) || (resume && schedule_.paused())) toggle_pause();
  if (resume) end_step("the replay continues");
  if (request.action == Action::kSeek) {
    seek(request.to_ns);
    take_head();  // the playhead is there from now on
  }
  if (request.action == Action::kSetRate) problem = change_rate_to(request.rate);
  host_.show(state());
  if (request.done) request.done(state(), problem);
}

void Player::end_step(const std::string& problem) {
  if (!stepped_frame_) return;
  const Request request = std::move(*stepped_frame_);
  stepped_frame_.reset();
  if (request.done) request.done(state(), problem);
}

std::string Player::change_rate_to(double rate) {
  if (!by_time()) return "this replay does not go by time: each message waits for the one before it";
  schedule_.set_rate(std::clamp(rate, kLowestRate, kHighestRate), host_.now_ns());
  timing_.interrupt();
  return {};
}

void Player::toggle_pause() {
  if (schedule_.paused()) {
    schedule_.resume(host_.now_ns());
  } else {
    schedule_.pause(host_.now_ns());
  }
  timing_.interrupt();
  host_.show(state());
}

void Player::change_rate(double factor) {
  if (change_rate_to(schedule_.rate() * factor).empty()) host_.show(state());
}

void Player::seek(std::int64_t recorded_ns) {
  const std::int64_t target_ns = std::clamp(recorded_ns, options_.start_ns, options_.end_ns);
  held_ = false;
  feed_.seek(target_ns);
  head_.reset();
  last_recorded_ns_ = target_ns;
  jump_to_ = target_ns;
  timing_.interrupt();
}

void Player::answered(std::uint64_t seq) {
  pacer_.answered(seq);
  const auto is_waited_for = [this](const PlayedMessage& message) {
    const std::optional<std::uint64_t> paced = host_.paced_seq(message);
    return paced && std::ranges::count(pacer_.in_flight(), *paced) > 0;
  };
  while (!unanswered_.empty() && !is_waited_for(unanswered_.front())) unanswered_.pop_front();
}

void Player::tick_clock(std::int64_t now_ns) {
  if (options_.clock_period_ns == 0 || now_ns < next_tick_ns_) return;
  host_.send_clock(state().recorded_ns);
  next_tick_ns_ += options_.clock_period_ns;
  if (next_tick_ns_ <= now_ns) next_tick_ns_ = now_ns + options_.clock_period_ns;
}

PlayState Player::state() const {
  const std::int64_t recorded_ns = by_time() ? schedule_.recorded_ns(host_.now_ns()) : last_recorded_ns_;
  return {std::clamp(recorded_ns, options_.start_ns, options_.end_ns), schedule_.rate(), schedule_.paused(), sent_};
}

}  // namespace rtd::replay
