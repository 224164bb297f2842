// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// The default profile keeps to the host: another host that asks for its processes directly gets no answer, and they do
/// not need the network.
#include <gmock/gmock.h>

#include "common/bus/bus_factory.hpp"
#include "tests/interop/network/two_hosts.hpp"

namespace rtd {
namespace {

using launcher::RtdCommand;
using test_support::TwoHosts;
using namespace ::testing;

/// By vendor.
class OneHost : public ::testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    if (const std::string why = TwoHosts::unavailable(); !why.empty()) GTEST_SKIP() << why;
    hosts_.emplace(0);
    start(camera_, 'a', {"camera", "--source", "synthetic:static?width=160&height=120&fps=10", "--pace", "realtime"});
  }
  void start(RtdCommand& command, char host, std::vector<std::string> words) {
    words.insert(words.begin(), RTD_EXECUTABLE);
    words.insert(words.end(), {"--dds", GetParam(), "--domain", "7"});
    command.start(hosts_->on(host, words));
  }
  std::string on_a(const std::vector<std::string>& words) {
    RtdCommand command("/usr/bin/nsenter");
    command.start(hosts_->on('a', words));
    EXPECT_EQ(command.wait(), 0) << command.output();
    return command.output();
  }
  std::string listed(char host, const std::vector<std::string>& more = {}) {
    std::vector<std::string> words = {"topics", "list", "--wait", "6"};
    words.insert(words.end(), more.begin(), more.end());
    RtdCommand list("/usr/bin/nsenter");
    start(list, host, words);
    list.wait();
    return list.output();
  }

  std::optional<TwoHosts> hosts_;
  RtdCommand camera_{"/usr/bin/nsenter"};
};

TEST_P(OneHost, does_not_answer_another_one) {
  EXPECT_THAT(listed('a'), HasSubstr("/camera/color/camera_info"));
  on_a({"nft", "table ip sent { chain out { type filter hook output priority 0; ip daddr " +
                   std::string(TwoHosts::kAddressB) + " meta l4proto udp counter; }; }"});
  EXPECT_THAT(listed('b', {"--profile", "lan", "--peers", TwoHosts::kAddressA}), Not(HasSubstr("/camera")));
  EXPECT_THAT(on_a({"nft", "list table ip sent"}), HasSubstr("counter packets 0 bytes 0"));
}

TEST_P(OneHost, does_not_need_its_network) {
  RtdCommand rate("/usr/bin/nsenter");
  start(rate, 'a', {"topics", "hz", "rtd/status", "--duration", "8"});
  std::this_thread::sleep_for(std::chrono::seconds(3));
  hosts_->cut();
  EXPECT_EQ(rate.wait(), 0) << rate.output();
  EXPECT_THAT(rate.output(), AllOf(ContainsRegex("rtd/status +(3\\.[5-9]|[45]\\.)"), Not(HasSubstr("failed"))));
  EXPECT_THAT(listed('a'), HasSubstr("/camera/color/camera_info")) << "who joins without a network";
}

INSTANTIATE_TEST_SUITE_P(Vendors, OneHost, ::testing::ValuesIn(bus::dds_vendors()),
                         [](const auto& tested) { return tested.param; });

}  // namespace
}  // namespace rtd
