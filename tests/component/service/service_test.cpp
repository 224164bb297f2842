// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <future>
#include <thread>
#include <utility>
#include <vector>

#include "common/bus/bus_factory.hpp"
#include "common/bus/message_cdr.hpp"
#include "common/msg/largest_sample.hpp"
#include "common/service/run_service.hpp"
#include "tests/support/eventually.hpp"
#include "tests/support/inprocess/inprocess_bus.hpp"
#include "tests/support/temporary_folder.hpp"

namespace rtd::service {
namespace {

using test_support::eventually;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using namespace std::chrono_literals;

bus::BusOptions domain(std::uint32_t number) {
  bus::BusOptions options;
  options.vendor = bus::inprocess::vendor();
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

/// Forged heartbeats, also those of a process that is there, end no service: not one that starts, not one at work.
TEST(Heartbeat, no_heartbeat_of_its_name_ends_a_service) {
  const auto bus = bus::connect(domain(2)), elsewhere = bus::connect(domain(2));
  StopToken stop;
  const Heartbeat camera(*bus, "camera", stop);
  auto forged = elsewhere->writer(bus::topics::kStatus);
  const msg::ServiceStatus older{.service = "camera",
                                 .pid = getppid(),
                                 .started_ns = 1,
                                 .state = msg::ServiceState::kRunning,
                                 .metrics = {{"host_id", PeerClocks::this_host_id()}}};
  for (int i = 0; i < 20; ++i) forged.write(older);
  Heartbeat filter(*elsewhere, "filter", stop);
  EXPECT_TRUE(eventually([&] { return camera.alive("filter"); })) << "it has read what was sent before";
  EXPECT_FALSE(stop.stop_requested());
}

TEST(Heartbeat, no_other_process_speaks_in_the_name_of_a_service_that_lives) {
  const auto bus = bus::connect(domain(12)), elsewhere = bus::connect(domain(12));
  StopToken stop;
  Heartbeat slam(*bus, "slam", stop), filter(*bus, "filter", stop);
  slam.set_state(msg::ServiceState::kReady);
  ASSERT_TRUE(eventually([&] { return filter.ready("slam"); }));
  std::atomic<bool> ended{false}, synchronized{false};
  filter.on_status([&](const msg::ServiceStatus& status) {
    ended = ended || (status.service == "slam" && status.state == msg::ServiceState::kFinished);
    synchronized = synchronized || status.service == "dense";
  });
  auto forged = elsewhere->writer(bus::topics::kStatus), after = elsewhere->writer(bus::topics::kStatus);
  for (int i = 0; i < 20; ++i) forged.write({.service = "slam", .state = msg::ServiceState::kFinished});
  after.write({.service = "dense"});
  EXPECT_TRUE(eventually([&] { return synchronized.load(); }));
  EXPECT_FALSE(ended);
  EXPECT_TRUE(filter.ready("slam"));
  filter.on_status({});
}

/// With keys only slam's own connection is matched as a writer of rtd/tracking, whoever else may send heartbeats.
TEST(Heartbeat, where_writers_are_known_only_they_speak_for_their_service) {
  const auto bus = bus::connect(domain(13)), elsewhere = bus::connect(domain(13));
  StopToken stop;
  Heartbeat filter(*bus, "filter", stop);
  const auto slams = std::make_shared<bus::SourceGate>(bus::SourceGate::Options{.clock = [] { return 1; }});
  filter.accept_only_from("slam", slams);
  const auto results = bus->reader(
      bus::topics::kTracking, [](const auto&) {}, slams->callbacks());
  auto forged = elsewhere->writer(bus::topics::kStatus), after = elsewhere->writer(bus::topics::kStatus);
  for (int i = 0; i < 20; ++i) forged.write({.service = "slam", .state = msg::ServiceState::kRunning});
  after.write({.service = "dense"});
  EXPECT_TRUE(eventually([&] { return filter.alive("dense"); }));
  EXPECT_FALSE(filter.alive("slam"));
  const auto slam_bus = bus::connect(domain(13));
  const auto tracking = slam_bus->writer(bus::topics::kTracking);
  const Heartbeat slam(*slam_bus, "slam", stop);
  EXPECT_TRUE(eventually([&] { return filter.alive("slam"); }));
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

TEST(Heartbeat, has_the_metrics_that_it_has_room_for) {
  const auto bus = bus::connect(domain(3));
  StopToken stop;
  std::atomic<std::size_t> most{0}, metrics{0};
  Heartbeat filter(*bus, "filter", stop);
  for (int i = 0; i < 2000; ++i) filter.set_metric(std::string(60, 'n') + std::to_string(i), 1);
  const auto reader = bus->reader(bus::topics::kStatus, [&](const std::shared_ptr<const msg::ServiceStatus>& status) {
    most = std::max(most.load(), bus::cdr_size(*status));
    metrics = status->metrics.size();
  });
  EXPECT_TRUE(eventually([&] { return metrics > 0; }));
  EXPECT_GT(metrics, 500U);
  EXPECT_LE(most, msg::largest_sample<msg::ServiceStatus>()) << "others would not receive it";
}

TEST(Heartbeat, a_word_replaces_the_one_with_the_same_prefix) {
  const auto bus = bus::connect(domain(3));
  StopToken stop;
  std::atomic<bool> seen{false};
  Heartbeat slam(*bus, "slam", stop);
  slam.on_status([&](const msg::ServiceStatus& status) {
    const auto words = std::ranges::count_if(status.metrics, [](const auto& m) { return m.name.starts_with("mode."); });
    seen = seen || (words == 1 && msg::word_of(status, "mode.") == "rtd-paper");
  });
  Heartbeat filter(*bus, "filter", stop);
  filter.set_word("mode.", "rtd");
  filter.set_word("mode.", "rtd-paper");
  EXPECT_TRUE(eventually([&] { return seen.load(); }));
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
    void bind(ConfigBinder& binder) { binder.field("count", count, {1, 10}, "how many").option("--count"); }
  };

  int run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "rtd-filter");
    std::vector<char*> argv;
    argv.reserve(arguments.size());
    for (std::string& argument : arguments) argv.push_back(argument.data());
    return run_service(
        {"filter", "A service for tests", [this](ConfigBinder& binder) { binder.section("filter", config_); },
         [this](Runtime& runtime) { return body_(runtime); }},
        static_cast<int>(argv.size()), argv.data());
  }

  Config config_;
  std::function<ExitCode(Runtime&)> body_ = [](Runtime&) { return kOk; };
};

TEST_F(RunServiceTest, runs_and_returns_the_code_of_the_service) {
  body_ = [](Runtime&) { return kRunFailed; };
  EXPECT_EQ(run({"--dds", bus::inprocess::vendor()}), kRunFailed);
}

TEST_F(RunServiceTest, own_option_wins_over_set_and_set_over_file) {
  const rtd::test::TemporaryFolder folder;
  const std::string path = folder.write("config.yaml", "filter: {count: 4}\nslam: {whatever: 1}\n");
  EXPECT_EQ(run({"--dds", bus::inprocess::vendor(), "--config", path}), kOk);
  EXPECT_EQ(config_.count, 4);
  EXPECT_EQ(run({"--dds", bus::inprocess::vendor(), "--config", path, "--set", "filter.count=5"}), kOk);
  EXPECT_EQ(config_.count, 5);
  EXPECT_EQ(run({"--dds", bus::inprocess::vendor(), "--config", path, "--set", "filter.count=5", "--count", "6"}), kOk);
  EXPECT_EQ(config_.count, 6);
}

TEST_F(RunServiceTest, a_second_one_in_the_domain_ends_with_its_own_code) {
  body_ = [this, depth = std::make_shared<int>(0)](Runtime&) {
    if ((*depth)++ > 0) return kOk;
    testing::internal::CaptureStderr();
    const int second = run({"--dds", bus::inprocess::vendor()});
    const std::string text = testing::internal::GetCapturedStderr();
    EXPECT_EQ(second, kAlreadyRuns);
    EXPECT_THAT(text, HasSubstr("another filter (pid " + std::to_string(getpid()) + ")"));
    EXPECT_THAT(text, HasSubstr("--domain"));
    EXPECT_EQ(run({"--dds", bus::inprocess::vendor(), "--domain", "77"}), kOk);
    EXPECT_EQ(run({"--dds", bus::inprocess::vendor(), "--robot", "anna"}), kOk);
    *depth = 1;
    return kOk;
  };
  EXPECT_EQ(run({"--dds", bus::inprocess::vendor()}), kOk);
  EXPECT_EQ(run({"--dds", bus::inprocess::vendor()}), kOk) << "the place is free again";
}

TEST_F(RunServiceTest, wrong_use_ends_with_two) {
  EXPECT_EQ(run({"--nonsense"}), kUsageOrConfig);
  EXPECT_EQ(run({"--dds", "zeromq"}), kUsageOrConfig);
  EXPECT_EQ(run({"--dds", bus::inprocess::vendor(), "--pace", "slow"}), kUsageOrConfig);
  EXPECT_EQ(run({"--dds", bus::inprocess::vendor(), "--domain", "300"}), kUsageOrConfig);
  EXPECT_EQ(run({"--dds", bus::inprocess::vendor(), "--set", "filter.count=11"}), kUsageOrConfig);
  EXPECT_EQ(run({"--dds", bus::inprocess::vendor(), "--config", "/nonexistent.yaml"}), kUsageOrConfig);
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
    arguments.insert(arguments.begin(), {"--dds", bus::inprocess::vendor()});
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
  const rtd::test::TemporaryFolder folder;
  const std::string path = folder.write("profile.yaml", "bus: {network: {multicast: false, peers: [a]}}\n");
  EXPECT_FALSE(network_of({"--profile", "lan", "--config", path}).multicast);
  EXPECT_THAT(network_of({"--profile", path}).peers, ElementsAre("a"));
  EXPECT_THAT(network_of({"--profile", path, "--set", "bus.network.peers=[b]"}).peers, ElementsAre("b"));
  EXPECT_THAT(network_of({"--profile", path, "--set", "bus.network.peers=[b]", "--peers", "c"}).peers,
              ElementsAre("c"));
}

TEST_F(BusOptionsTest, an_unknown_profile_names_the_known_ones) {
  for (const char* profile : {"lna", "/no/such.yaml", "/tmp"}) {
    ::testing::internal::CaptureStderr();
    EXPECT_EQ(run({"--dds", bus::inprocess::vendor(), "--profile", profile}), kUsageOrConfig);
    EXPECT_THAT(::testing::internal::GetCapturedStderr(), HasSubstr("lan, localhost, secure, wifi")) << profile;
  }
}

TEST_F(RunServiceTest, an_exception_is_a_failed_run) {
  body_ = [](Runtime&) -> ExitCode { throw std::runtime_error("the sky fell"); };
  EXPECT_EQ(run({"--dds", bus::inprocess::vendor()}), kRunFailed);
}

TEST_F(RunServiceTest, sigterm_asks_the_service_to_stop) {
  body_ = [](Runtime& runtime) {
    kill(getpid(), SIGTERM);
    return runtime.stop.wait_for(5s) ? kOk : kRunFailed;
  };
  EXPECT_EQ(run({"--dds", bus::inprocess::vendor()}), kOk);
}

TEST(BoundedEndTest, ends_the_process_only_when_its_time_is_up) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const auto hang = [] {
    BoundedEnd end("rtd-slam");
    end.begin(7, 50ms);
    std::this_thread::sleep_for(60s);
  };
  EXPECT_EXIT(hang(), ::testing::ExitedWithCode(7), "rtd-slam: the bus did not end within 50 ms");
  BoundedEnd end("rtd-slam");
  end.begin(7, 60s);
}

TEST_F(RunServiceTest, one_that_was_asked_to_end_goes_before_it_is_killed) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  struct Stuck {
    ~Stuck() { std::this_thread::sleep_for(60s); }
    ExitCode run() { return kPartialLoss; }
  };
  body_ = [](Runtime& runtime) {
    runtime.stop.request_stop();
    return run_to_end(Stuck(), runtime);
  };
  EXPECT_EXIT(run({"--dds", bus::inprocess::vendor()}), ::testing::ExitedWithCode(kPartialLoss),
              "did not end within 400 ms");
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
  EXPECT_EQ(run({"--dds", bus::inprocess::vendor()}), kRunFailed);
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
