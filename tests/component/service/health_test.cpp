// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// Dead and hung peers, a stuck worker and refused endpoints as others see them on rtd/status.
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "common/bus/bus_factory.hpp"
#include "common/bus/vendors.hpp"
#include "common/service/metric_names.hpp"
#include "common/service/runtime.hpp"
#include "common/service/topic_source.hpp"
#include "tests/support/inprocess/inprocess_bus.hpp"
#include "tests/support/test_domain.hpp"

extern char** environ;

namespace rtd::service {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

/// Seconds until the condition holds; 15 when it did not.
template <class Condition>
double seconds_until(Condition condition) {
  const auto begin = Clock::now();
  while (!condition() && Clock::now() - begin < 15s) std::this_thread::sleep_for(5ms);
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

class Health : public ::testing::TestWithParam<std::string> {
 protected:
  static std::uint32_t domain() { return test_domain(); }
  std::shared_ptr<bus::Bus> join() const {
    bus::BusOptions options;
    options.vendor = GetParam();
    options.domain = domain();
    return bus::connect(options);
  }

  /// The newest status of a service as another service receives it.
  std::optional<msg::ServiceStatus> newest_status(const std::string& service) {
    const std::lock_guard lock(mutex_);
    const auto found = newest_.find(service);
    return found == newest_.end() ? std::nullopt : std::optional(found->second);
  }
  bool reports(const std::string& service, const std::string& metric) {
    const auto status = newest_status(service);
    if (!status) return false;
    for (const auto& entry : status->metrics) {
      if (entry.name == metric) return true;
    }
    return false;
  }
  std::mutex mutex_;
  std::map<std::string, msg::ServiceStatus> newest_;
  std::shared_ptr<bus::Bus> here_ = join(), listener_ = join();
  bus::Reader<msg::ServiceStatus> statuses_ =
      listener_->reader<msg::ServiceStatus>(bus::topics::kStatus, [this](const auto& status) {
        const std::lock_guard lock(mutex_);
        newest_[status->service] = *status;
      });
  StopToken stop_;
};

/// A service of its own process.
class PeerService {
 public:
  PeerService(std::string vendor, std::uint32_t domain) {
    std::string path = HEARTBEAT_PEER_PATH, number = std::to_string(domain);
    char* argv[] = {path.data(), vendor.data(), number.data(), nullptr};
    if (posix_spawn(&pid_, path.c_str(), nullptr, nullptr, argv, environ) != 0) throw std::runtime_error(path);
  }
  ~PeerService() { end(); }
  PeerService(const PeerService&) = delete;
  PeerService& operator=(const PeerService&) = delete;
  void signal(int number) const { kill(pid_, number); }
  void end() {
    if (pid_ > 0) {
      kill(pid_, SIGKILL);
      waitpid(pid_, nullptr, 0);
    }
    pid_ = 0;
  }

 private:
  pid_t pid_ = 0;
};

/// A busy host may be slower than the 0.5 s and 2 s that are asked; the measured times are printed.
constexpr double kPatienceS = 5;

TEST_P(Health, a_killed_peer_is_named_dead_and_its_successor_takes_that_back) {
  Heartbeat filter(*here_, "filter", stop_);
  PeerService peer(GetParam(), domain());
  ASSERT_LT(seconds_until([&] { return filter.alive("detector"); }), 15);

  peer.end();
  const double dead_s = seconds_until([&] { return reports("filter", "peer.detector.dead"); });
  std::printf("%s: killed peer named after %.2f s\n", GetParam().c_str(), dead_s);
  EXPECT_LT(dead_s, kPatienceS);
  EXPECT_FALSE(filter.alive("detector"));

  const PeerService successor(GetParam(), domain());
  EXPECT_LT(seconds_until([&] { return filter.alive("detector") && !reports("filter", "peer.detector.dead"); }), 15);
}

TEST_P(Health, a_stopped_peer_is_named_hung_until_it_continues) {
  Heartbeat filter(*here_, "filter", stop_);
  const PeerService peer(GetParam(), domain());
  ASSERT_LT(seconds_until([&] { return filter.alive("detector"); }), 15);

  peer.signal(SIGSTOP);
  const double hung_s = seconds_until([&] { return reports("filter", "peer.detector.hung"); });
  std::printf("%s: stopped peer named after %.2f s\n", GetParam().c_str(), hung_s);
  EXPECT_LT(hung_s, kPatienceS);

  peer.signal(SIGCONT);
  EXPECT_LT(seconds_until([&] { return filter.alive("detector") && !reports("filter", "peer.detector.hung"); }), 15);
}

TEST_P(Health, a_stuck_worker_is_reported_by_its_own_heartbeat) {
  Heartbeat slam(*here_, "slam", stop_);
  slam.set_state(msg::ServiceState::kRunning);
  slam.watch_progress(1500ms);
  slam.tick();  // and no more
  const double hung_s = seconds_until([&] { return reports("slam", "hung"); });
  std::printf("%s: stuck worker reported after %.2f s\n", GetParam().c_str(), hung_s);
  EXPECT_LT(hung_s, kPatienceS);
  EXPECT_EQ(newest_status("slam")->state, msg::ServiceState::kDegraded);

  slam.tick();
  EXPECT_LT(seconds_until([&] { return newest_status("slam")->state == msg::ServiceState::kRunning; }), 15);
}

/// A bus whose readers of one topic can be cut off from it.
class CuttableBackend : public bus::BusBackend {
 public:
  CuttableBackend(std::shared_ptr<bus::BusBackend> backend, std::string topic)
      : BusBackend(backend->vendor()), backend_(std::move(backend)), topic_(std::move(topic)) {}
  std::unique_ptr<bus::WriterBackend> create_writer(bus::MessageId id, const std::string& topic,
                                                    bus::QosProfile profile, bus::StatusCallbacks callbacks) override {
    return backend_->create_writer(id, topic, profile, std::move(callbacks));
  }
  std::unique_ptr<bus::ReaderBackend> create_reader(bus::MessageId id, const std::string& topic,
                                                    bus::QosProfile profile, bus::ErasedCallback on_message,
                                                    bus::StatusCallbacks callbacks) override {
    if (topic == topic_) {
      callbacks.accepts = [cut = cut_, next = callbacks.accepts](const bus::WriterId& writer) {
        return !*cut && (!next || next(writer));
      };
    }
    return backend_->create_reader(id, topic, profile, std::move(on_message), std::move(callbacks));
  }
  std::unique_ptr<bus::CallEndpoint> create_calls(const bus::CallTopics& topics, bus::CallRole role,
                                                  bus::OnCall on_call) override {
    return backend_->create_calls(topics, role, std::move(on_call));
  }
  void cut(bool off) { *cut_ = off; }

 private:
  const std::shared_ptr<bus::BusBackend> backend_;
  const std::string topic_;
  const std::shared_ptr<std::atomic<bool>> cut_ = std::make_shared<std::atomic<bool>>(false);
};

TEST(Input, a_service_that_is_cut_off_from_an_input_counts_as_stuck_until_it_receives_again) {
  const auto backend = std::make_shared<CuttableBackend>(bus::inprocess::create_backend({}), "rtd/features");
  bus::Bus bus(backend), other(bus::inprocess::create_backend({}));
  StopToken stop;
  Heartbeat slam(bus, "slam", stop), filter(other, "filter", stop);
  std::mutex mutex;
  std::string message;
  filter.on_status([&](const msg::ServiceStatus& status) {
    const std::lock_guard lock(mutex);
    message = status.message;
  });
  const auto gate = follow_source("filter", slam.process_gone());
  const auto features = bus.reader(
      bus::topics::kFeatures, [](const auto&) {}, gate->callbacks());
  auto writer = other.writer(bus::topics::kFeatures);
  const auto frame = std::make_unique<msg::FeatureFrame>();
  const auto seconds_of_frames_until = [&](Heartbeat::Work work) {
    return seconds_until([&] {
      writer.write(*frame);
      return slam.work() == work;
    });
  };
  slam.tick();
  for (const auto begin = Clock::now(); Clock::now() - begin < 2500ms; std::this_thread::sleep_for(10ms)) {
    writer.write(*frame);
    ASSERT_EQ(slam.work(), Heartbeat::Work::kContinues);
  }

  backend->cut(true);
  const double lost_s = seconds_of_frames_until(Heartbeat::Work::kStuck);
  std::printf("lost input reported after %.2f s\n", lost_s);
  EXPECT_GT(lost_s, 1.4);
  EXPECT_LT(lost_s, kPatienceS);
  EXPECT_LT(seconds_until([&] {
              const std::lock_guard lock(mutex);
              return message == "hung: nothing arrives on rtd/features, although filter sends";
            }),
            kPatienceS);

  backend->cut(false);
  EXPECT_LT(seconds_of_frames_until(Heartbeat::Work::kContinues), kPatienceS);
}

TEST_P(Health, an_orderly_end_is_not_a_death) {
  Heartbeat filter(*here_, "filter", stop_);
  {
    Heartbeat slam(*listener_, "slam", stop_);
    ASSERT_LT(seconds_until([&] { return filter.alive("slam"); }), 15);
  }
  EXPECT_LT(seconds_until([&] { return !filter.alive("slam"); }), 15);
  std::this_thread::sleep_for(600ms);  // the time in which a death would be reported
  EXPECT_FALSE(reports("filter", "peer.slam.dead"));
}

TEST_P(Health, refused_peers_are_counted_by_topic) {
  Heartbeat filter(*here_, "filter", stop_);
  const auto writer = here_->writer(bus::topics::kFeatures);  // volatile
  const bus::Topic<msg::FeatureFrame> asks_for_more{bus::topics::kFeatures.name, bus::QosProfile::kKeyframes};
  const auto reader = listener_->reader<msg::FeatureFrame>(asks_for_more, [](const auto&) {});
  EXPECT_LT(seconds_until([&] { return reports("filter", "topic.rtd/features.incompatible_qos"); }), kPatienceS);
}

TEST_P(Health, another_type_on_a_topic_is_counted) {
  Heartbeat slam(*here_, "slam", stop_);
  const auto writer = here_->writer(bus::topics::kOdometry);
  const PeerService mistaken(GetParam(), domain());  // reads that topic with another type
  EXPECT_LT(seconds_until([&] { return reports("slam", "topic.rt/slam/odometry.type_mismatch"); }), kPatienceS);
  EXPECT_LT(seconds_until([&] { return reports("detector", "topic.rt/slam/odometry.type_mismatch"); }), kPatienceS);
}

INSTANTIATE_TEST_SUITE_P(Vendors, Health, ::testing::ValuesIn(bus::dds_vendors()),
                         [](const auto& parameter) { return parameter.param; });

}  // namespace
}  // namespace rtd::service
