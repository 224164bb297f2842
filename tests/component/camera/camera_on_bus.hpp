// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gmock/gmock.h>
#include <unistd.h>

#include <algorithm>
#include <future>
#include <memory>
#include <string>
#include <vector>

#include "common/bus/bus_factory.hpp"
#include "services/camera/camera_service.hpp"
#include "tests/support/inbox.hpp"
#include "tests/support/test_domain.hpp"

namespace rtd::camera::test {

/// rtd-camera on a bus of its own, vendor by vendor, with what it publishes.
class CameraOnBus : public ::testing::TestWithParam<std::string> {
 protected:
  explicit CameraOnBus(const std::string& source) {
    static std::uint32_t tests = 0;
    options_.vendor = GetParam();
    options_.domain = test_domain() + tests++ % 2;  // not that of the test before
    bus_ = bus::connect(options_);
    frames_reader_ = bus_->reader<msg::RgbdFrame>(bus::topics::kFrame, [this](auto frame) { frames_.take(frame); });
    statuses_reader_ = bus_->reader<msg::ServiceStatus>(bus::topics::kStatus, [this](auto status) {
      if (status->service == "camera") statuses_.take(status);
    });
    config_.source = source;
    config_.wait_for = {};
  }
  service::ExitCode run() {
    service::Heartbeat heartbeat(*bus_, "camera", stop_);
    service::Runtime runtime{*bus_, heartbeat, stop_, service::Pace::kRealtime, options_};
    return CameraService(config_, runtime).run();
  }
  std::future<service::ExitCode> start() {
    return std::async(std::launch::async, [this] { return run(); });
  }
  bool said(msg::ServiceState state, const std::string& text) {
    return statuses_.wait([&](const auto& all) {
      return std::any_of(all.begin(), all.end(), [&](const auto& status) {
        return status->state == state && status->message.find(text) != std::string::npos;
      });
    });
  }
  bool frames_come(std::size_t more = 5) {
    const std::size_t before = frames_.all().size();
    return frames_.wait([&](const auto& all) { return all.size() >= before + more; });
  }

  bus::BusOptions options_;
  std::shared_ptr<bus::Bus> bus_;
  service::StopToken stop_;
  ServiceConfig config_;
  test_support::Inbox<msg::RgbdFrame> frames_;
  test_support::Inbox<msg::ServiceStatus> statuses_;
  bus::Reader<msg::RgbdFrame> frames_reader_;
  bus::Reader<msg::ServiceStatus> statuses_reader_;
};

}  // namespace rtd::camera::test
