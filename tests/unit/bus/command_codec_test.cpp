// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/command_codec.hpp"

#include <gtest/gtest.h>

#include <random>

#include "common/bus/prefixed_calls.hpp"
#include "common/bus/robot.hpp"

namespace rtd::bus {
namespace {

using Bytes = std::vector<std::byte>;

Bytes bytes(std::initializer_list<int> numbers) {
  Bytes all;
  for (const int number : numbers) all.push_back(static_cast<std::byte>(number));
  return all;
}

TEST(CommandTopics, are_named_as_the_rmws_name_them) {
  const CallTopics trigger = call_topics("slam/reset", CommandKind::kTrigger);
  EXPECT_EQ(trigger.request, "rq/slam/resetRequest");
  EXPECT_EQ(trigger.request_type, "std_srvs::srv::dds_::Trigger_Request_");
  EXPECT_EQ(trigger.reply, "rr/slam/resetReply");
  EXPECT_EQ(trigger.reply_type, "std_srvs::srv::dds_::Trigger_Response_");
  EXPECT_EQ(call_topics("a", CommandKind::kSetBool).request_type, "std_srvs::srv::dds_::SetBool_Request_");
  EXPECT_EQ(call_topics("a", CommandKind::kText).reply_type, "rtd_msgs::srv::dds_::Command_Response_");
  EXPECT_EQ(ros_type(CommandKind::kText), "rtd_msgs/srv/Command");
}

TEST(CommandTopics, belong_to_a_robot_with_a_name) {
  for (const char* service : {"slam/reset", "filter/set_mode", "recorder/start", "replay/seek"}) {
    const CallTopics topics = call_topics(service, CommandKind::kTrigger);
    const std::string request = topic_of_robot(topics.request, "anna");
    EXPECT_EQ(request, std::string("rq/anna/") + service + "Request");
    EXPECT_EQ(split_robot(request), (RobotTopic{"anna", topics.request}));
    EXPECT_EQ(split_robot(topics.reply), (RobotTopic{"", topics.reply}));
  }
  EXPECT_EQ(topic_of_robot("rq/other/thingRequest", "anna"), "rq/other/thingRequest");
}

TEST(CommandTopics, are_found_again_by_reply_topic_and_type) {
  const auto found = service_of("rr/anna/slam/resetReply", "std_srvs::srv::dds_::Trigger_Response_");
  ASSERT_TRUE(found);
  EXPECT_EQ(found->full_name, "anna/slam/reset");
  EXPECT_EQ(found->kind, CommandKind::kTrigger);
  EXPECT_FALSE(service_of("rr/a/bReply", "example_interfaces::srv::dds_::AddTwoInts_Response_"));
  EXPECT_FALSE(service_of("rq/a/bRequest", "std_srvs::srv::dds_::Trigger_Request_"));
  EXPECT_FALSE(service_of("rr/Reply", "std_srvs::srv::dds_::Trigger_Response_"));
  EXPECT_FALSE(service_of("rt/slam/pose", "geometry_msgs::msg::dds_::PoseStamped_"));
}

TEST(CommandCodec, requests_are_the_bytes_of_ros) {
  EXPECT_EQ(encode_request(CommandKind::kTrigger, {}), bytes({0, 1, 0, 0, 0}));
  EXPECT_EQ(encode_request(CommandKind::kSetBool, {"true"}), bytes({0, 1, 0, 0, 1}));
  EXPECT_EQ(encode_request(CommandKind::kSetBool, {"false"}), bytes({0, 1, 0, 0, 0}));
  EXPECT_EQ(encode_request(CommandKind::kText, {"map"}), bytes({0, 1, 0, 0, 4, 0, 0, 0, 'm', 'a', 'p', 0}));
}

TEST(CommandCodec, answers_are_the_bytes_of_ros) {
  const Bytes answer = bytes({0, 1, 0, 0, 1, 0, 0, 0, 3, 0, 0, 0, 'o', 'k', 0});
  EXPECT_EQ(encode_answer({true, "ok"}), answer);
  EXPECT_TRUE(decode_answer(answer).success);
  EXPECT_EQ(decode_answer(answer).message, "ok");
}

TEST(CommandCodec, a_request_comes_back_as_it_was) {
  for (const char* argument : {"", "map", "/tmp/a b.rtdmap"}) {
    const CommandRequest request{argument};
    EXPECT_EQ(decode_request(CommandKind::kText, encode_request(CommandKind::kText, request)).argument, argument);
  }
  for (const char* argument : {"true", "false"}) {
    const Bytes cdr = encode_request(CommandKind::kSetBool, {argument});
    EXPECT_EQ(decode_request(CommandKind::kSetBool, cdr).argument, argument);
  }
}

TEST(CommandCodec, an_empty_request_of_any_length_is_a_trigger) {
  EXPECT_EQ(decode_request(CommandKind::kTrigger, bytes({0, 1, 0, 0})).argument, "");
  EXPECT_EQ(decode_request(CommandKind::kTrigger, bytes({0, 1, 0, 0, 7, 7, 7, 7})).argument, "");
}

TEST(CommandCodec, malformed_bytes_are_refused) {
  EXPECT_THROW(decode_request(CommandKind::kSetBool, bytes({0, 1, 0, 0})), std::runtime_error);
  EXPECT_THROW(decode_request(CommandKind::kText, {}), std::runtime_error);
  EXPECT_THROW(decode_request(CommandKind::kText, bytes({0, 1, 0, 0, 4, 0, 0})), std::runtime_error);
  EXPECT_THROW(decode_request(CommandKind::kText, bytes({0, 1, 0, 0, 255, 255, 255, 255, 'a'})), std::runtime_error);
  EXPECT_THROW(decode_request(CommandKind::kText, bytes({0, 1, 0, 0, 2, 0, 0, 0, 'a', 'b'})), std::runtime_error);
  EXPECT_THROW(decode_request(CommandKind::kText, bytes({0, 0, 0, 0, 0, 0, 0, 1, 0})), std::runtime_error);
  EXPECT_THROW(decode_answer(bytes({0, 1, 0, 0, 1})), std::runtime_error);
}

TEST(CommandCodec, random_bytes_are_an_argument_or_an_error) {
  std::mt19937 random(7);
  for (int i = 0; i < 20'000; ++i) {
    Bytes cdr(random() % 40);
    for (std::byte& byte : cdr) byte = static_cast<std::byte>(random());
    if (cdr.size() > 1) {
      cdr[0] = std::byte{0};
      cdr[1] = std::byte{1};
    }
    split_prefix(cdr);
    try {
      EXPECT_LE(decode_request(CommandKind::kText, cdr).argument.size(), cdr.size());
    } catch (const std::runtime_error&) {
    }
  }
}

TEST(SwitchArgument, has_the_usual_words) {
  EXPECT_EQ(switch_argument("on"), "true");
  EXPECT_EQ(switch_argument("0"), "false");
  EXPECT_FALSE(switch_argument("yes please"));
  EXPECT_FALSE(switch_argument(""));
}

/// rmw_cyclonedds: header, u64 client, i64 request, fields.
TEST(PrefixedCalls, have_the_bytes_of_rmw_cyclonedds) {
  CallId id;
  id.client = {1, 2, 3, 4, 5, 6, 7, 8};
  id.sequence = 0x0102;
  const Bytes sample = bytes({0, 1, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8, 2, 1, 0, 0, 0, 0, 0, 0, 9});
  EXPECT_EQ(with_prefix(id, bytes({0, 1, 0, 0, 9})), sample);
  const auto call = split_prefix(sample);
  ASSERT_TRUE(call);
  EXPECT_EQ(call->id, id);
  EXPECT_EQ(call->cdr, bytes({0, 1, 0, 0, 9}));
}

TEST(PrefixedCalls, are_distinguished_from_those_of_an_endpoint) {
  CallId number, guid;
  number.client = {1, 0x10, 3, 4, 5, 6, 7, 8};
  guid.client = {1, 0x0f, 3, 4, 5, 6, 7, 8, 0, 0, 0, 0, 0, 0, 1, 4};
  EXPECT_TRUE(is_prefixed(number));
  EXPECT_FALSE(is_prefixed(guid));
}

TEST(PrefixedCalls, of_a_big_endian_client_get_our_byte_order) {
  const auto call = split_prefix(bytes({0, 0, 0, 0, 8, 7, 6, 5, 4, 3, 2, 1, 0, 0, 0, 0, 0, 0, 1, 2, 9}));
  ASSERT_TRUE(call);
  EXPECT_EQ(call->id.client[0], 1);
  EXPECT_EQ(call->id.sequence, 0x0102);
}

TEST(PrefixedCalls, without_a_whole_prefix_are_none) {
  for (std::size_t size = 0; size < 20; ++size) EXPECT_FALSE(split_prefix(Bytes(size))) << size;
  EXPECT_TRUE(split_prefix(Bytes(20)));
}

}  // namespace
}  // namespace rtd::bus
