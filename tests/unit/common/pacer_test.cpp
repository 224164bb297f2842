// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/pacer.hpp"

#include <gmock/gmock.h>

namespace rtd::service {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr std::int64_t kMs = 1'000'000, kS = 1'000 * kMs;

/// A pacer whose clock the test turns.
class PacerTest : public ::testing::Test {
 protected:
  Pacer pacer(int window) {
    PacerConfig config;
    config.window = window;
    config.late_after_ns = 33 * kMs;
    return Pacer(config, [this] { return now_ns_; });
  }
  std::int64_t now_ns_ = 500 * kS;
};

TEST_F(PacerTest, RealtimeFollowsTheStamps) {
  Pacer pacer = this->pacer(0);
  EXPECT_EQ(pacer.next(7 * kS).action, PaceAction::kSend);
  const PaceDecision early = pacer.next(7 * kS + 33 * kMs);
  EXPECT_EQ(early.action, PaceAction::kWait);
  EXPECT_EQ(early.wait_ns, 33 * kMs);
  now_ns_ += 33 * kMs;
  EXPECT_EQ(pacer.next(7 * kS + 33 * kMs).action, PaceAction::kSend);
}

TEST_F(PacerTest, RealtimeSkipsAndCountsLateFrames) {
  Pacer pacer = this->pacer(0);
  pacer.next(0);
  now_ns_ += 100 * kMs;  // the frames of 33 and 66 ms are late; by 67 and 34 ms
  EXPECT_EQ(pacer.next(33 * kMs).action, PaceAction::kSkipLate);
  EXPECT_EQ(pacer.next(66 * kMs).action, PaceAction::kSkipLate);
  EXPECT_EQ(pacer.next(99 * kMs).action, PaceAction::kSend);
  EXPECT_EQ(pacer.late(), 2U);
}

TEST_F(PacerTest, RealtimeSendsALateFrameWhenNoNewerOneIsReady) {
  Pacer pacer = this->pacer(0);
  pacer.next(0);
  now_ns_ += 100 * kMs;
  const PaceDecision decision = pacer.next(33 * kMs, 0);
  EXPECT_EQ(decision.action, PaceAction::kSend);
  EXPECT_EQ(decision.late_ns, 67 * kMs) << "for the source: what is older need not be made";
  EXPECT_EQ(pacer.late(), 0U);
}

TEST_F(PacerTest, RealtimeCutsLongPauses) {
  Pacer pacer = this->pacer(0);
  pacer.next(0);
  const PaceDecision decision = pacer.next(3 * 3600 * kS);
  EXPECT_EQ(decision.action, PaceAction::kWait);
  EXPECT_EQ(decision.wait_ns, kS);
  EXPECT_EQ(decision.cut_gap_ns, 3 * 3600 * kS - kS);
  now_ns_ += kS;
  const PaceDecision again = pacer.next(3 * 3600 * kS);
  EXPECT_EQ(again.action, PaceAction::kSend);
  EXPECT_EQ(again.cut_gap_ns, 0) << "reported once";
}

TEST_F(PacerTest, RealtimeShiftsTheTimelineOfASourceThatIsTooSlow) {
  Pacer pacer = this->pacer(0);
  pacer.next(0);
  now_ns_ += 2 * kS;
  const PaceDecision decision = pacer.next(33 * kMs);
  EXPECT_EQ(decision.action, PaceAction::kSend);
  EXPECT_EQ(decision.shifted_ns, 2 * kS - 33 * kMs);
  EXPECT_EQ(pacer.next(66 * kMs).action, PaceAction::kWait);
  EXPECT_EQ(pacer.late(), 0U);
}

TEST_F(PacerTest, LockstepSendsTheNextFrameAfterTheResultOfThisOne) {
  Pacer pacer = this->pacer(1);
  EXPECT_EQ(pacer.next(0).action, PaceAction::kSend);
  pacer.sent(0);
  const PaceDecision decision = pacer.next(1);
  EXPECT_EQ(decision.action, PaceAction::kWait);
  EXPECT_EQ(decision.wait_ns, 2 * kS);
  pacer.answered(0);
  EXPECT_EQ(pacer.next(1).action, PaceAction::kSend);
}

TEST_F(PacerTest, AsapKeepsAtMostTheWindowInFlight) {
  Pacer pacer = this->pacer(3);
  for (std::uint64_t seq = 0; seq < 3; ++seq) {
    EXPECT_EQ(pacer.next(0).action, PaceAction::kSend);
    pacer.sent(seq);
  }
  EXPECT_EQ(pacer.next(0).action, PaceAction::kWait);
  pacer.answered(1);
  EXPECT_THAT(pacer.in_flight(), ElementsAre(2));
  EXPECT_EQ(pacer.next(0).action, PaceAction::kSend);
}

TEST_F(PacerTest, IgnoresOldResults) {
  Pacer pacer = this->pacer(1);
  pacer.sent(5);
  now_ns_ += kS;
  pacer.answered(4);
  EXPECT_THAT(pacer.in_flight(), ElementsAre(5));
  EXPECT_EQ(pacer.next(0).wait_ns, kS) << "an old result is no sign of life of this frame";
}

TEST_F(PacerTest, ResendsAfterSilenceAgainAndAgain) {
  Pacer pacer = this->pacer(1);
  pacer.sent(0);
  for (std::uint64_t round = 1; round <= 3; ++round) {
    now_ns_ += 2 * kS;
    EXPECT_EQ(pacer.next(0).action, PaceAction::kResend);
    pacer.resent();
    EXPECT_EQ(pacer.next(0).action, PaceAction::kWait);
    EXPECT_EQ(pacer.resends(), round);
  }
}

TEST_F(PacerTest, DoesNotCountTheTimeInWhichEverythingStoodStill) {
  Pacer pacer = this->pacer(1);
  pacer.sent(0);
  EXPECT_EQ(pacer.next(0).action, PaceAction::kWait);
  for (const std::int64_t pause_ns : {10 * kS, 60 * kS}) {
    now_ns_ += pause_ns;
    EXPECT_EQ(pacer.next(0).action, PaceAction::kWait) << pause_ns;
  }
  for (int i = 0; i < 29; ++i) {
    now_ns_ += kS;
    EXPECT_NE(pacer.next(0).action, PaceAction::kGiveUp) << i;
  }
  now_ns_ += kS;
  EXPECT_EQ(pacer.next(0).action, PaceAction::kGiveUp);
}

TEST_F(PacerTest, GivesUpAfterTheResultTimeout) {
  Pacer pacer = this->pacer(3);
  for (std::uint64_t seq = 0; seq < 3; ++seq) pacer.sent(seq);
  now_ns_ += 20 * kS;
  pacer.answered(0);
  pacer.sent(3);
  now_ns_ += 29 * kS;
  EXPECT_NE(pacer.next(0).action, PaceAction::kGiveUp);
  now_ns_ += kS;
  EXPECT_EQ(pacer.next(0).action, PaceAction::kGiveUp);
}

TEST_F(PacerTest, DrainsUntilEveryFrameIsAnswered) {
  Pacer pacer = this->pacer(3);
  pacer.sent(0);
  pacer.sent(1);
  EXPECT_EQ(pacer.drain().action, PaceAction::kWait);
  pacer.answered(0);
  EXPECT_EQ(pacer.drain().action, PaceAction::kWait);
  now_ns_ += 2 * kS;
  EXPECT_EQ(pacer.drain().action, PaceAction::kResend);
  pacer.answered(1);
  EXPECT_EQ(pacer.drain().action, PaceAction::kSend);
  EXPECT_THAT(pacer.in_flight(), IsEmpty());
}

}  // namespace
}  // namespace rtd::service
