// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// `rtd topics` in a domain where a program publishes.
#include "services/topics/topics_command.hpp"

#include <gmock/gmock.h>
#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <mutex>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <thread>

#include "common/bus/raw_bus.hpp"
#include "common/bus/topics.hpp"
#include "common/service/exit_code.hpp"
#include "tests/support/test_domain.hpp"

namespace rtd::topics {
namespace {

using namespace std::chrono_literals;
using namespace ::testing;

/// While it lives, an interrupt of this thread waits for the command.
class InterruptWaits {
 public:
  InterruptWaits() {
    sigset_t interrupt;
    sigemptyset(&interrupt);
    sigaddset(&interrupt, SIGINT);
    pthread_sigmask(SIG_BLOCK, &interrupt, &before_);
  }
  ~InterruptWaits() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  InterruptWaits(const InterruptWaits&) = delete;
  InterruptWaits& operator=(const InterruptWaits&) = delete;

 private:
  sigset_t before_{};
};

class Topics : public ::testing::TestWithParam<std::string> {
 protected:
  Topics() {
    static std::uint32_t tests = 0;
    options_.vendor = GetParam();
    options_.domain = test_domain() + tests++ % 2;  // not that of the test before
    choose_domain(options_.domain);
  }
  ~Topics() override {
    ended_ = true;
    if (thread_.joinable()) thread_.join();
  }

  void choose_domain(std::uint32_t domain) {
    request_.bus.given = {{"bus.vendor", "--dds", {options_.vendor}},
                          {"bus.domain", "--domain", {std::to_string(domain)}}};
  }

  /// A pose 50 times a second, until the end of the test, and what is latched.
  void publish() {
    bus_ = bus::connect(options_);
    poses_ = bus_->writer(bus::topics::kPose);
    infos_ = bus_->writer(bus::topics::kCameraInfo);
    msg::CameraInfo info;
    info.distortion_model = "plumb_bob";
    infos_.write(info);
    thread_ = std::thread([this] {
      msg::PoseStamped pose;
      pose.header.frame_id = "map";
      for (; !ended_; ++pose.header.stamp.sec) {
        poses_.write(pose);
        std::this_thread::sleep_for(20ms);
      }
    });
  }
  int run(const std::string& action, const std::vector<std::string>& topics = {}) {
    request_.action = action;
    request_.topics = topics;
    out_.str({});
    err_.str({});
    return run_topics(request_, out_, err_);
  }

  bus::BusOptions options_;
  TopicsRequest request_;
  std::ostringstream out_, err_;

 private:
  std::shared_ptr<bus::Bus> bus_;
  bus::Writer<msg::PoseStamped> poses_;
  bus::Writer<msg::CameraInfo> infos_;
  std::atomic<bool> ended_{false};
  std::thread thread_;
};

TEST_P(Topics, are_listed_with_their_types) {
  publish();
  request_.wait_s = 20;
  ASSERT_EQ(run("list"), service::kOk) << err_.str();
  EXPECT_THAT(out_.str(), AllOf(StartsWith("topic"), HasSubstr("/camera/color/camera_info  sensor_msgs/msg/CameraInfo"),
                                HasSubstr("reliable, latched"), HasSubstr("/slam/pose")));
  request_.json = true;
  ASSERT_EQ(run("list"), service::kOk);
  const auto list = nlohmann::json::parse(out_.str());
  ASSERT_EQ(list.size(), 2U);
  EXPECT_EQ(list[1]["dds_type"], "geometry_msgs::msg::dds_::PoseStamped_");
  EXPECT_THAT(list[1]["writers"][0]["type_hash"].get<std::string>(), StartsWith("RIHS01_10f3786d"));
}

TEST_P(Topics, of_an_empty_domain_are_none_and_the_message_says_where) {
  request_.wait_s = 0.3;
  EXPECT_EQ(run("list"), service::kRunFailed);
  EXPECT_THAT(err_.str(),
              AllOf(HasSubstr("no topic within 0.3"), HasSubstr("DDS domain " + std::to_string(options_.domain)),
                    HasSubstr(options_.vendor), HasSubstr("this host only")));
  EXPECT_EQ(out_.str(), "");
  request_.duration_s = 0.3;
  EXPECT_EQ(run("hz"), service::kRunFailed);
  EXPECT_EQ(run("echo", {"/slam/pose"}), service::kRunFailed);
  EXPECT_THAT(err_.str(), AllOf(HasSubstr("/slam/pose has no publisher"), HasSubstr("nothing is published")));
}

TEST_P(Topics, of_another_domain_are_hinted_at) {
  publish();
  choose_domain(options_.domain == test_domain() ? test_domain() + 1 : test_domain());
  request_.wait_s = 0.3;
  EXPECT_EQ(run("list"), service::kRunFailed);
  EXPECT_THAT(err_.str(),
              ContainsRegex("on this host DDS runs in domain ([0-9]+, )*" + std::to_string(options_.domain) + "[,:]"));
}

TEST_P(Topics, whose_writers_come_one_after_the_other_are_all_listed) {
  constexpr int kWriters = 3;
  const auto bus = bus::connect_raw(options_);
  std::vector<std::unique_ptr<bus::RawWriter>> writers;
  std::thread latecomers([&] {
    for (int i = 0; i < kWriters; ++i) {
      writers.push_back(bus->writer({"rt/late" + std::to_string(i), "other_msgs::msg::dds_::Thing_"}, {}));
      std::this_thread::sleep_for(1300ms);
    }
  });
  request_.wait_s = 30;
  EXPECT_EQ(run("list"), service::kOk) << err_.str();
  latecomers.join();
  for (int i = 0; i < kWriters; ++i) EXPECT_THAT(out_.str(), HasSubstr("/late" + std::to_string(i)));
}

TEST_P(Topics, of_ours_are_passed_on_under_a_name_of_ros2) {
  const InterruptWaits waits;
  const auto bus = bus::connect(options_);
  auto results = bus->writer(bus::topics::kTracking);
  auto features = bus->writer(bus::topics::kFeatures);
  const auto raw = bus::connect_raw(options_);
  std::mutex mutex;
  std::vector<std::byte> received;
  bus::RawHandlers handlers;
  handlers.on_sample = [&](const bus::RawSample& sample) {
    const std::lock_guard lock(mutex);
    received.assign(sample.cdr().begin(), sample.cdr().end());
  };
  const auto ros = raw->reader({"rt/rtd/tracking", "rtd_msgs::msg::dds_::TrackingResult_"}, {}, std::move(handlers));
  std::thread sender([&, command = pthread_self()] {
    msg::TrackingResult result{};
    const auto arrived = [&] {
      const std::lock_guard lock(mutex);
      return !received.empty();
    };
    for (result.seq = 1; result.seq < 2000 && !arrived(); ++result.seq) {
      results.write(result);
      std::this_thread::sleep_for(5ms);
    }
    std::set<std::string> names;
    for (const bus::TopicWriter& writer : raw->writers()) names.insert(writer.topic.name);
    EXPECT_FALSE(names.contains("rt/rtd/features")) << "stays on this host";
    pthread_kill(command, SIGINT);
  });
  EXPECT_EQ(run("mirror"), service::kOk) << err_.str();
  sender.join();
  EXPECT_EQ(received.size(), 4 + sizeof(msg::TrackingResult));
  EXPECT_THAT(out_.str(), HasSubstr("rtd/tracking as /rtd/tracking\n"));
  EXPECT_THAT(out_.str(), Not(HasSubstr("features")));
}

TEST_P(Topics, of_other_programs_are_passed_on_when_they_are_named) {
  const auto raw = bus::connect_raw(options_);
  const std::string type = "other_msgs::msg::dds_::Thing_";
  std::vector<std::unique_ptr<bus::RawWriter>> writers;
  for (const char* name : {"rtd/other1", "rtd/other2", "rtd/map"}) writers.push_back(raw->writer({name, type}, {}));
  const InterruptWaits waits;
  const auto mirrored = [&](const std::string& last, const std::vector<std::string>& named) {
    std::thread watcher([&, command = pthread_self()] {
      const auto is_last = [&](const bus::TopicWriter& writer) { return writer.topic.name == "rt/" + last; };
      while (std::ranges::none_of(raw->writers(), is_last)) std::this_thread::sleep_for(5ms);
      pthread_kill(command, SIGINT);
    });
    EXPECT_EQ(run("mirror", named), service::kOk) << err_.str();
    watcher.join();
    return out_.str();
  };
  EXPECT_EQ(mirrored("rtd/map", {}), "rtd/map as /rtd/map\n");
  EXPECT_EQ(mirrored("rtd/other2", {"/rtd/other2"}), "rtd/other2 as /rtd/other2\n");
}

TEST_P(Topics, have_a_rate) {
  publish();
  request_.duration_s = 30;
  request_.count = 20;
  request_.json = true;
  ASSERT_EQ(run("hz", {"/slam/pose"}), service::kOk) << err_.str();
  const auto report = nlohmann::json::parse(out_.str());
  ASSERT_EQ(report["topics"].size(), 1U);
  EXPECT_GE(report["topics"][0]["messages"], 20);
  EXPECT_GT(report["topics"][0]["rate_hz"], 5.0);
  EXPECT_LT(report["topics"][0]["rate_hz"], 60.0);
  EXPECT_EQ(report["topics"][0]["lost"], 0);
}

TEST_P(Topics, are_printed_field_by_field) {
  publish();
  request_.duration_s = 20;
  request_.once = true;
  ASSERT_EQ(run("echo", {"/camera/color/camera_info"}), service::kOk) << err_.str();
  EXPECT_THAT(out_.str(), AllOf(HasSubstr("distortion_model: \"plumb_bob\"\n"), HasSubstr("k: [9 x 0]\n")));
  request_.once = false;
  request_.count = 2;
  request_.json = true;
  ASSERT_EQ(run("echo", {"rt/slam/pose"}), service::kOk) << err_.str();
  std::istringstream lines(out_.str());
  std::string line;
  std::vector<int> stamps;
  while (std::getline(lines, line)) {
    const auto message = nlohmann::json::parse(line);
    EXPECT_EQ(message["topic"], "/slam/pose");
    stamps.push_back(message["message"]["header"]["stamp"]["sec"]);
  }
  ASSERT_EQ(stamps.size(), 2U);
  EXPECT_EQ(stamps[1], stamps[0] + 1);
}

TEST_P(Topics, of_unknown_types_are_listed_and_measured_but_not_printed) {
  const auto bus = bus::connect_raw(options_);
  const auto writer = bus->writer({"rt/thing", "other_msgs::msg::dds_::Thing_"}, {});
  request_.wait_s = 20;
  request_.duration_s = 20;
  ASSERT_EQ(run("list"), service::kOk) << err_.str();
  EXPECT_THAT(out_.str(), HasSubstr("/thing  other_msgs/msg/Thing        1  reliable  *"));
  EXPECT_EQ(run("echo", {"/thing"}), service::kUsageOrConfig);
  EXPECT_THAT(err_.str(), HasSubstr("other_msgs/msg/Thing, whose fields are not known here"));
}

INSTANTIATE_TEST_SUITE_P(EachVendor, Topics, ::testing::ValuesIn(bus::dds_vendors()),
                         [](const auto& vendor) { return vendor.param; });
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(Topics);

}  // namespace
}  // namespace rtd::topics
