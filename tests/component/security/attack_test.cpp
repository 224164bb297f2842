// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// Participants without permission receive nothing and are not received, while the permitted ones are.
#include <gmock/gmock.h>

#include <cstdlib>

#include "tests/component/security/peer_group.hpp"

namespace rtd::security {
namespace {

using namespace ::testing;

/// "open": access only, as the raw frames; "secret": encrypted.
const std::vector<std::string> kTopics = {"rt/open", "rt/secret"};
constexpr int kSamples = 100;
/// Fast DDS 3 reports nothing of a participant before it has authenticated itself, so its name is not known then.
#if __has_include(<fastrtps/fastrtps_dll.h>) || !defined(RTD_HAVE_FASTDDS)
constexpr bool kFastddsNamesOthers = true;
#else
constexpr bool kFastddsNamesOthers = false;
#endif

class AttackTest : public ::testing::TestWithParam<std::string> {
 protected:
  AttackTest() : peers_(GetParam()) {}
  PeerGroup peers_;
};

TEST_P(AttackTest, only_permitted_participants_receive_and_are_received) {
  Keystores keystores(peers_.scratch());
  const std::string good = keystores.good();
  peers_.start("writer", good, "/rtd/writer", kTopics);
  peers_.start("reader", good, "/rtd/reader", kTopics);
  peers_.start("clear", "-", "-", kTopics);
  peers_.start("rogue", keystores.rogue(), "/rtd/writer", kTopics);
  peers_.start("expired", good, "/rtd/expired", kTopics, keystores.clock_of_expired());
  peers_.start("stale", good, "/rtd/stale", kTopics, keystores.clock_of_expired());
  peers_.start("unpermitted", good, "/rtd/unpermitted", kTopics);
  peers_.start("lax", keystores.lax(), "/rtd/unpermitted", kTopics);
  const std::vector<std::string> attackers = {"clear", "rogue", "expired", "stale", "unpermitted", "lax"};

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
    EXPECT_EQ(peers_.got("reader", attacker), 0) << attacker << " was received";
    EXPECT_EQ(peers_.got("writer", attacker), 0) << attacker << " was received";
    EXPECT_EQ(peers_.got(attacker, "writer"), 0) << attacker << " receives";
  }
  // Of a refused handshake only the side that checks first knows.
  for (const char* rightful : {"writer", "reader"}) {
    const std::string problems = peers_.problems(rightful);
    const std::string name = GetParam() != "fastdds" || kFastddsNamesOthers ? "'clear' " : "";
    EXPECT_THAT(problems,
                ContainsRegex("participant " + name + "[0-9a-f.]+ in secured domain [0-9]+ has no certificate"));
    EXPECT_THAT(problems, Not(HasSubstr("'writer'")));
    EXPECT_THAT(problems, Not(HasSubstr("'reader'")));
    const char* const clear = "has no certificate";
    EXPECT_EQ(problems.find(clear), problems.rfind(clear)) << "reported twice: " << problems;
  }
  if (std::getenv("RTD_SHOW_PEERS") != nullptr) std::cout << peers_.log();
  std::cout << "reader got " << peers_.got("reader", "writer") << " samples of the writer; attackers sent clear "
            << peers_.sent("clear") << ", rogue " << peers_.sent("rogue") << ", expired " << peers_.sent("expired")
            << ", expired permissions " << peers_.sent("stale") << ", wrong permissions " << peers_.sent("unpermitted")
            << ", their checks evaded " << peers_.sent("lax") << ": 0 received, 0 delivered\n";
}

/// The same attackers in a domain that is not secured: what the test above counts is there to be counted.
TEST_P(AttackTest, without_security_all_participants_receive_each_other) {
  for (const std::string peer : {"writer", "reader", "clear"}) peers_.start(peer, "-", "-", kTopics);
  EXPECT_TRUE(peers_.wait_until([&] {
    return peers_.got("reader", "clear") >= kSamples && peers_.got("clear", "writer") >= kSamples;
  })) << peers_.log();
}

std::vector<std::string> vendors() {
  std::vector<std::string> names;
#ifdef RTD_HAVE_FASTDDS
  names.emplace_back("fastdds");
#endif
#ifdef RTD_HAVE_CYCLONEDDS
  names.emplace_back("cyclonedds");
#endif
  return names;
}

INSTANTIATE_TEST_SUITE_P(Vendors, AttackTest, ::testing::ValuesIn(vendors()),
                         [](const auto& vendor) { return vendor.param; });

#if defined(RTD_HAVE_FASTDDS) && defined(RTD_HAVE_CYCLONEDDS)
TEST(MixedVendorsTest, the_other_vendor_in_a_secured_domain_is_named) {
  PeerGroup peers("fastdds");
  const std::string good = Keystores(peers.scratch()).good();
  peers.start("writer", good, "/rtd/writer", kTopics);
  peers.start("reader", good, "/rtd/reader", kTopics, {}, "cyclonedds");
  EXPECT_TRUE(peers.wait_until([&] {
    return (!kFastddsNamesOthers || !peers.problems("writer").empty()) && !peers.problems("reader").empty();
  })) << peers.log();
  EXPECT_THAT(peers.problems("reader"), AllOf(HasSubstr("Fast DDS"), HasSubstr("the same --dds")));
  if (!kFastddsNamesOthers) GTEST_SKIP() << "the other side: this version of Fast DDS reports no other vendor";
  EXPECT_THAT(peers.problems("writer"), AllOf(HasSubstr("Cyclone DDS"), HasSubstr("the same --dds")));
}
#endif

}  // namespace
}  // namespace rtd::security
