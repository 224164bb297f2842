// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// Two connections within one process, with every vendor.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "common/bus/bus_factory.hpp"
#include "tests/component/bus/collector.hpp"
#include "tests/component/bus/patterns.hpp"
#include "tests/component/bus/peer_process.hpp"

namespace rtd::bus {
namespace {

using namespace std::chrono_literals;

template <class T>
void wait_for_reader(const Writer<T>& writer) {
  for (int i = 0; writer.matched() == 0; ++i) {
    ASSERT_LT(i, 5000) << "no reader matched";
    std::this_thread::sleep_for(1ms);
  }
}

class DdsBus : public ::testing::TestWithParam<std::string> {
 protected:
  std::shared_ptr<Bus> here = connect_to(GetParam()), there = connect_to(GetParam());
};

TEST_P(DdsBus, delivers_every_kind_of_message) {
  Collector<msg::FeatureFrame> features;
  Collector<msg::Odometry> odometry;
  Collector<msg::ServiceStatus> status;
  const auto features_reader = there->reader(topics::kFeatures, features.callback());
  const auto odometry_reader = there->reader(topics::kOdometry, odometry.callback());
  const auto status_reader = there->reader(topics::kStatus, status.callback());
  auto features_writer = here->writer(topics::kFeatures);
  auto odometry_writer = here->writer(topics::kOdometry);
  auto status_writer = here->writer(topics::kStatus);
  wait_for_reader(features_writer);
  wait_for_reader(odometry_writer);
  wait_for_reader(status_writer);

  auto sent = features_writer.loan();
  fill_features(*sent, 5);
  EXPECT_TRUE(features_writer.write(std::move(sent)));
  msg::Odometry pose;
  pose.child_frame_id = "camera";
  EXPECT_TRUE(odometry_writer.write(pose));
  msg::ServiceStatus heartbeat;
  heartbeat.service = "camera";
  heartbeat.metrics = {{"frames_in", 3.0}};
  EXPECT_TRUE(status_writer.write(heartbeat));

  EXPECT_TRUE(equals_pattern(*features.next()));
  EXPECT_EQ(odometry.next()->child_frame_id, "camera");
  EXPECT_EQ(status.next()->metrics.at(0).value, 3.0);
}

/// The same name with another type, as only another program would use it.
constexpr Topic<msg::PoseStamped> kOdometryMistaken{"rt/slam/odometry", QosProfile::kPose};

TEST_P(DdsBus, reports_another_type_on_the_topic_to_both_sides) {
  Collector<std::string> writer_reports, reader_reports;
  StatusCallbacks of_writer, of_reader;
  of_writer.on_type_mismatch = [&](const std::string& type) {
    writer_reports.push(std::make_shared<std::string>(type));
  };
  of_reader.on_type_mismatch = [&](const std::string& type) {
    reader_reports.push(std::make_shared<std::string>(type));
  };
  const auto writer = here->writer(topics::kOdometry, of_writer);
  const auto reader = there->reader(
      kOdometryMistaken, [](const auto&) {}, of_reader);
  EXPECT_EQ(*writer_reports.next(), "geometry_msgs::msg::dds_::PoseStamped_");
  EXPECT_EQ(*reader_reports.next(), "nav_msgs::msg::dds_::Odometry_");
}

TEST_P(DdsBus, reports_another_type_that_was_there_before_a_late_endpoint) {
  const auto reader = there->reader(kOdometryMistaken, [](const auto&) {});
  Collector<std::string> types;
  const auto right_reader = here->reader(topics::kPose, [](const auto&) {});  // meet first
  const auto right_writer = there->writer(topics::kPose);
  wait_for_reader(right_writer);
  StatusCallbacks callbacks;
  callbacks.on_type_mismatch = [&](const std::string& type) { types.push(std::make_shared<std::string>(type)); };
  const auto writer = here->writer(topics::kOdometry, callbacks);
  EXPECT_EQ(*types.next(), "geometry_msgs::msg::dds_::PoseStamped_");
}

TEST_P(DdsBus, takes_an_unwritten_loan_back) {
  auto writer = here->writer(topics::kFrame);
  for (int i = 0; i < 20; ++i) const auto loan = writer.loan();
}

TEST_P(DdsBus, reports_matches_and_their_end_to_both_sides) {
  Collector<int> writer_peers, reader_peers;
  StatusCallbacks of_writer, of_reader;
  of_writer.on_matched = [&](int peers) { writer_peers.push(std::make_shared<int>(peers)); };
  of_reader.on_matched = [&](int peers) { reader_peers.push(std::make_shared<int>(peers)); };
  auto writer = std::make_unique<Writer<msg::Odometry>>(here->writer(topics::kOdometry, of_writer));
  const auto reader = there->reader<msg::Odometry>(
      topics::kOdometry, [](auto) {}, of_reader);
  EXPECT_EQ(*writer_peers.next(), 1);
  EXPECT_EQ(*reader_peers.next(), 1);
  EXPECT_EQ(reader.matched(), 1);

  writer.reset();
  EXPECT_EQ(*reader_peers.next(), 0);
}

TEST_P(DdsBus, names_the_policy_that_keeps_a_pair_apart) {
  Collector<std::string> by_writer, by_reader;
  StatusCallbacks of_writer, of_reader;
  of_writer.on_incompatible_qos = [&](const auto& policy) { by_writer.push(std::make_shared<std::string>(policy)); };
  of_reader.on_incompatible_qos = [&](const auto& policy) { by_reader.push(std::make_shared<std::string>(policy)); };
  const Topic<msg::CameraInfo> volatile_info{topics::kCameraInfo.name, QosProfile::kPose};
  auto writer = here->writer(volatile_info, of_writer);
  const auto reader = there->reader<msg::CameraInfo>(
      topics::kCameraInfo, [](auto) {}, of_reader);

  EXPECT_EQ(*by_reader.next(), "DURABILITY");
  EXPECT_EQ(*by_writer.next(), "DURABILITY");
  EXPECT_EQ(writer.matched(), 0);
}

TEST_P(DdsBus, reports_a_missing_heartbeat) {
  Collector<int> missed;
  StatusCallbacks callbacks;
  callbacks.on_deadline_missed = [&] { missed.push(std::make_shared<int>(1)); };
  Collector<msg::ServiceStatus> status;
  const auto reader = there->reader(topics::kStatus, status.callback(), callbacks);
  auto writer = here->writer(topics::kStatus);
  wait_for_reader(writer);
  writer.write(msg::ServiceStatus{.service = "camera"});
  status.next();
  EXPECT_EQ(*missed.next(3s), 1);
}

TEST_P(DdsBus, no_callback_runs_after_the_reader_is_gone) {
  auto writer = here->writer(topics::kTracking);
  std::atomic<bool> stop{false};
  std::thread sender([&] {
    while (!stop) {
      writer.write(msg::TrackingResult{});
      std::this_thread::sleep_for(100us);
    }
  });
  for (int round = 0; round < 10; ++round) {
    auto received = std::make_unique<std::atomic<int>>(0);  // a late callback would be a use after free
    auto reader = there->reader(topics::kTracking, [&counter = *received](auto) { ++counter; });
    for (int i = 0; i < 5000 && *received < 3; ++i) std::this_thread::sleep_for(1ms);
    EXPECT_GE(*received, 3);
    reader = {};
    received.reset();
  }
  stop = true;
  sender.join();
}

TEST_P(DdsBus, refuses_one_topic_with_two_types) {
  const auto reader = here->reader<msg::Odometry>(topics::kOdometry, [](auto) {});
  const Topic<msg::PoseStamped> same_name{topics::kOdometry.name, QosProfile::kPose};
  EXPECT_THROW(here->writer(same_name), BusError);
}

INSTANTIATE_TEST_SUITE_P(Vendors, DdsBus, ::testing::ValuesIn(dds_vendors()), test_name);

}  // namespace
}  // namespace rtd::bus
