// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// What an eavesdropper on the wire reads of an encrypted topic: nothing, where without security he reads all of it.
#include <gtest/gtest.h>

#include <algorithm>
#include <string_view>

#include "common/bus/bus_factory.hpp"
#include "tests/component/security/peer_group.hpp"
#include "tests/support/loopback_capture.hpp"

namespace rtd::security {
namespace {

using test_support::LoopbackCapture;

constexpr int kWireSamples = 50;
const std::string kTopic = "rt/secret", kType = "std_msgs::msg::dds_::String_";

/// Datagrams that hold what.
struct Captured {
  int payload = 0, topic = 0, type = 0;
  int of_writer = 0;    ///< any that its participant has sent
  int permissions = 0;  ///< its permissions: the first messages of two participants, before they have keys
};

/// Goes through all datagrams of loopback while a writer and a reader exchange samples over UDP alone.
class Eavesdropper {
 public:
  explicit Eavesdropper(std::string writer) : writer_(std::move(writer)) {}

  bool permitted() const { return capture_.permitted(); }
  void listen() {
    while (const auto packet = capture_.next(std::chrono::milliseconds(0))) look_at(packet->payload);
  }
  const Captured& captured() const { return captured_; }
  unsigned missed() { return capture_.lost(); }

 private:
  static constexpr std::size_t kPrefixBegin = 8, kPrefixEnd = 20;  // of the sender, in RTPS's header

  void look_at(const std::vector<std::byte>& bytes) {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const auto holds = [&](const std::string& what) { return text.find(what) != std::string_view::npos; };
    captured_.payload += holds("marker-" + writer_);
    if (!text.starts_with("RTPS") || text.size() < kPrefixEnd) return;
    const std::string_view sender = text.substr(kPrefixBegin, kPrefixEnd - kPrefixBegin);
    if (writer_prefix_.empty() && holds(writer_) && !holds("marker-")) writer_prefix_ = sender;  // it sends its name
    if (writer_prefix_ != sender) return;
    ++captured_.of_writer;
    if (holds("c.perm")) return static_cast<void>(++captured_.permissions);
    captured_.topic += holds(kTopic);
    captured_.type += holds(kType);
  }

  const std::string writer_;
  std::string writer_prefix_;
  LoopbackCapture capture_;
  Captured captured_;
};

class WireTest : public ::testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    if (!eavesdropper_.permitted())
      GTEST_SKIP() << "needs CAP_NET_RAW to capture the loopback interface: run it as root";
  }
  /// Shared memory is off: all that the reader gets has been on the wire.
  Captured exchange(const std::string& keystore) {
    peers_.start(writer_, keystore, "/rtd/writer", {kTopic}, {"SECURE_PEER_UDP=1"});
    peers_.start("reader", keystore, "/rtd/reader", {kTopic}, {"SECURE_PEER_UDP=1"});
    EXPECT_TRUE(peers_.wait_until([&] {
      eavesdropper_.listen();
      return peers_.got("reader", writer_) >= kWireSamples;
    })) << peers_.log();
    EXPECT_EQ(eavesdropper_.missed(), 0U);
    const Captured captured = eavesdropper_.captured();
    std::printf(
        "%s: %d samples received; of %d datagrams of the writer %d hold the topic, %d the type, %d its "
        "permissions; %d of all hold the payload\n",
        GetParam().c_str(), peers_.got("reader", writer_), captured.of_writer, captured.topic, captured.type,
        captured.permissions, captured.payload);
    return captured;
  }

  const std::string writer_ = "writer" + std::to_string(getpid());  // of no other process on this host
  Eavesdropper eavesdropper_{writer_};
  PeerGroup peers_{GetParam()};
};

TEST_P(WireTest, without_security_everything_can_be_read) {
  const Captured captured = exchange("-");
  EXPECT_GE(captured.payload, kWireSamples);
  EXPECT_GT(captured.topic, 0);
  EXPECT_GT(captured.type, 0);
}

TEST_P(WireTest, secured_neither_payload_nor_topic_nor_type_is_on_the_wire) {
  const Captured captured = exchange(Keystores(peers_.scratch()).good());
  EXPECT_GE(captured.of_writer, kWireSamples) << "the samples did not go this way";
  EXPECT_EQ(captured.payload, 0);
  EXPECT_EQ(captured.topic, 0);
  EXPECT_EQ(captured.type, 0);
}

INSTANTIATE_TEST_SUITE_P(Vendors, WireTest, ::testing::ValuesIn(bus::dds_vendors()),
                         [](const auto& vendor) { return vendor.param; });

}  // namespace
}  // namespace rtd::security
