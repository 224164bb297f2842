// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// How much of a robot another participant discovers: all of it in the robot's own domain, the link in that of the
// fleet.

#include <gtest/gtest.h>

#include <mutex>
#include <set>

#include "common/bus/bus_factory.hpp"
#include "common/bus/cyclonedds/participant.hpp"
#include "common/bus/topics.hpp"
#include "tests/component/launcher/rtd_command.hpp"

namespace rtd::link {
namespace {

using launcher::RtdCommand;
using launcher::ScratchFolder;

/// The endpoints of other processes in a domain, of any vendor.
class Endpoints {
 public:
  explicit Endpoints(std::uint32_t domain)
      : participant_(options(domain)),
        writers_(participant_.handle(), Direction::kWriters, note()),
        readers_(participant_.handle(), Direction::kReaders, note()) {}

  std::size_t count() const {
    const std::lock_guard lock(mutex_);
    return there_.size();
  }

 private:
  using Direction = bus::cyclonedds::EndpointWatch::Direction;
  static bus::BusOptions options(std::uint32_t domain) {
    bus::BusOptions options;
    options.vendor = "cyclonedds";
    options.domain = domain;
    return options;
  }
  bus::cyclonedds::EndpointWatch::Note note() {
    return [this](const bus::WriterId& id, const dds_builtintopic_endpoint_t* endpoint) {
      const std::lock_guard lock(mutex_);
      if (endpoint == nullptr) {
        there_.erase(id);
      } else if (!participant_.is_own(id)) {
        there_.insert(id);
      }
    };
  }

  mutable std::mutex mutex_;
  std::set<bus::WriterId> there_;
  bus::cyclonedds::Participant participant_;
  bus::cyclonedds::EndpointWatch writers_, readers_;
};

TEST(Discovery, of_a_robot_behind_a_link_is_ten_endpoints_at_most) {
  constexpr int kRobot = 140, kFleet = 141;
  const ScratchFolder scratch;
  const Endpoints in_robot(kRobot), in_fleet(kFleet);
  bus::BusOptions box;  // the GPU box: reads the images, answers with boxes
  box.domain = kFleet;
  box.robot = "anna";
  const auto fleet = bus::connect(box);
  const auto images = fleet->reader<msg::CompressedImage>(bus::topics::kColorJpeg, [](const auto&) {});
  const auto boxes = fleet->writer(bus::topics::kDetections);
  const std::size_t of_the_box = 2;

  RtdCommand run, link;
  run.start({"run", "--source", "synthetic:office?frames=0", "--robot", "anna", "--domain", std::to_string(kRobot),
             "--detector", "off", "--out", scratch / "out"});
  link.start({"link", "--robot", "anna", "--domain", std::to_string(kRobot), "--fleet", std::to_string(kFleet)});
  ASSERT_TRUE(run.wait_for("inliers")) << run.output();
  for (int i = 0; i < 200 && images.matched() == 0; ++i) run.wait_for("never printed", std::chrono::milliseconds(50));
  ASSERT_GT(images.matched(), 0) << link.output();
  run.wait_for("never printed", std::chrono::seconds(1));

  const std::size_t whole = in_robot.count(), linked = in_fleet.count() - of_the_box;
  std::cout << "endpoints of a robot: " << whole << " in its own domain, " << linked << " in that of the fleet\n";
  RecordProperty("endpoints_of_a_robot", static_cast<int>(whole));
  RecordProperty("endpoints_in_the_fleet", static_cast<int>(linked));
  EXPECT_LE(linked, 10U);
  EXPECT_GE(linked, 7U) << "poses, images and heartbeats";
  EXPECT_GT(whole, 30U);
  link.interrupt();
  run.interrupt();
  EXPECT_EQ(link.wait(), 0) << link.output();
  run.wait();
}

}  // namespace
}  // namespace rtd::link
