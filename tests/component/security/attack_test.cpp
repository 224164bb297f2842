// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// Who may not take part, does not: receives nothing and is not heard, while the rightful ones do.
#include <gmock/gmock.h>

#include <cstdlib>

#include "tests/component/security/peer_group.hpp"

namespace rtd::security {
namespace {

using ::testing::HasSubstr;

/// "open": access only, as the raw frames; "secret": encrypted.
const std::vector<std::string> kTopics = {"rt/open", "rt/secret"};
constexpr int kSamples = 100;

class AttackTest : public ::testing::TestWithParam<std::string> {
 protected:
  AttackTest() : peers_(GetParam()) {}
  PeerGroup peers_;
};

TEST_P(AttackTest, only_the_rightful_hear_and_are_heard) {
  Keystores keystores(peers_.scratch());
  const std::string good = keystores.good();
  peers_.start("writer", good, "/rtd/writer", kTopics);
  peers_.start("reader", good, "/rtd/reader", kTopics);
  peers_.start("clear", "-", "-", kTopics);
  peers_.start("rogue", keystores.rogue(), "/rtd/writer", kTopics);
  peers_.start("expired", good, "/rtd/expired", kTopics, keystores.clock_of_expired());
  peers_.start("stale", good, "/rtd/stale", kTopics, keystores.clock_of_expired());
  peers_.start("stranger", good, "/rtd/stranger", kTopics);
  peers_.start("lax", keystores.lax(), "/rtd/stranger", kTopics);
  const std::vector<std::string> attackers = {"clear", "rogue", "expired", "stale", "stranger", "lax"};

  // The attackers have had their time when the rightful have theirs, and each has sent as much, if it could at all.
  EXPECT_TRUE(peers_.wait_until([&] {
    bool done = peers_.got("reader", "writer") >= 2 * kSamples;
    for (const std::string& attacker : attackers)
      done = done && (peers_.sent(attacker) >= kSamples || peers_.refused(attacker));
    return done;
  })) << peers_.log();

  EXPECT_GE(peers_.sent("clear"), kSamples) << "the attack was none";
  EXPECT_GE(peers_.sent("rogue"), kSamples) << "the attack was none";
  EXPECT_GE(peers_.sent("expired"), kSamples) << "the attack was none\n" << peers_.log();
  EXPECT_GE(peers_.sent("lax"), kSamples) << "the attack was none\n" << peers_.log();
  for (const std::string& attacker : attackers) {
    EXPECT_EQ(peers_.got("reader", attacker), 0) << attacker << " was heard";
    EXPECT_EQ(peers_.got("writer", attacker), 0) << attacker << " was heard";
    EXPECT_EQ(peers_.got(attacker, "writer"), 0) << attacker << " hears";
  }
  for (const std::string attacker : {"clear", "rogue", "expired"})
    EXPECT_THAT(peers_.problems("reader"), HasSubstr("'" + attacker + "'"));
  if (std::getenv("RTD_SHOW_PEERS") != nullptr) std::cout << peers_.log();
  std::cout << "reader got " << peers_.got("reader", "writer") << " samples of the writer; attackers sent clear "
            << peers_.sent("clear") << ", rogue " << peers_.sent("rogue") << ", expired " << peers_.sent("expired")
            << ", expired permissions " << peers_.sent("stale") << ", wrong permissions " << peers_.sent("stranger")
            << ", their checks evaded " << peers_.sent("lax") << ": 0 heard, 0 delivered\n";
}

/// The same attackers in a domain that is not secured: what the test above counts is there to be counted.
TEST_P(AttackTest, without_security_everybody_hears_everybody) {
  for (const std::string peer : {"writer", "reader", "clear"}) peers_.start(peer, "-", "-", kTopics);
  EXPECT_TRUE(peers_.wait_until([&] {
    return peers_.got("reader", "clear") >= kSamples && peers_.got("clear", "writer") >= kSamples;
  })) << peers_.log();
}

INSTANTIATE_TEST_SUITE_P(Vendors, AttackTest, ::testing::Values("fastdds"),
                         [](const auto& vendor) { return vendor.param; });

}  // namespace
}  // namespace rtd::security
