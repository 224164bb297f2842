// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// rtd link as people use it: a camera in the robot's domain, a detector in that of the fleet.
#include <gmock/gmock.h>

#include "common/bus/bus_factory.hpp"
#include "common/bus/topics.hpp"
#include "common/service/runtime.hpp"
#include "tests/component/launcher/rtd_command.hpp"
#include "tests/support/inbox.hpp"

namespace rtd::link {
namespace {

using launcher::RtdCommand;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr std::uint32_t kRobotDomain = 78, kFleetDomain = 79;

std::vector<std::string> link_arguments(const std::string& robot, int fleet,
                                        const std::vector<std::string>& more = {}) {
  std::vector<std::string> all = {"link", "--domain", std::to_string(kRobotDomain), "--fleet", std::to_string(fleet)};
  if (!robot.empty()) all.insert(all.end(), {"--robot", robot});
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

std::shared_ptr<bus::Bus> join(std::uint32_t domain, const bus::SecurityOptions& security = {}) {
  bus::BusOptions options;
  options.domain = domain;
  options.robot = "anna";
  options.security = security;
  return bus::connect(options);
}

TEST(LinkProcess, brings_images_to_a_detector_and_its_boxes_back) {
  const auto robot = join(kRobotDomain), fleet = join(kFleetDomain);
  const test_support::Inbox<msg::CompressedImage> images;
  const test_support::Inbox<msg::Detection2DArray> boxes;
  const auto box_reader =
      robot->reader<msg::Detection2DArray>(bus::topics::kDetections, [&](const auto& m) { boxes.take(m); });
  service::StopToken stop;
  service::Heartbeat detector(*fleet, "detector", stop), filter(*robot, "filter", stop);
  auto box_writer = fleet->writer(bus::topics::kDetections);

  RtdCommand link, camera;
  link.start(link_arguments("anna", kFleetDomain));
  camera.start({"camera", "--source", "synthetic:office?frames=0", "--robot", "anna", "--domain",
                std::to_string(kRobotDomain), "--wait-for", "none"});
  const auto image_reader =
      fleet->reader<msg::CompressedImage>(bus::topics::kColorJpeg, [&](const auto& m) { images.take(m); });
  EXPECT_TRUE(images.wait_count(30)) << link.output() << camera.output();
  EXPECT_EQ(images.at(0)->header.frame_id, "anna/camera_color_optical_frame");

  ASSERT_TRUE(link.wait_for("topic=rt/anna/detector/detections direction=to_robot")) << link.output();
  for (int i = 0; i < 100 && boxes.all().empty(); ++i) {
    box_writer.write({{images.at(0)->header.stamp, ""}, {}});
    link.wait_for("never printed", std::chrono::milliseconds(50));
  }
  ASSERT_FALSE(boxes.all().empty());
  EXPECT_EQ(boxes.at(0)->header.stamp.sec, images.at(0)->header.stamp.sec);
  for (int i = 0; i < 100 && !filter.alive("detector"); ++i)
    link.wait_for("never printed", std::chrono::milliseconds(50));
  EXPECT_TRUE(filter.alive("detector")) << "the robot knows that it is served";
  EXPECT_TRUE(filter.alive("link"));

  camera.interrupt();
  link.interrupt();
  EXPECT_EQ(link.wait(), 0) << link.output();
  camera.wait();
}

TEST(LinkProcess, passes_both_ways_between_secured_domains_and_nothing_to_programs_without_keys) {
  const launcher::ScratchFolder scratch;
  const std::string keystore = scratch / "keystore";
  RtdCommand create, link, camera;
  ASSERT_EQ(create.run({"keystore", "create", keystore, "--robot", "anna"}), 0) << create.output();
  const auto robot = join(kRobotDomain, {keystore, "/rtd/anna/filter"});
  const auto fleet = join(kFleetDomain, {keystore, "/rtd/detector"}), without_keys = join(kFleetDomain);
  const test_support::Inbox<msg::CompressedImage> images, stolen;
  const test_support::Inbox<msg::Detection2DArray> boxes;
  const auto image_reader =
      fleet->reader<msg::CompressedImage>(bus::topics::kColorJpeg, [&](const auto& m) { images.take(m); });
  const auto thief =
      without_keys->reader<msg::CompressedImage>(bus::topics::kColorJpeg, [&](const auto& m) { stolen.take(m); });
  const auto box_reader =
      robot->reader<msg::Detection2DArray>(bus::topics::kDetections, [&](const auto& m) { boxes.take(m); });
  auto box_writer = fleet->writer(bus::topics::kDetections);

  link.start(link_arguments("anna", kFleetDomain, {"--secure", "--keystore", keystore}));
  camera.start({"camera", "--source", "synthetic:office?frames=0", "--robot", "anna", "--domain",
                std::to_string(kRobotDomain), "--wait-for", "none", "--secure", "--keystore", keystore});
  EXPECT_TRUE(images.wait_count(10)) << link.output() << camera.output();
  for (int i = 0; i < 200 && boxes.all().empty(); ++i) {
    box_writer.write({});
    link.wait_for("never printed", std::chrono::milliseconds(50));
  }
  EXPECT_FALSE(boxes.all().empty()) << link.output();
  EXPECT_TRUE(stolen.all().empty());
  camera.interrupt();
  link.interrupt();
  EXPECT_EQ(link.wait(), 0) << link.output();
  camera.wait();
}

TEST(LinkProcess, a_second_link_of_one_robot_is_refused) {
  RtdCommand first, second;
  first.start(link_arguments("anna", kFleetDomain));
  ASSERT_TRUE(first.wait_for("event=linked")) << first.output();
  EXPECT_EQ(second.run({"link", "--robot", "anna", "--domain", "77", "--fleet", std::to_string(kFleetDomain)}), 4)
      << "of another robot with the name";
  EXPECT_THAT(second.output(), HasSubstr("robot 'anna' already has a link"));
  first.interrupt();
  EXPECT_EQ(first.wait(), 0) << first.output();
}

TEST(LinkProcess, says_what_is_missing_or_wrong) {
  const auto refusal = [](const std::vector<std::string>& arguments) {
    RtdCommand rtd;
    EXPECT_EQ(rtd.run(arguments), 2);
    return rtd.output();
  };
  EXPECT_THAT(refusal(link_arguments("", kFleetDomain)), HasSubstr("--robot NAME"));
  EXPECT_THAT(refusal(link_arguments("anna", kRobotDomain)), HasSubstr("the robot is in domain 78 itself"));
  EXPECT_THAT(refusal({"link", "--robot", "anna"}), HasSubstr("--fleet DOMAIN"));
  EXPECT_THAT(refusal(link_arguments("anna", kFleetDomain, {"--topics", "rtd/frame"})),
              HasSubstr("never leave their host"));
  EXPECT_THAT(refusal(link_arguments("anna", kFleetDomain, {"--fleet-profile", "moon"})),
              AllOf(HasSubstr("moon"), HasSubstr("no such profile")));
}

}  // namespace
}  // namespace rtd::link
