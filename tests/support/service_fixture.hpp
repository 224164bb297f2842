// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <future>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/bus_factory.hpp"
#include "common/service/exit_code.hpp"
#include "common/service/runtime.hpp"
#include "tests/support/inbox.hpp"
#include "tests/support/inprocess/inprocess_bus.hpp"
#include "tests/support/temporary_folder.hpp"

namespace rtd::test_support {

/// One service that runs in a thread on an in-process bus of its own, watched through its heartbeat. A test sets
/// config_, calls start() and plays the other services; what it sends and receives through bus_ ends with the test.
template <class Service>
class ServiceFixture : public ::testing::Test {
 protected:
  ServiceFixture() : bus_options_(next_domain()), bus_(bus::connect(bus_options_)) {
    statuses_reader_ = bus_->template reader<msg::ServiceStatus>(
        bus::topics::kStatus, [this](std::shared_ptr<const msg::ServiceStatus> status) {
          if (status->service == Service::kName) states_.take(std::move(status));
        });
  }
  void TearDown() override {
    EXPECT_EQ(stop(), service::kOk);
    stop_receiving();
  }

  /// Returns at once.
  void launch(service::Pace pace) {
    running_ = std::async(std::launch::async, [this, pace] {
      service::Heartbeat heartbeat(*bus_, Service::kName, stop_);
      service::Runtime runtime{*bus_, heartbeat, stop_, pace, bus_options_};
      return Service(config_, runtime).run();
    });
  }
  /// Returns once the service is ready.
  void start(service::Pace pace) {
    launch(pace);
    ASSERT_TRUE(wait_state(msg::ServiceState::kReady)) << "not ready: " << Service::kName;
  }
  /// Its exit code when it ends by itself.
  service::ExitCode running_code() { return running_.get(); }
  /// Its exit code; kOk when it does not run (any more).
  service::ExitCode stop() {
    stop_.request_stop();
    return running_.valid() ? running_.get() : service::kOk;
  }

  bool wait_state(msg::ServiceState state, const std::string& text = {}) {
    return states_.wait([&](const auto& all) {
      return !all.empty() && all.back()->state == state && all.back()->message.find(text) != std::string::npos;
    });
  }
  bool wait_metric(const std::string& name, double value) {
    return states_.wait([&](const auto& all) { return !all.empty() && metric(*all.back(), name) == value; });
  }
  static std::optional<double> metric(const msg::ServiceStatus& status, const std::string& name) {
    const auto found = std::find_if(status.metrics.begin(), status.metrics.end(),
                                    [&](const msg::Metric& metric) { return metric.name == name; });
    return found == status.metrics.end() ? std::nullopt : std::optional(found->value);
  }

  /// A heartbeat of another service.
  void say(const std::string& service, msg::ServiceState state, std::vector<msg::Metric> metrics = {}) {
    msg::ServiceStatus status;
    status.metrics = std::move(metrics);
    status.service = service;
    status.pid = 1;
    status.state = state;
    status_writer(service).write(status);
  }
  /// Listens until the end of the test.
  template <class T>
  void receive(const bus::Topic<T>& topic, const Inbox<T>& inbox) {
    readers_.push_back(std::make_shared<bus::Reader<T>>(bus_->template reader<T>(
        topic, [inbox](std::shared_ptr<const T> message) { inbox.take(std::move(message)); })));
  }
  /// But for the heartbeat.
  void stop_receiving() { readers_.clear(); }

  typename Service::Config config_;
  const test::TemporaryFolder scratch_;
  const std::filesystem::path folder_ = scratch_ / "out";  ///< not there yet
  service::StopToken stop_;
  const bus::BusOptions bus_options_;
  const std::shared_ptr<bus::Bus> bus_;
  Inbox<msg::ServiceStatus> states_;  ///< heartbeats of the service

 private:
  static bus::BusOptions next_domain() {
    static std::uint32_t domain = 100;  // one per test: nothing arrives from the test before
    bus::BusOptions options;
    options.vendor = bus::inprocess::vendor();
    options.domain = domain++;
    return options;
  }

  /// Each service has one of its own.
  bus::Writer<msg::ServiceStatus>& status_writer(const std::string& service) {
    const std::lock_guard lock(writers_mutex_);
    bus::Writer<msg::ServiceStatus>& writer = statuses_writers_[service];
    if (!writer) writer = bus_->writer(bus::topics::kStatus);
    return writer;
  }

  std::mutex writers_mutex_;
  std::map<std::string, bus::Writer<msg::ServiceStatus>> statuses_writers_;
  bus::Reader<msg::ServiceStatus> statuses_reader_;
  std::vector<std::shared_ptr<void>> readers_;
  std::future<service::ExitCode> running_;
};

}  // namespace rtd::test_support
