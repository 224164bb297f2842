// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/parameter_server.hpp"

#include <gmock/gmock.h>

#include "common/bus/commands.hpp"
#include "tests/support/inprocess/inprocess_bus.hpp"
#include "tests/support/test_domain.hpp"

namespace rtd::service {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
namespace type = msg::parameter_type;

msg::Parameter parameter(const std::string& name, const SettingValue& value) {
  msg::Parameter result{name, {}};
  if (const auto* flag = std::get_if<bool>(&value)) result.value = {type::kBool, *flag};
  if (const auto* number = std::get_if<double>(&value)) result.value = {type::kDouble, false, 0, *number};
  if (const auto* text = std::get_if<std::string>(&value)) result.value = {type::kString, false, 0, 0, *text};
  return result;
}

/// A replay whose commands only note what they get.
class ParametersTest : public testing::Test {
 protected:
  ParametersTest() {
    heartbeat_.set_metric("replay.paused", 0);
    heartbeat_.set_metric("replay.speed", 1);
    const auto note = [this](const char* command, bool succeeds) {
      bus_->commands()->add(command, [this, command, succeeds](const bus::CommandRequest& request) {
        calls_.push_back(std::string(command) + ' ' + request.argument);
        return bus::CommandAnswer{succeeds && request.argument != "5", "because"};
      });
    };
    note("replay/pause", true);
    note("replay/speed", true);
  }

  std::shared_ptr<bus::Bus> bus_ = bus::connect({.vendor = bus::inprocess::vendor(), .domain = test_domain()});
  StopToken stop_;
  Heartbeat heartbeat_{*bus_, "replay", stop_};
  std::vector<std::string> calls_;
  Parameters parameters_{"replay", heartbeat_, bus_->commands()};
};

TEST_F(ParametersTest, are_those_that_the_heartbeat_has) {
  EXPECT_THAT(parameters_.list({}).result.names, ElementsAre("replay.paused", "replay.speed"));
  EXPECT_THAT(parameters_.list({}).result.prefixes, ElementsAre("replay"));
  EXPECT_THAT(parameters_.list({{"replay"}, 1}).result.names, ElementsAre("replay.paused", "replay.speed"));
  EXPECT_THAT(parameters_.list({{"replay.speed"}, 0}).result.names, ElementsAre("replay.speed"));
  EXPECT_THAT(parameters_.list({{}, 1}).result.names, IsEmpty()) << "both lie one part further down";
  EXPECT_THAT(parameters_.list({{"rep"}, 0}).result.names, IsEmpty()) << "no part of a name";
  Parameters of_slam("slam", heartbeat_, bus_->commands());
  EXPECT_THAT(of_slam.list({}).result.names, IsEmpty());
}

TEST_F(ParametersTest, are_set_by_the_command_and_read_at_once) {
  EXPECT_TRUE(parameters_.set({{parameter("replay.paused", true)}}).results[0].successful);
  EXPECT_THAT(calls_, ElementsAre("replay/pause true"));
  EXPECT_TRUE(parameters_.get({{"replay.paused"}}).values[0].bool_value);
  msg::Parameter whole{"replay.speed", {}};
  whole.value.type = type::kInteger;
  whole.value.integer_value = 2;
  EXPECT_TRUE(parameters_.set({{whole}}).results[0].successful) << "ros2 param set ... 2";
  EXPECT_EQ(parameters_.get({{"replay.speed"}}).values[0].double_value, 2);
}

TEST_F(ParametersTest, refuse_with_the_reason) {
  const auto reason = [this](const msg::Parameter& one) {
    const msg::SetParametersResult result = parameters_.set({{one}}).results[0];
    EXPECT_FALSE(result.successful);
    return result.reason;
  };
  EXPECT_EQ(reason(parameter("replay.speed", 5.0)), "because") << "what the command says";
  EXPECT_THAT(reason(parameter("replay.speed", true)), HasSubstr("takes a number"));
  EXPECT_THAT(reason(parameter("filter.mode", std::string("rtd"))), HasSubstr("it has replay.paused, replay.speed"));
  msg::Parameter list{"replay.speed", {}};
  list.value.type = 8;
  list.value.double_array_value = {1, 2};
  EXPECT_THAT(reason(list), HasSubstr("takes a number"));
  EXPECT_THAT(reason(parameter("replay.speed", std::nan(""))), HasSubstr("ParameterValue.double_value is not allowed"));
  bus_->commands()->remove("replay/speed");
  EXPECT_THAT(reason(parameter("replay.speed", 2.0)), HasSubstr("does not take /replay/speed now"));
  EXPECT_EQ(parameters_.get({{"replay.speed"}}).values[0].double_value, 1) << "unchanged";
}

TEST_F(ParametersTest, of_one_request_are_set_all_or_none) {
  const msg::ParameterList good{{parameter("replay.paused", true), parameter("replay.speed", 2.0)}};
  EXPECT_TRUE(parameters_.set_all(good).result.successful);
  const msg::ParameterList bad{{parameter("replay.paused", false), parameter("replay.speed", 5.0)}};
  EXPECT_FALSE(parameters_.set_all(bad).result.successful);
  EXPECT_TRUE(parameters_.get({{"replay.paused"}}).values[0].bool_value) << "put back";
  EXPECT_EQ(calls_.back(), "replay/pause true");
}

TEST_F(ParametersTest, of_one_name_the_last_value_wins) {
  msg::ParameterList list{{parameter("replay.speed", true), parameter("replay.paused", true)}};
  for (int i = 0; i < 6; ++i) list.parameters.push_back(parameter("replay.paused", i % 2 == 0));
  list.parameters.push_back(parameter("replay.speed", 2.0));
  const msg::SetParametersReply reply = parameters_.set(list);
  EXPECT_THAT(calls_, ElementsAre("replay/speed 2")) << "in the end it is not paused, as before";
  ASSERT_EQ(reply.results.size(), list.parameters.size());
  for (const msg::SetParametersResult& result : reply.results) EXPECT_TRUE(result.successful);
  EXPECT_TRUE(
      parameters_.set_all({{parameter("replay.speed", 5.0), parameter("replay.speed", 3.0)}}).result.successful);
  EXPECT_THAT(calls_, ElementsAre("replay/speed 2", "replay/speed 3"));
}

TEST_F(ParametersTest, with_their_value_already_need_no_command) {
  EXPECT_TRUE(parameters_.set({{parameter("replay.paused", false)}}).results[0].successful);
  EXPECT_TRUE(parameters_.set_all({{parameter("replay.speed", 1.0)}}).result.successful);
  EXPECT_THAT(calls_, IsEmpty());
}

TEST_F(ParametersTest, too_many_in_one_request_are_refused_as_a_whole) {
  const std::vector<std::string> names(kMaxParameters + 1, "replay.speed");
  std::vector<msg::Parameter> settings;
  for (std::size_t i = 0; i < names.size(); ++i) settings.push_back(parameter("replay.paused", i % 2 == 0));
  const msg::SetParametersReply reply = parameters_.set({settings});
  ASSERT_EQ(reply.results.size(), settings.size()) << "a result for each, as clients expect";
  EXPECT_FALSE(reply.results[0].successful);
  EXPECT_EQ(reply.results[0].reason, "17 parameters in one request, at most 16 are allowed");
  EXPECT_EQ(parameters_.set_all({settings}).result.reason, reply.results[0].reason);
  EXPECT_THAT(calls_, IsEmpty());
  EXPECT_THAT(parameters_.get({names}).values, IsEmpty());
  EXPECT_THAT(parameters_.types({names}).types, IsEmpty());
  EXPECT_THAT(parameters_.describe({names}).descriptors, IsEmpty());
  EXPECT_THAT(parameters_.list({names, 0}).result.names, IsEmpty());
  settings.pop_back();
  EXPECT_TRUE(parameters_.set({settings}).results[0].successful);
}

TEST_F(ParametersTest, describe_types_ranges_and_words) {
  const msg::ParameterDescriptor speed = parameters_.describe({{"replay.speed"}}).descriptors[0];
  EXPECT_EQ(speed.type, type::kDouble);
  ASSERT_EQ(speed.floating_point_range.size(), 1U);
  EXPECT_EQ(speed.floating_point_range[0].to_value, 1000);
  EXPECT_THAT(speed.description, HasSubstr("1 = as recorded"));
  EXPECT_EQ(parameters_.describe({{"unknown"}}).descriptors[0].type, type::kNotSet);
  EXPECT_THAT(parameters_.types({{"replay.paused", "unknown"}}).types, ElementsAre(type::kBool, type::kNotSet));
}

TEST(LiveSettings, belong_to_services_and_their_commands) {
  for (const Setting& setting : live_settings()) {
    EXPECT_TRUE(std::string(setting.name).starts_with(std::string(setting.service) + '.')) << setting.name;
    EXPECT_TRUE(std::string(setting.command).starts_with(std::string(setting.service) + '/')) << setting.name;
    EXPECT_EQ(setting.form == Setting::Form::kChoice, setting.words != nullptr) << setting.name;
    EXPECT_EQ(setting.form == Setting::Form::kNumber, setting.least < setting.most) << setting.name;
  }
}

}  // namespace
}  // namespace rtd::service
