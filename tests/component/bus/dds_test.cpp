// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// Two connections within one process, with every vendor.
#include <gtest/gtest.h>

#include <chrono>

#include "common/bus/bus_factory.hpp"
#include "tests/component/bus/collector.hpp"
#include "tests/component/bus/peer_process.hpp"

namespace rtd::bus {
namespace {

using namespace std::chrono_literals;

class DdsBus : public ::testing::TestWithParam<std::string> {
 protected:
  std::shared_ptr<Bus> here = connect_to(GetParam()), there = connect_to(GetParam());
};

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
  wait_matched(right_writer);
  StatusCallbacks callbacks;
  callbacks.on_type_mismatch = [&](const std::string& type) { types.push(std::make_shared<std::string>(type)); };
  const auto writer = here->writer(topics::kOdometry, callbacks);
  EXPECT_EQ(*types.next(), "geometry_msgs::msg::dds_::PoseStamped_");
}

TEST_P(DdsBus, reports_a_missing_heartbeat) {
  Collector<int> missed;
  StatusCallbacks callbacks;
  callbacks.on_deadline_missed = [&] { missed.push(std::make_shared<int>(1)); };
  Collector<msg::ServiceStatus> status;
  const auto reader = there->reader(topics::kStatus, status.callback(), callbacks);
  auto writer = here->writer(topics::kStatus);
  wait_matched(writer);
  writer.write(msg::ServiceStatus{.service = "camera"});
  status.next();
  EXPECT_EQ(*missed.next(3s), 1);
}

TEST_P(DdsBus, refuses_one_topic_with_two_types) {
  const auto reader = here->reader<msg::Odometry>(topics::kOdometry, [](auto) {});
  const Topic<msg::PoseStamped> same_name{topics::kOdometry.name, QosProfile::kPose};
  EXPECT_THROW(here->writer(same_name), BusError);
}

INSTANTIATE_TEST_SUITE_P(Vendors, DdsBus, ::testing::ValuesIn(dds_vendors()), test_name);

}  // namespace
}  // namespace rtd::bus
