// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/replay/core/player.hpp"

#include <gmock/gmock.h>

#include <functional>

#include "tests/unit/replay/played_recording.hpp"

namespace rtd::replay {
namespace {

using testing::ElementsAre;

/// Time passes only while the player waits. Events come at their times.
class ScriptedHost : public PlayerHost {
 public:
  struct Sent {
    std::string payload;
    std::int64_t at_ms = 0;
  };

  void at(std::int64_t ms, Event event) { script_.push_back({ms * kMillisecond, event}); }
  /// Called with each message; may script answers.
  std::function<void(const std::string& payload, std::int64_t now_ms)> on_send;

  std::int64_t now_ns() override { return now_ns_; }
  std::optional<Event> wait_until(std::int64_t deadline_ns) override {
    if (++turns_ > 100'000) return Command::kStop;
    const auto next = std::ranges::min_element(script_, {}, &Scripted::at_ns);
    if (next == script_.end() || next->at_ns > std::max(deadline_ns, now_ns_)) {
      now_ns_ = std::max(now_ns_, deadline_ns);
      return std::nullopt;
    }
    now_ns_ = std::max(now_ns_, next->at_ns);
    const Event event = next->event;
    script_.erase(next);
    return event;
  }
  void send(const PlayedMessage& message) override {
    sent.push_back({text_of(*message.cdr), now_ns_ / kMillisecond});
    if (on_send) on_send(sent.back().payload, now_ns_ / kMillisecond);
  }
  void send_clock(std::int64_t recorded_ns) override { clock_ms.push_back(recorded_ns / kMillisecond); }
  std::optional<std::uint64_t> paced_seq(const PlayedMessage& message) override {
    const std::string payload = text_of(*message.cdr);
    if (payload.starts_with("box")) return std::nullopt;
    return std::stoull(payload);
  }
  bool ends_step(const PlayedMessage& message) override { return !text_of(*message.cdr).starts_with("box"); }
  void show(const PlayState&) override {}

  std::vector<std::string> payloads() const {
    std::vector<std::string> all;
    for (const Sent& one : sent) all.push_back(one.payload);
    return all;
  }
  std::vector<std::int64_t> times_ms() const {
    std::vector<std::int64_t> all;
    for (const Sent& one : sent) all.push_back(one.at_ms);
    return all;
  }
  std::vector<Sent> sent;
  std::vector<std::int64_t> clock_ms;

 private:
  struct Scripted {
    std::int64_t at_ns;
    Event event;
  };
  std::vector<Scripted> script_;
  std::int64_t now_ns_ = 0;
  int turns_ = 0;
};

struct PlayerTest : testing::Test {
  PlayOutcome play(const std::vector<RecordedPiece>& pieces) {
    PlayedRecording recording(pieces);
    options.start_ns = pieces.front().log_ns;
    options.end_ns = pieces.back().log_ns;
    MessageFeed feed(recording.reader(), {.start_ns = options.start_ns, .end_ns = options.end_ns});
    Player player(feed, host, options);
    const PlayOutcome outcome = player.run();
    timing = player.timing();
    resends = player.resends();
    return outcome;
  }
  /// Each paced message is answered `delay_ms` after it was sent.
  void answer_after(std::int64_t delay_ms) {
    host.on_send = [this, delay_ms](const std::string& payload, std::int64_t now_ms) {
      if (!payload.starts_with("box")) host.at(now_ms + delay_ms, Answer{std::stoull(payload)});
    };
  }
  PlayerOptions options;
  ScriptedHost host;
  TimingError timing;
  std::uint64_t resends = 0;
};

TEST_F(PlayerTest, sends_each_message_at_its_time) {
  EXPECT_EQ(play(numbered(5)), PlayOutcome::kEnded);
  EXPECT_THAT(host.payloads(), ElementsAre("0", "1", "2", "3", "4"));
  EXPECT_THAT(host.times_ms(), ElementsAre(0, 10, 20, 30, 40));
  EXPECT_EQ(timing.count(), 4U);
  EXPECT_EQ(timing.max_ms(), 0);
}

TEST_F(PlayerTest, the_rate_divides_the_times) {
  options.rate = 0.5;
  play(numbered(4));
  EXPECT_THAT(host.times_ms(), ElementsAre(0, 20, 40, 60));
}

TEST_F(PlayerTest, rate_0_does_not_wait) {
  options.rate = 0;
  play(numbered(4));
  EXPECT_THAT(host.times_ms(), ElementsAre(0, 0, 0, 0));
}

TEST_F(PlayerTest, space_pauses_and_continues_where_it_was) {
  host.at(15, Command::kTogglePause);
  host.at(1015, Command::kTogglePause);
  play(numbered(4));
  EXPECT_THAT(host.times_ms(), ElementsAre(0, 10, 1020, 1030));
  EXPECT_EQ(timing.max_ms(), 0) << "a pause is no error";
}

TEST_F(PlayerTest, a_step_sends_one_message_of_a_paused_replay) {
  options.paused = true;
  host.at(100, Command::kStep);
  host.at(200, Command::kStep);
  host.at(300, Command::kTogglePause);
  play(numbered(4));
  EXPECT_THAT(host.times_ms(), ElementsAre(100, 200, 310, 320)) << "from the last one that was sent";
}

TEST_F(PlayerTest, a_step_while_it_plays_is_nothing) {
  host.at(5, Command::kStep);
  host.at(15, Command::kTogglePause);
  host.at(500, Command::kTogglePause);
  play(numbered(3));
  EXPECT_THAT(host.times_ms(), ElementsAre(0, 10, 505));
}

TEST_F(PlayerTest, arrows_change_the_rate_by_a_tenth) {
  host.at(0, Command::kFaster);
  play(numbered(12));
  EXPECT_EQ(host.sent.back().at_ms, 100) << "110 ms at 1.1";
}

TEST_F(PlayerTest, back_and_forward_jump_ten_seconds) {
  std::vector<RecordedPiece> pieces;
  for (int i = 0; i <= 30; ++i) pieces.push_back({"/frame", i * 1000 * kMillisecond, std::to_string(i)});
  host.at(2500, Command::kForward);
  host.at(4050, Command::kBack);
  host.at(5100, Command::kStop);
  EXPECT_EQ(play(pieces), PlayOutcome::kStopped);
  EXPECT_THAT(host.payloads(), ElementsAre("0", "1", "2", "13", "14", "5"));
}

/// What requests were answered.
struct Answers {
  Request request(Request asked) {
    asked.done = [this](const PlayState& state, const std::string& problem) {
      states.push_back(state);
      problems.push_back(problem);
    };
    return asked;
  }
  std::vector<PlayState> states;
  std::vector<std::string> problems;
};

TEST_F(PlayerTest, a_request_to_pause_holds_until_the_one_to_go_on) {
  Answers answers;
  host.at(15, answers.request({Request::Action::kPause}));
  host.at(500, answers.request({Request::Action::kPause}));
  host.at(1015, answers.request({Request::Action::kResume}));
  play(numbered(4));
  EXPECT_THAT(host.times_ms(), ElementsAre(0, 10, 1020, 1030));
  ASSERT_EQ(answers.states.size(), 3U);
  EXPECT_TRUE(answers.states[0].paused);
  EXPECT_EQ(answers.states[0].recorded_ns, options.start_ns + 15 * kMillisecond);
  EXPECT_TRUE(answers.states[1].paused);
  EXPECT_FALSE(answers.states[2].paused);
}

TEST_F(PlayerTest, a_request_to_step_pauses_and_goes_to_the_next_frame) {
  Answers answers;
  std::vector<RecordedPiece> pieces;
  for (const char* payload : {"0", "box", "box", "1", "box", "2"})
    pieces.push_back({"/frame", static_cast<std::int64_t>(pieces.size()) * 10 * kMillisecond, payload});
  host.at(5, answers.request({Request::Action::kStepFrame}));
  host.at(100, Command::kStop);
  EXPECT_EQ(play(pieces), PlayOutcome::kStopped);
  EXPECT_THAT(host.payloads(), ElementsAre("0", "box", "box", "1"));
  ASSERT_EQ(answers.states.size(), 1U);
  EXPECT_TRUE(answers.states[0].paused);
  EXPECT_EQ(answers.states[0].recorded_ns, 30 * kMillisecond);
  EXPECT_EQ(answers.problems[0], "");
}

TEST_F(PlayerTest, a_step_beyond_the_end_says_so) {
  Answers answers;
  options.paused = true;
  host.at(10, answers.request({Request::Action::kStepFrame}));
  host.at(20, answers.request({Request::Action::kStepFrame}));
  play({{"/frame", 0, "0"}, {"/box", kMillisecond, "box"}});
  EXPECT_THAT(answers.problems, ElementsAre("", "the replay has ended"));
}

TEST_F(PlayerTest, a_request_to_seek_goes_back_and_on_at_the_same_speed) {
  Answers answers;
  Request back{Request::Action::kSeek};
  back.to_ns = numbered(1).front().log_ns;
  host.at(25, answers.request(back));
  play(numbered(4));
  EXPECT_THAT(host.payloads(), ElementsAre("0", "1", "2", "0", "1", "2", "3"));
  EXPECT_THAT(host.times_ms(), ElementsAre(0, 10, 20, 25, 35, 45, 55));
  EXPECT_EQ(answers.states.at(0).recorded_ns, back.to_ns);
  EXPECT_EQ(timing.max_ms(), 0) << "a jump is no error";
}

TEST_F(PlayerTest, a_request_to_seek_keeps_a_pause) {
  Answers answers;
  options.paused = true;
  Request on{Request::Action::kSeek};
  on.to_ns = numbered(3).back().log_ns;
  host.at(25, answers.request(on));
  host.at(100, answers.request({Request::Action::kStepFrame}));
  play(numbered(3));
  EXPECT_THAT(host.payloads(), ElementsAre("2"));
  EXPECT_TRUE(answers.states.at(0).paused);
  EXPECT_EQ(answers.states.at(0).recorded_ns, on.to_ns);
}

TEST_F(PlayerTest, a_request_sets_the_speed_of_a_replay_by_time_only) {
  Answers answers;
  Request faster{Request::Action::kSetRate};
  faster.rate = 2;
  host.at(0, answers.request(faster));
  play(numbered(11));
  EXPECT_EQ(host.sent.back().at_ms, 50);
  options.pacer.window = 1;
  answer_after(1);
  host.at(51, answers.request(faster));
  play(numbered(3));
  EXPECT_EQ(answers.problems.at(0), "");
  EXPECT_THAT(answers.problems.at(1), testing::HasSubstr("does not go by time"));
}

TEST_F(PlayerTest, a_loop_begins_again_until_it_is_stopped) {
  options.loop = true;
  host.at(45, Command::kStop);
  EXPECT_EQ(play(numbered(3)), PlayOutcome::kStopped);
  EXPECT_THAT(host.payloads(), ElementsAre("0", "1", "2", "0", "1", "2", "0"));
  EXPECT_THAT(host.times_ms(), ElementsAre(0, 10, 20, 20, 30, 40, 40));
}

TEST_F(PlayerTest, held_at_the_end_it_pauses_there_and_begins_again_when_resumed) {
  options.hold = true;
  host.at(100, Command::kTogglePause);
  host.at(300, Command::kStop);
  EXPECT_EQ(play(numbered(3)), PlayOutcome::kStopped);
  EXPECT_THAT(host.payloads(), ElementsAre("0", "1", "2", "0", "1", "2"));
  EXPECT_THAT(host.times_ms(), ElementsAre(0, 10, 20, 100, 110, 120));
}

TEST_F(PlayerTest, the_clock_ticks_at_its_rate_and_stands_in_a_pause) {
  options.clock_period_ns = 10 * kMillisecond;
  options.rate = 2;
  host.at(25, Command::kTogglePause);
  host.at(45, Command::kTogglePause);
  play(numbered(11));
  EXPECT_THAT(host.clock_ms, testing::ElementsAreArray({1000, 1020, 1040, 1050, 1050, 1060, 1080, 1100}));
}

TEST_F(PlayerTest, in_lockstep_the_next_frame_waits_for_the_answer_however_long) {
  options.pacer.window = 1;
  answer_after(250);
  EXPECT_EQ(play(numbered(4)), PlayOutcome::kEnded);
  EXPECT_THAT(host.times_ms(), ElementsAre(0, 250, 500, 750));
}

TEST_F(PlayerTest, what_belongs_to_a_frame_follows_it_at_once) {
  options.pacer.window = 1;
  answer_after(100);
  play({{"/frame", 0, "0"}, {"/boxes", 5, "box0"}, {"/frame", 10, "1"}, {"/boxes", 15, "box1"}});
  EXPECT_THAT(host.payloads(), ElementsAre("0", "box0", "1", "box1"));
  EXPECT_THAT(host.times_ms(), ElementsAre(0, 0, 100, 100));
}

TEST_F(PlayerTest, silence_sends_the_frame_and_what_belongs_to_it_again) {
  options.pacer.window = 1;
  host.at(2500, Answer{0});
  host.at(2600, Answer{1});
  play({{"/frame", 0, "0"}, {"/boxes", 5, "box0"}, {"/frame", 10, "1"}});
  EXPECT_THAT(host.payloads(), ElementsAre("0", "box0", "0", "box0", "1"));
  EXPECT_EQ(resends, 1U);
}

TEST_F(PlayerTest, gives_up_without_an_answer) {
  options.pacer.window = 1;
  EXPECT_EQ(play(numbered(3)), PlayOutcome::kUnanswered);
}

TEST_F(PlayerTest, an_answer_without_number_answers_the_oldest) {
  options.pacer.window = 2;
  for (const std::int64_t ms : {100, 200, 300}) host.at(ms, Answer{});
  play(numbered(3));
  EXPECT_THAT(host.times_ms(), ElementsAre(0, 0, 100));
}

}  // namespace
}  // namespace rtd::replay
