// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <csignal>
#include <fstream>
#include <future>
#include <thread>
#include <utility>
#include <vector>

#include "common/bus/bus_factory.hpp"
#include "common/service/run_service.hpp"

namespace rtd::service {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using namespace std::chrono_literals;

/// Waits until the condition holds, at most five seconds.
template <class Condition>
bool eventually(Condition condition) {
  for (int i = 0; i < 1000; ++i) {
    if (condition()) return true;
    std::this_thread::sleep_for(5ms);
  }
  return false;
}

bus::BusOptions domain(std::uint32_t number) {
  bus::BusOptions options;
  options.vendor = "inprocess";
  options.domain = number;
  return options;
}

TEST(Heartbeat, peers_see_each_other_and_notice_the_end) {
  const auto bus = bus::connect(domain(1));
  StopToken stop;
  Heartbeat filter(*bus, "filter", stop);
  {
    Heartbeat slam(*bus, "slam", stop);
    slam.set_state(msg::ServiceState::kReady);
    EXPECT_TRUE(eventually([&] { return filter.ready("slam"); }));
    EXPECT_FALSE(filter.ready("camera"));
  }
  EXPECT_TRUE(eventually([&] { return !filter.alive("slam"); }));
}

TEST(Heartbeat, the_younger_of_two_equal_services_ends) {
  const auto bus = bus::connect(domain(2));
  StopToken stop_first, stop_second;
  Heartbeat first(*bus, "camera", stop_first);
  Heartbeat second(*bus, "camera", stop_second);
  EXPECT_TRUE(eventually([&] { return stop_second.stop_requested(); }));
  EXPECT_THAT(second.duplicate(), HasSubstr("--domain"));
  EXPECT_FALSE(stop_first.stop_requested());
}

TEST(Heartbeat, several_of_one_name_go_on_where_that_is_allowed) {
  const auto bus = bus::connect(domain(12));
  StopToken stop_first, stop_second;
  Heartbeat first(*bus, "detector_box", stop_first, Heartbeat::Twins::kAllowed);
  Heartbeat second(*bus, "detector_box", stop_second, Heartbeat::Twins::kAllowed);
  EXPECT_LT(first.started_ns(), second.started_ns());
  EXPECT_FALSE(stop_second.wait_for(600ms)) << second.duplicate();
  EXPECT_FALSE(stop_first.stop_requested());
}

/// Malformed or malicious heartbeats end no service at work.
TEST(Heartbeat, a_service_that_has_run_for_a_while_does_not_end_for_a_duplicate) {
  const auto bus = bus::connect(domain(11));
  StopToken stop;
  Heartbeat camera(*bus, "camera", stop);
  auto writer = bus->writer(bus::topics::kStatus);
  msg::ServiceStatus older{.service = "camera", .pid = 1, .started_ns = 1, .state = msg::ServiceState::kRunning};
  std::this_thread::sleep_for(std::chrono::milliseconds(5200));
  for (int i = 0; i < 5; ++i) writer.write(older);
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  EXPECT_FALSE(stop.stop_requested()) << camera.duplicate();
}

TEST(Heartbeat, metrics_travel) {
  const auto bus = bus::connect(domain(3));
  StopToken stop;
  std::atomic<double> seen{0};
  Heartbeat slam(*bus, "slam", stop);
  slam.on_status([&](const msg::ServiceStatus& status) {
    for (const auto& metric : status.metrics) {
      if (metric.name == "frames_dropped") seen = metric.value;
    }
  });
  Heartbeat filter(*bus, "filter", stop);
  filter.set_metric("frames_dropped", 1);
  filter.set_metric("frames_dropped", 7);
  EXPECT_TRUE(eventually([&] { return seen == 7; }));
}

TEST(Heartbeat, removing_the_callback_waits_for_a_running_call) {
  const auto bus = bus::connect(domain(4));
  StopToken stop;
  std::promise<void> entered, leave;
  std::atomic<bool> left{false};
  Heartbeat slam(*bus, "slam", stop);
  slam.on_status([&, first = true](const msg::ServiceStatus&) mutable {
    if (!std::exchange(first, false)) return;
    entered.set_value();
    leave.get_future().wait();
    left = true;
  });
  Heartbeat filter(*bus, "filter", stop);
  ASSERT_EQ(entered.get_future().wait_for(5s), std::future_status::ready);
  auto removed = std::async(std::launch::async, [&] {
    slam.on_status({});
    return left.load();
  });
  EXPECT_EQ(removed.wait_for(50ms), std::future_status::timeout);
  leave.set_value();
  EXPECT_TRUE(removed.get());
}

TEST(NoPeersWarning, names_the_domain_of_a_service_without_peers) {
  const auto bus = bus::connect(domain(5));
  StopToken stop;
  std::promise<std::string> warned;
  const Heartbeat slam(*bus, "slam", stop);
  const NoPeersWarning warning(
      slam, domain(5), [&](const std::string& cause) { warned.set_value(cause); }, 50ms);
  auto cause = warned.get_future();
  ASSERT_EQ(cause.wait_for(5s), std::future_status::ready);
  EXPECT_THAT(cause.get(), HasSubstr("no other service is in DDS domain 5"));
}

TEST(NoPeersWarning, is_silent_with_peers_and_at_the_end) {
  const auto bus = bus::connect(domain(6));
  StopToken stop;
  std::atomic<bool> warned{false};
  const Heartbeat slam(*bus, "slam", stop), filter(*bus, "filter", stop);
  ASSERT_TRUE(eventually([&] { return !slam.alone(); }));
  const auto warn = [&](const std::string&) { warned = true; };
  { const NoPeersWarning ends(slam, domain(6), warn); }
  const NoPeersWarning warning(slam, domain(6), warn, 1ms);
  std::this_thread::sleep_for(50ms);
  EXPECT_FALSE(warned);
}

/// Runs a service definition with a command line.
class RunServiceTest : public ::testing::Test {
 protected:
  struct Config {
    int count = 3;
    void bind(ConfigBinder& binder) { binder.field("count", count, {1, 10}, "how many"); }
  };

  int run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "rtd-filter");
    std::vector<char*> argv;
    argv.reserve(arguments.size());
    for (std::string& argument : arguments) argv.push_back(argument.data());
    return run_service({"filter", "A service for tests",
                        [this](CLI::App& app) { app.add_option("--count", config_.count, "how many"); },
                        [this](ConfigBinder& binder) { binder.section("filter", config_); },
                        [this](Runtime& runtime) { return body_(runtime); }},
                       static_cast<int>(argv.size()), argv.data());
  }

  Config config_;
  std::function<ExitCode(Runtime&)> body_ = [](Runtime&) { return kOk; };
};

TEST_F(RunServiceTest, runs_and_returns_the_code_of_the_service) {
  body_ = [](Runtime&) { return kRunFailed; };
  EXPECT_EQ(run({"--dds", "inprocess"}), kRunFailed);
}

TEST_F(RunServiceTest, own_option_wins_over_set_and_set_over_file) {
  const std::string path = ::testing::TempDir() + "/rtd_service_test.yaml";
  std::ofstream(path) << "filter: {count: 4}\nslam: {whatever: 1}\n";
  EXPECT_EQ(run({"--dds", "inprocess", "--config", path}), kOk);
  EXPECT_EQ(config_.count, 4);
  EXPECT_EQ(run({"--dds", "inprocess", "--config", path, "--set", "filter.count=5"}), kOk);
  EXPECT_EQ(config_.count, 5);
  EXPECT_EQ(run({"--dds", "inprocess", "--config", path, "--set", "filter.count=5", "--count", "6"}), kOk);
  EXPECT_EQ(config_.count, 6);
}

TEST_F(RunServiceTest, wrong_use_ends_with_two) {
  EXPECT_EQ(run({"--nonsense"}), kUsageOrConfig);
  EXPECT_EQ(run({"--dds", "zeromq"}), kUsageOrConfig);
  EXPECT_EQ(run({"--dds", "inprocess", "--pace", "slow"}), kUsageOrConfig);
  EXPECT_EQ(run({"--dds", "inprocess", "--domain", "300"}), kUsageOrConfig);
  EXPECT_EQ(run({"--dds", "inprocess", "--set", "filter.count=11"}), kUsageOrConfig);
  EXPECT_EQ(run({"--dds", "inprocess", "--config", "/nonexistent.yaml"}), kUsageOrConfig);
}

/// What a service is given as bus options.
class BusOptionsTest : public RunServiceTest {
 protected:
  bus::NetworkOptions network_of(std::vector<std::string> arguments) {
    bus::NetworkOptions network;
    body_ = [&network](Runtime& runtime) {
      network = runtime.bus_options.network;
      return kOk;
    };
    arguments.insert(arguments.begin(), {"--dds", "inprocess"});
    EXPECT_EQ(run(arguments), kOk);
    return network;
  }
};

TEST_F(BusOptionsTest, a_profile_opens_the_network_and_cuts_datagrams) {
  EXPECT_TRUE(network_of({}).loopback_only);
  EXPECT_EQ(network_of({}).max_datagram_bytes, network_of({"--profile", "localhost"}).max_datagram_bytes);
  for (const char* profile : {"lan", "wifi", "secure"}) {
    const bus::NetworkOptions network =
        network_of({"--profile", profile, "--set", "bus.security.enabled=false"});  // no keys here
    EXPECT_FALSE(network.loopback_only) << profile;
    EXPECT_LE(network.max_datagram_bytes, 1400) << profile;
    EXPECT_EQ(network.multicast, std::string(profile) != "wifi") << profile;
  }
}

TEST_F(BusOptionsTest, peers_and_interfaces_are_lists) {
  const bus::NetworkOptions network =
      network_of({"--profile", "lan", "--peers", "10.0.0.2:7410,gpubox", "--interface", "eth0,wlan0"});
  EXPECT_THAT(network.peers, ElementsAre("10.0.0.2:7410", "gpubox"));
  EXPECT_THAT(network.interfaces, ElementsAre("eth0", "wlan0"));
}

TEST_F(BusOptionsTest, a_file_wins_over_the_profile_and_own_options_over_both) {
  const std::string path = ::testing::TempDir() + "/rtd_bus_options_test.yaml";
  std::ofstream(path) << "bus: {network: {multicast: false, peers: [a]}}\n";
  EXPECT_FALSE(network_of({"--profile", "lan", "--config", path}).multicast);
  EXPECT_THAT(network_of({"--profile", path}).peers, ElementsAre("a"));
  EXPECT_THAT(network_of({"--profile", path, "--set", "bus.network.peers=[b]"}).peers, ElementsAre("b"));
  EXPECT_THAT(network_of({"--profile", path, "--set", "bus.network.peers=[b]", "--peers", "c"}).peers,
              ElementsAre("c"));
}

TEST_F(BusOptionsTest, an_unknown_profile_names_the_known_ones) {
  for (const char* profile : {"lna", "/no/such.yaml", "/tmp"}) {
    ::testing::internal::CaptureStderr();
    EXPECT_EQ(run({"--dds", "inprocess", "--profile", profile}), kUsageOrConfig);
    EXPECT_THAT(::testing::internal::GetCapturedStderr(), HasSubstr("lan, localhost, secure, wifi")) << profile;
  }
}

TEST_F(RunServiceTest, an_exception_is_a_failed_run) {
  body_ = [](Runtime&) -> ExitCode { throw std::runtime_error("the sky fell"); };
  EXPECT_EQ(run({"--dds", "inprocess"}), kRunFailed);
}

TEST_F(RunServiceTest, sigterm_asks_the_service_to_stop) {
  body_ = [](Runtime& runtime) {
    kill(getpid(), SIGTERM);
    return runtime.stop.wait_for(5s) ? kOk : kRunFailed;
  };
  EXPECT_EQ(run({"--dds", "inprocess"}), kOk);
}

TEST(BoundedEndTest, ends_the_process_only_when_its_time_is_up) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const auto hang = [] {
    BoundedEnd end("rtd-slam", 50ms);
    end.begin(7);
    std::this_thread::sleep_for(60s);
  };
  EXPECT_EXIT(hang(), ::testing::ExitedWithCode(7), "rtd-slam: the bus did not end within 50 ms");
  BoundedEnd end("rtd-slam", 60s);
  end.begin(7);
}

TEST_F(RunServiceTest, the_end_is_bounded_before_a_service_is_destroyed) {
  static std::vector<std::string> steps;
  struct Service {
    ~Service() { steps.push_back("destroyed"); }
    ExitCode run() {
      steps.push_back("run");
      return kRunFailed;
    }
  };
  body_ = [](Runtime& runtime) {
    runtime.bound_end = [](int code) { steps.push_back("bounded " + std::to_string(code)); };
    return run_to_end(Service(), runtime);
  };
  EXPECT_EQ(run({"--dds", "inprocess"}), kRunFailed);
  EXPECT_EQ(steps, (std::vector<std::string>{"run", "bounded 1", "destroyed"}));
}

TEST_F(RunServiceTest, print_config_does_not_run_the_service) {
  body_ = [](Runtime&) -> ExitCode { throw std::runtime_error("must not run"); };
  EXPECT_EQ(run({"--print-config"}), kOk);
}

TEST_F(RunServiceTest, names_its_version) {
  body_ = [](Runtime&) -> ExitCode { throw std::runtime_error("must not run"); };
  testing::internal::CaptureStdout();
  EXPECT_EQ(run({"--version"}), kOk);
  EXPECT_THAT(testing::internal::GetCapturedStdout(), testing::MatchesRegex("rtd-[a-z]+ [0-9]+\\.[0-9]+\\.[0-9]+\n"));
}

}  // namespace
}  // namespace rtd::service
