// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// One detector for several robots, over Fast DDS: robots are doubles that check every answer, and what stands in for
// the network reads from the pixels whose image it is.
#include <gmock/gmock.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <future>
#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <thread>
#include <vector>

#include "common/service/peer_clocks.hpp"
#include "services/detector/fleet_service.hpp"
#include "tests/support/eventually.hpp"
#include "tests/support/fleet/robot_double.hpp"
#include "tests/support/sanitizers.hpp"
#include "tests/support/test_domain.hpp"
#include "tests/support/time_bounds.hpp"

namespace rtd::detector {
namespace {

using test_support::eventually;
using namespace std::chrono_literals;
using test_support::quantile;
using test_support::RobotDouble;
using ::testing::HasSubstr;

bus::BusOptions loopback() {
  bus::BusOptions options;
  options.vendor = "fastdds";
  options.domain = test_domain();
  options.participant_name = "fleet-test";
  return options;
}

const auto kStandsIn = [] { return std::string("stands in"); };

/// So long for each batch, and for each image of it.
Inference stand_in(std::chrono::microseconds per_batch, std::chrono::microseconds per_image = 0us) {
  return {[per_batch, per_image](std::span<const cv::Mat> images) {
            std::this_thread::sleep_for(per_batch + per_image * images.size());
            return test_support::read_all_marks(images);
          },
          kStandsIn};
}

/// A process with a detector for several robots, but for the process.
class Box {
 public:
  Box(FleetConfig config, Inference inference)
      : bus_(bus::connect(loopback())),
        heartbeat_(*bus_, FleetService::kHeartbeatName, stop_, service::Heartbeat::SecondInstance::kAllowed),
        runtime_{*bus_, heartbeat_, stop_, service::Pace::kRealtime, loopback()},
        running_(std::async(std::launch::async, [this, config = std::move(config), inference = std::move(inference)] {
          return FleetService(config, runtime_, inference).run();
        })) {}
  ~Box() { stop(); }
  Box(const Box&) = delete;
  Box& operator=(const Box&) = delete;

  void stop() {
    stop_.request_stop();
    if (running_.valid()) {
      EXPECT_EQ(running_.get(), service::kOk);
    }
  }
  /// Its exit code when it ends by itself.
  service::ExitCode wait_end() { return running_.get(); }

 private:
  service::StopToken stop_;
  std::shared_ptr<bus::Bus> bus_;
  service::Heartbeat heartbeat_;
  service::Runtime runtime_;
  std::future<service::ExitCode> running_;
};

/// What boxes say about themselves on rtd/status.
class BoxWatcher {
 public:
  BoxWatcher()
      : bus_(bus::connect(loopback())),
        reader_(bus_->reader<msg::ServiceStatus>(bus::topics::kStatus, [this](const auto& status) {
          const std::lock_guard lock(mutex_);
          if (status->service == FleetService::kHeartbeatName) messages_[status->started_ns] = status->message;
        })) {}
  /// Of any box.
  bool wait_message(const std::string& text, std::chrono::milliseconds patience = 20s) const {
    for (const auto give_up = std::chrono::steady_clock::now() + patience; std::chrono::steady_clock::now() < give_up;
         std::this_thread::sleep_for(10ms)) {
      const std::lock_guard lock(mutex_);
      for (const auto& [box, message] : messages_)
        if (message.find(text) != std::string::npos) return true;
    }
    return false;
  }

 private:
  mutable std::mutex mutex_;
  std::map<std::int64_t, std::string> messages_;
  std::shared_ptr<bus::Bus> bus_;
  bus::Reader<msg::ServiceStatus> reader_;
};

using Robots = std::vector<std::unique_ptr<RobotDouble>>;

std::unique_ptr<RobotDouble> robot(RobotDouble::Options options) {
  return std::make_unique<RobotDouble>(loopback(), std::move(options));
}

/// r0, r1, ... with images of several sizes.
Robots robots(int count, double rate_hz) {
  const cv::Size sizes[] = {{320, 240}, {640, 480}, {160, 120}};
  Robots all;
  for (int id = 0; id < count; ++id)
    all.push_back(robot({"r" + std::to_string(id), id, rate_hz, sizes[id % 3], false}));
  return all;
}

void wait_served(const Robots& all) {
  for (const auto& one : all) ASSERT_TRUE(one->wait_answers(3));
  for (const auto& one : all) one->take_figures();
}

double metric(const std::optional<msg::ServiceStatus>& status, const std::string& name) {
  return status ? service::find_metric(*status, name).value_or(-1) : -1;
}

TEST(Fleet, serves_eight_robots_at_their_rate_and_mixes_up_none) {
  if (test_support::kSanitized) GTEST_SKIP() << test_support::kTooSlow;
  Robots all = robots(7, 30);
  all.push_back(robot({"", 7}));
  Box box({}, stand_in(3ms));
  wait_served(all);
  std::this_thread::sleep_for(5s);
  std::vector<double> latencies_ms;
  for (const auto& one : all) {
    const RobotDouble::Figures figures = one->take_figures();
    EXPECT_EQ(figures.wrong, 0u);
    EXPECT_GT(figures.answered, 0u);
    if (!test_support::checks_time()) continue;
    EXPECT_GE(static_cast<double>(figures.answered), 0.95 * static_cast<double>(figures.sent));
    latencies_ms.insert(latencies_ms.end(), figures.latencies_ms.begin(), figures.latencies_ms.end());
  }
  if (!test_support::checks_time()) return;
  EXPECT_GE(latencies_ms.size(), 0.95 * 8 * 5 * 30);
  EXPECT_LE(quantile(latencies_ms, 0.99), 60);
}

TEST(Fleet, mixes_up_no_answers_at_full_speed) {
  Robots all = robots(8, 300);
  Box box({.queue = {.batch = 4}, .decoders = 3}, stand_in(0us));
  wait_served(all);
  std::this_thread::sleep_for(3s);
  std::uint64_t answered = 0;
  for (const auto& one : all) {
    const RobotDouble::Figures figures = one->take_figures();
    EXPECT_EQ(figures.wrong, 0u);
    answered += figures.answered;
  }
  EXPECT_GE(answered, test_support::checks_time() ? 1000u : 100u);
}

TEST(Fleet, reports_to_each_robot_how_it_is_served) {
  const auto anna = robot({"anna", 1});
  Box box({}, stand_in(1ms));
  ASSERT_TRUE(eventually([&] { return metric(anna->status(), "frames") >= 90; }));
  const auto status = anna->status();
  EXPECT_EQ(status->state, msg::ServiceState::kRunning);
  EXPECT_EQ(status->message, "stands in, 1 robot");
  EXPECT_EQ(metric(status, "batch_mean"), 1);
  EXPECT_GT(metric(status, "rate_hz"), test_support::checks_time() ? 25 : 1);
  EXPECT_GT(metric(status, "latency_p50_ms"), 0.5);
  EXPECT_GE(metric(status, "latency_p99_ms"), metric(status, "latency_p50_ms"));
  box.stop();
  EXPECT_TRUE(eventually([&] { return anna->status()->state == msg::ServiceState::kFinished; }));
}

/// The network takes 20 ms for each image: four robots get 12 a second each.
TEST(Fleet, a_flooding_robot_costs_the_others_nothing) {
  if (test_support::kSanitized) GTEST_SKIP() << test_support::kTooSlow;
  Robots all = robots(3, 30);
  const auto noisy = robot({"noisy", 9, 30, {160, 120}});
  Box box({.queue = {.batch = 2}}, stand_in(0ms, 20ms));
  wait_served(all);
  ASSERT_TRUE(noisy->wait_answers(3));
  const auto answers_in_4_s = [&] {
    for (const auto& one : all) one->take_figures();
    std::this_thread::sleep_for(4s);
    std::vector<double> answered;
    for (const auto& one : all) answered.push_back(static_cast<double>(one->take_figures().answered));
    return answered;
  };
  const std::vector<double> before = answers_in_4_s();
  noisy->set_rate(500);
  const std::vector<double> beside_a_flood = answers_in_4_s();
  for (std::size_t i = 0; i < before.size(); ++i) {
    EXPECT_GE(before[i], test_support::checks_time() ? 35 : 1) << i;
    const double least = test_support::checks_time() ? 0.95 : 0.5;  // one answer more or less at the ends
    EXPECT_GE(beside_a_flood[i], least * before[i] - 1) << i;
  }
  EXPECT_GT(metric(noisy->status(), "frames_dropped"), 1000);
}

TEST(Fleet, broken_jpegs_are_counted_and_cost_the_others_nothing) {
  Robots all = robots(2, 30);
  const auto broken = robot({"broken", 9, 30, {}, true});
  Box box({}, stand_in(2ms));
  wait_served(all);
  EXPECT_TRUE(eventually([&] { return metric(broken->status(), "frames_broken") >= 30; }));
  EXPECT_EQ(broken->figures().answered, 0u);
  for (const auto& one : all) {
    const RobotDouble::Figures figures = one->take_figures();
    EXPECT_EQ(figures.wrong, 0u);
    if (test_support::checks_time()) {
      EXPECT_GE(static_cast<double>(figures.answered), 0.95 * static_cast<double>(figures.sent) - 1);
    }
  }
}

TEST(Fleet, an_image_of_enormous_size_is_not_decoded) {
  const auto anna = robot({"anna", 1});
  const auto bus = bus::connect(loopback());
  auto huge = bus->of_robot("huge")->writer(bus::topics::kColorJpeg);
  Box box({}, stand_in(1ms));
  ASSERT_TRUE(anna->wait_answers(3));
  anna->take_figures();
  ASSERT_TRUE(eventually([&] { return huge.matched() == 1; }));
  std::vector<std::uint8_t> jpeg;  // takes a third of a second to decode
  cv::imencode(".jpg", cv::Mat(7000, 7000, CV_8UC3, cv::Scalar::all(90)), jpeg);
  for (int i = 1; i <= 30; ++i) {
    huge.write({{msg::to_time(i), "camera"}, "jpeg", jpeg});
    std::this_thread::sleep_for(10ms);
  }
  EXPECT_TRUE(anna->wait_answers(30));
  EXPECT_LE(anna->figures().longest_gap_ms, test_support::checks_time() ? 200 : 2000);
}

TEST(Fleet, finds_robots_that_join_late_and_drops_those_that_leave) {
  const BoxWatcher watcher;
  Robots all = robots(1, 30);
  auto dying = robot({"dying", 9});
  Box box({}, stand_in(2ms));
  wait_served(all);
  ASSERT_TRUE(dying->wait_answers(3));
  all[0]->take_figures();
  dying.reset();
  const auto late = robot({"late", 10});
  EXPECT_TRUE(late->wait_answers(30, 4s));
  EXPECT_TRUE(watcher.wait_message("dying is not there"));
  dying = robot({"dying", 9});
  EXPECT_TRUE(dying->wait_answers(30, 4s));
  EXPECT_TRUE(watcher.wait_message("serves dying; serves late; serves r0"));
  EXPECT_EQ(all[0]->figures().wrong + late->figures().wrong + dying->figures().wrong, 0u);
  if (test_support::checks_time()) {
    EXPECT_LE(all[0]->figures().longest_gap_ms, 200);
  }
}

TEST(Fleet, serves_only_the_robots_on_its_list) {
  const auto anna = robot({"anna", 1}), ben = robot({"ben", 2}), nameless = robot({"", 3});
  Box box({.robots = {"anna", "carl"}}, stand_in(1ms));
  const BoxWatcher watcher;
  EXPECT_TRUE(anna->wait_answers(30));
  EXPECT_TRUE(watcher.wait_message("carl is not there"));
  // The readers of a test before this one may still be on their way out.
  EXPECT_TRUE(eventually([&] { return ben->readers() == 0; }));
  EXPECT_TRUE(eventually([&] { return nameless->readers() == 0; }));
}

TEST(Fleet, a_robot_beyond_the_limit_is_served_once_another_has_left) {
  auto anna = robot({"anna", 1});
  FleetConfig config;
  config.most_robots = 1;
  Box box(config, stand_in(1ms));
  ASSERT_TRUE(anna->wait_answers(3));
  const auto ben = robot({"ben", 2});
  EXPECT_TRUE(anna->wait_answers(anna->figures().answered + 60));
  EXPECT_EQ(ben->readers(), 0);
  anna.reset();
  EXPECT_TRUE(ben->wait_answers(30));
  EXPECT_EQ(ben->figures().wrong, 0u);
}

TEST(Fleet, an_engine_that_fails_for_once_costs_that_batch_only) {
  const auto anna = robot({"anna", 1});
  auto calls = std::make_shared<std::atomic<int>>(0);
  Box box({}, {[calls](std::span<const cv::Mat> images) {
                 if (++*calls == 5) throw std::runtime_error("out of memory");
                 return test_support::read_all_marks(images);
               },
               kStandsIn});
  EXPECT_TRUE(anna->wait_answers(30));
  EXPECT_TRUE(eventually([&] { return metric(anna->status(), "frames_broken") == 1; }));
}

TEST(Fleet, an_engine_that_fails_every_time_ends_the_box) {
  const auto anna = robot({"anna", 1});
  Box box({}, {[](std::span<const cv::Mat>) -> std::vector<std::vector<vision::Detection>> {
                 throw std::runtime_error("the GPU has fallen off the bus");
               },
               kStandsIn});
  EXPECT_EQ(box.wait_end(), service::kRunFailed);
  EXPECT_EQ(anna->figures().answered, 0u);
}

TEST(Fleet, the_younger_box_stands_by_and_takes_over_when_the_first_stops) {
  const BoxWatcher watcher;
  const Robots all = robots(2, 30);
  Box first({}, stand_in(1ms));
  wait_served(all);
  Box second({}, stand_in(1ms));
  char host[256] = {};
  gethostname(host, sizeof host - 1);
  EXPECT_TRUE(watcher.wait_message("standby for r1: " + std::string(host) + " (pid " + std::to_string(getpid()) + ")"));
  for (const auto& one : all) {
    EXPECT_EQ(one->readers(), 1) << "the standby must not read images";
    one->take_figures();
  }
  first.stop();
  for (const auto& one : all) EXPECT_TRUE(one->wait_answers(60));
  for (const auto& one : all) {
    const RobotDouble::Figures figures = one->figures();
    EXPECT_EQ(figures.wrong, 0u);
    EXPECT_LE(figures.longest_gap_ms, 2000);
  }
}

TEST(Fleet, the_standby_takes_over_when_the_network_of_the_first_hangs) {
  const BoxWatcher watcher;
  const auto anna = robot({"anna", 1});
  auto hangs = std::make_shared<std::atomic<bool>>(false);
  FleetConfig config;
  config.stuck_after = 400ms;
  Box first(config, {[hangs](std::span<const cv::Mat> images) {
                       while (*hangs) std::this_thread::sleep_for(5ms);
                       return test_support::read_all_marks(images);
                     },
                     kStandsIn});
  ASSERT_TRUE(anna->wait_answers(3));
  Box second({}, stand_in(1ms));
  ASSERT_TRUE(watcher.wait_message("standby for anna"));
  anna->take_figures();
  *hangs = true;
  std::this_thread::sleep_for(100ms);
  const std::uint64_t answered = anna->figures().answered;
  EXPECT_TRUE(anna->wait_answers(answered + 30, 5s));
  *hangs = false;  // it comes back while the second one serves
  EXPECT_TRUE(eventually([&] { return anna->readers() == 1; }));
  anna->take_figures();
  EXPECT_TRUE(anna->wait_answers(30));
  EXPECT_EQ(anna->figures().wrong, 0u);
}

}  // namespace
}  // namespace rtd::detector
