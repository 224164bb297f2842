// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// Programs of ROS 2 on this host find ours, and ours find them, under each setting under which they would find their
/// own: doubles that set up their participants as the RMWs do.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <string>
#include <thread>
#include <tuple>
#include <vector>

#include "common/bus/bus_factory.hpp"
#include "common/bus/topics.hpp"
#include "tests/interop/bus/rmw_double.hpp"
#include "tests/interop/bus/talking_process.hpp"
#include "tests/support/sanitizers.hpp"
#include "tests/support/test_domain.hpp"

namespace rtd::bus {
namespace {

using test_support::TalkingProcess;
using namespace std::chrono_literals;

/// One of ours that writes poses all the time and counts what it receives.
class Ours {
 public:
  explicit Ours(const BusOptions& options) : bus_(connect(options)), writer_(bus_->writer(topics::kPose)) {
    reader_ = bus_->reader<msg::PoseStamped>(topics::kGroundTruth, [this](const auto&) { ++received_; });
    talking_ = std::thread([this] {
      msg::PoseStamped pose;
      pose.pose.orientation.w = 1;
      while (!ended_) {
        writer_.write(pose);
        std::this_thread::sleep_for(20ms);
      }
    });
  }
  ~Ours() {
    ended_ = true;
    talking_.join();
  }
  int take_received() { return received_.exchange(0); }
  bool wait_received(std::chrono::milliseconds patience) const {
    const auto end = std::chrono::steady_clock::now() + patience;
    while (received_ == 0 && std::chrono::steady_clock::now() < end) std::this_thread::sleep_for(5ms);
    return received_ > 0;
  }

 private:
  std::atomic<int> received_{0};
  std::atomic<bool> ended_{false};
  std::shared_ptr<Bus> bus_;
  Writer<msg::PoseStamped> writer_;
  Reader<msg::PoseStamped> reader_;
  std::thread talking_;
};

class RmwDiscovery : public testing::TestWithParam<std::tuple<std::string, std::string>> {
 protected:
  RmwDiscovery() {
    options_.vendor = std::get<0>(GetParam());
    options_.domain = test_domain();
    options_.participant_name = "rmw-discovery";
  }
  std::string setting_text(const std::string& setting) const {
    return options_.vendor + " and " + std::get<1>(GetParam()) + ", " + setting;
  }
  /// With sanitizers our Cyclone DDS is on loopback alone, where it cannot answer at the address of the network, which
  /// all others announce.
  bool is_in_reach(const std::string& setting) const {
    if (setting == "OFF") return false;
    return options_.vendor == "fastdds" || !test_support::kSanitized || setting == "localhost_only=1";
  }
  std::unique_ptr<TalkingProcess> start_ros(const std::string& setting) const {
    return std::make_unique<TalkingProcess>(
        std::vector<std::string>{RMW_DOUBLE, std::get<1>(GetParam()), setting, std::to_string(options_.domain)});
  }
  /// A program of ROS 2 with this setting and `ours` receive of each other.
  void expect_found(Ours& ours, const std::string& setting) const {
    const auto ros = start_ros(setting);
    ours.take_received();
    ros->send("look " + std::to_string(kPatience.count()));
    const std::string answer = ros->receive();
    ASSERT_TRUE(answer.starts_with("received ")) << setting_text(setting) << ": " << answer;
    EXPECT_NE(answer, "received 0") << setting_text(setting) << ": ROS 2 receives from ours";
    EXPECT_TRUE(ours.wait_received(kPatience)) << setting_text(setting) << ": ours receives from ROS 2";
  }
  /// Programs with these settings, all at once, and `ours` receive nothing of each other.
  void expect_not_found(Ours& ours, const std::vector<std::string>& settings) const {
    std::vector<std::unique_ptr<TalkingProcess>> programs;
    for (const std::string& setting : settings) programs.push_back(start_ros(setting));
    ours.take_received();
    for (const auto& ros : programs) ros->send("look " + std::to_string(kInVain.count()));
    for (std::size_t i = 0; i < programs.size(); ++i)
      EXPECT_EQ(programs[i]->receive(), "received 0") << setting_text(settings[i]) << ": ROS 2 receives from ours";
    EXPECT_EQ(ours.take_received(), 0) << setting_text("any") << ": ours receives from ROS 2";
  }

  static constexpr std::chrono::milliseconds kPatience{15000}, kInVain{2500};

  BusOptions options_;
};

TEST_P(RmwDiscovery, programs_of_this_host_are_found_where_ros_finds_its_own) {
  Ours ours(options_);
  std::vector<std::string> unreachable;
  for (const std::string setting : test_support::kRosSettings)
    is_in_reach(setting) ? expect_found(ours, setting) : unreachable.push_back(setting);
  expect_not_found(ours, unreachable);
}

TEST_P(RmwDiscovery, multicast_is_not_needed) {
  options_.network.multicast = false;
  Ours ours(options_);
  for (const std::string setting : {"localhost_only=1", "LOCALHOST"})
    if (is_in_reach(setting)) expect_found(ours, setting);
}

/// More processes than Fast DDS asks by itself (four).
TEST_P(RmwDiscovery, the_last_of_many_is_found_without_multicast) {
  std::vector<std::shared_ptr<Bus>> others;
  for (int i = 0; i < 10; ++i) {
    BusOptions other = options_;
    other.vendor = "fastdds";  // of Cyclone DDS all in one process share a port
    others.push_back(connect(other));
  }
  Ours ours(options_);
  is_in_reach("LOCALHOST") ? expect_found(ours, "LOCALHOST") : expect_not_found(ours, {"LOCALHOST"});
}

INSTANTIATE_TEST_SUITE_P(Vendors, RmwDiscovery,
                         testing::Combine(testing::ValuesIn(dds_vendors()),
                                          testing::Values("rmw_fastrtps", "rmw_cyclonedds")),
                         [](const auto& tested) {
                           return std::get<0>(tested.param) + "_and_" + std::get<1>(tested.param);
                         });

}  // namespace
}  // namespace rtd::bus
