// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// What the command-line tools of ROS 2 find of a running pipeline: nodes, their topics, services, parameters.
#include <gmock/gmock.h>

#include "tests/component/launcher/rtd_command.hpp"
#include "tests/support/eventually.hpp"
#include "tests/support/ros_double.hpp"
#include "tests/support/test_domain.hpp"

namespace rtd::launcher {
namespace {

using rtd::testing::RosDouble;
using namespace ::testing;
namespace type = msg::parameter_type;

/// By vendor.
class Ros2Nodes : public ::testing::TestWithParam<std::string> {
 protected:
  Ros2Nodes() {
    options_.vendor = GetParam();
    options_.domain = test_domain();
    options_.participant_name = "ros2cli";
    rtd_.start({"run", "--source", "synthetic:office?frames=5000", "--pace", "realtime", "--detector", "off", "--out",
                scratch_ / "out", "--dds", GetParam(), "--domain", std::to_string(options_.domain)});
  }
  ~Ros2Nodes() override {
    ros_.reset();
    rtd_.interrupt();
    rtd_.wait();
  }
  /// The run's output is taken meanwhile: with a full pipe it would stand still.
  template <class Condition>
  bool eventually(const Condition& condition) {
    return test_support::eventually([&] {
      rtd_.take_output();
      return condition();
    });
  }

  ScratchFolder scratch_;
  bus::BusOptions options_;
  RtdCommand rtd_;
  std::optional<RosDouble> ros_;
};

TEST_P(Ros2Nodes, of_a_running_pipeline_are_listed_with_their_topics_and_no_endpoint_is_warned_of) {
  ros_.emplace(options_);
  const std::set<std::string> services = {"/rtd", "/rtd_camera", "/rtd_filter", "/rtd_slam"};
  ASSERT_TRUE(eventually([&] { return std::ranges::includes(ros_->nodes(), services); })) << rtd_.output();
  ASSERT_TRUE(eventually([&] {
    return ros_->written_by("/rtd_slam").contains("rt/slam/pose") &&
           ros_->read_by("/rtd_filter").contains("rtd/frame") &&
           ros_->written_by("/rtd_camera").contains("rt/camera/color/camera_info") &&
           ros_->read_by("/rtd_slam").contains("rq/slam/resetRequest") && !ros_->service_type("/slam/reset").empty() &&
           !ros_->service_type("/rtd_camera/list_parameters").empty();
  })) << rtd_.output();
  EXPECT_THAT(ros_->written_by("/rtd_slam"), IsSupersetOf({"rtd/tracking", "rt/slam/odometry", "rt/tf", "rtd/status"}));
  EXPECT_THAT(ros_->read_by("/rtd_slam"), Contains("rtd/features"));
  EXPECT_TRUE(eventually([&] { return ros_->unknown_endpoints() == 0; })) << "announced and not discovered";
  for (const auto& [name, count] : ros_->counted_nodes()) EXPECT_EQ(count, 1) << name;
  EXPECT_GT(ros_->endpoints(), 60U);
  EXPECT_THAT(ros_->warnings(), IsEmpty());
  EXPECT_EQ(ros_->service_type("/slam/reset"), "std_srvs/srv/Trigger");
  EXPECT_EQ(ros_->service_type("/slam/save_map"), "rtd_msgs/srv/Command");
  EXPECT_EQ(ros_->service_type("/rtd_camera/list_parameters"), "rcl_interfaces/srv/ListParameters");
}

TEST_P(Ros2Nodes, have_the_settings_that_may_change_as_parameters) {
  ros_.emplace(options_);
  const auto list = [&](const std::string& node) {
    const auto reply =
        ros_->call<msg::ListParametersReply>(node, "list_parameters", "ListParameters", msg::ListParametersRequest());
    return reply ? reply->result.names : std::vector<std::string>{"no answer"};
  };
  const auto get = [&](const std::string& node, const std::string& name) {
    const auto reply =
        ros_->call<msg::GetParametersReply>(node, "get_parameters", "GetParameters", msg::ParameterNames{{name}});
    return reply && reply->values.size() == 1 ? reply->values[0] : msg::ParameterValue();
  };
  const auto set = [&](const std::string& node, const std::string& name, const msg::ParameterValue& value) {
    const auto reply = ros_->call<msg::SetParametersReply>(node, "set_parameters", "SetParameters",
                                                           msg::ParameterList{{{name, value}}});
    return reply && reply->results.size() == 1 ? reply->results[0] : msg::SetParametersResult{false, "no answer"};
  };
  ASSERT_TRUE(eventually([&] {
    return ros_->read_by("/rtd_slam").contains("rq/slam/localize_onlyRequest") &&
           ros_->read_by("/rtd_filter").contains("rq/filter/set_modeRequest");
  })) << rtd_.output();
  EXPECT_THAT(list("/rtd_filter"), ElementsAre("filter.mode"));
  EXPECT_THAT(list("/rtd_slam"), ElementsAre("slam.localize_only"));
  EXPECT_THAT(list("/rtd_camera"), IsEmpty());

  msg::ParameterValue mode;
  mode.type = type::kString;
  mode.string_value = "geometry";
  EXPECT_EQ(get("/rtd_filter", "filter.mode").string_value, "rtd");
  const msg::SetParametersResult done = set("/rtd_filter", "filter.mode", mode);
  EXPECT_TRUE(done.successful) << done.reason;
  EXPECT_EQ(get("/rtd_filter", "filter.mode").string_value, "geometry");
  mode.string_value = "frobnicate";
  EXPECT_THAT(set("/rtd_filter", "filter.mode", mode).reason, HasSubstr("'frobnicate' is no mode of the filter"));
  EXPECT_THAT(set("/rtd_filter", "filter.mod", mode).reason, HasSubstr("no such parameter; it has filter.mode"));
  EXPECT_THAT(set("/rtd_slam", "slam.localize_only", mode).reason, HasSubstr("takes true or false"));
  EXPECT_EQ(get("/rtd_filter", "filter.mode").string_value, "geometry");
  EXPECT_EQ(get("/rtd_filter", "no.such").type, type::kNotSet);

  const auto described = ros_->call<msg::DescribeParametersReply>(
      "/rtd_filter", "describe_parameters", "DescribeParameters", msg::ParameterNames{{"filter.mode"}});
  ASSERT_TRUE(described && described->descriptors.size() == 1);
  EXPECT_EQ(described->descriptors[0].type, type::kString);
  EXPECT_THAT(described->descriptors[0].additional_constraints, AllOf(StartsWith("one of "), HasSubstr("rtd-paper")));
  EXPECT_FALSE(described->descriptors[0].read_only);
  const auto types = ros_->call<msg::GetParameterTypesReply>("/rtd_slam", "get_parameter_types", "GetParameterTypes",
                                                             msg::ParameterNames{{"slam.localize_only", "x"}});
  ASSERT_TRUE(types);
  EXPECT_THAT(types->types, ElementsAre(type::kBool, type::kNotSet));

  mode.string_value = "rtd";
  msg::ParameterValue number;
  number.type = type::kDouble;
  const auto together = ros_->call<msg::SetParametersAtomicallyReply>(
      "/rtd_filter", "set_parameters_atomically", "SetParametersAtomically",
      msg::ParameterList{{{"filter.mode", mode}, {"no.such", number}}});
  ASSERT_TRUE(together);
  EXPECT_FALSE(together->result.successful);
  EXPECT_EQ(get("/rtd_filter", "filter.mode").string_value, "geometry") << "all or none";
}

INSTANTIATE_TEST_SUITE_P(EachVendor, Ros2Nodes, ::testing::ValuesIn(bus::dds_vendors()),
                         [](const auto& vendor) { return vendor.param; });
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(Ros2Nodes);

}  // namespace
}  // namespace rtd::launcher
