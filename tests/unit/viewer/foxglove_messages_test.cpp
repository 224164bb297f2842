// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "services/viewer/core/command_forms.hpp"
#include "services/viewer/core/foxglove.hpp"

namespace rtd::viewer::foxglove {
namespace {

using nlohmann::json;
using namespace ::testing;

std::vector<int> numbers(const Bytes& bytes) {
  std::vector<int> values;
  for (const std::byte byte : bytes) values.push_back(std::to_integer<int>(byte));
  return values;
}

Bytes bytes_of(const std::vector<int>& values) {
  Bytes bytes;
  for (const int value : values) bytes.push_back(std::byte(value));
  return bytes;
}

std::string text_of(const Bytes& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

TEST(FoxgloveMessages, binary_layouts_are_those_of_the_protocol) {
  EXPECT_THAT(numbers(message_data_head(20, 1234567890)), ElementsAre(1, 20, 0, 0, 0, 210, 2, 150, 73, 0, 0, 0, 0));
  EXPECT_THAT(numbers(time(1234567890)), ElementsAre(2, 210, 2, 150, 73, 0, 0, 0, 0));
  EXPECT_THAT(numbers(service_call_response(10, 30, "raw", bytes_of({1, 2}))),
              ElementsAre(3, 10, 0, 0, 0, 30, 0, 0, 0, 3, 0, 0, 0, 'r', 'a', 'w', 1, 2));
  EXPECT_THAT(numbers(fetch_asset_failure(10, "no")), ElementsAre(4, 10, 0, 0, 0, 1, 2, 0, 0, 0, 'n', 'o'));
  EXPECT_THAT(numbers(playback_state({PlaybackStatus::kPlaying, 12345, 1.0F, false, "i1"})),
              ElementsAre(5, 0, 57, 48, 0, 0, 0, 0, 0, 0, 0, 0, 128, 63, 0, 2, 0, 0, 0, 'i', '1'));
}

TEST(FoxgloveMessages, texts_have_the_fields_of_the_protocol) {
  const json info = json::parse(server_info({.name = "s",
                                             .session_id = "x",
                                             .capabilities = {"time"},
                                             .supported_encodings = {"cdr"},
                                             .metadata = {{"k", "v"}},
                                             .played_ns = std::pair(1'500'000'000ULL, 2'000'000'001ULL)}));
  EXPECT_EQ(info, json::parse(R"({"op":"serverInfo","name":"s","capabilities":["time"],"supportedEncodings":["cdr"],
    "metadata":{"k":"v"},"sessionId":"x","dataStartTime":{"sec":1,"nsec":500000000},
    "dataEndTime":{"sec":2,"nsec":1}})"));
  const Channel channel{1, "/t", {"cdr", "std_msgs/msg/String", "ros2msg", "string data"}};
  EXPECT_EQ(json::parse(advertise(std::span(&channel, 1))),
            json::parse(R"({"op":"advertise","channels":[{"id":1,"topic":"/t","encoding":"cdr",
    "schemaName":"std_msgs/msg/String","schemaEncoding":"ros2msg","schema":"string data"}]})"));
  const std::vector<std::uint32_t> ids = {1, 2};
  EXPECT_EQ(unadvertise(ids), R"({"channelIds":[1,2],"op":"unadvertise"})");
  EXPECT_EQ(json::parse(status(StatusLevel::kError, "bad")),
            json::parse(R"({"op":"status","level":2,"message":"bad"})"));
  const std::vector<Parameter> parameters = {{"a", true}, {"b", 2.5}, {"c", std::string("x")}, {"d", {}}};
  EXPECT_EQ(json::parse(parameter_values(parameters, "7")), json::parse(R"({"op":"parameterValues","id":"7",
    "parameters":[{"name":"a","value":true},{"name":"b","value":2.5,"type":"float64"},{"name":"c","value":"x"},
    {"name":"d"}]})"));
}

TEST(FoxgloveMessages, names_that_are_not_utf8_do_no_harm) {
  EXPECT_THAT(status(StatusLevel::kInfo, "\xff"), HasSubstr("\xef\xbf\xbd"));
}

TEST(FoxgloveMessages, the_graph_is_sent_as_what_has_changed) {
  ConnectionGraph before, now;
  before.published = {{"/a", {"1"}}, {"/b", {"2"}}};
  now.published = {{"/a", {"1"}}, {"/c", {"3"}}};
  EXPECT_EQ(json::parse(connection_graph_update(before, now)), json::parse(R"({"op":"connectionGraphUpdate",
    "publishedTopics":[{"name":"/c","publisherIds":["3"]}],"subscribedTopics":[],"advertisedServices":[],
    "removedTopics":["/b"],"removedServices":[]})"));
  EXPECT_THAT(connection_graph_update(now, now), IsEmpty());
}

TEST(FoxgloveRequests, texts_are_read) {
  const auto subscribe = std::get<Subscribe>(
      read_text(R"({"op":"subscribe","subscriptions":[{"id":0,"channelId":3},{"id":1,"channelId":5}]})"));
  EXPECT_THAT(subscribe.subscriptions, ElementsAre(std::pair(0U, 3U), std::pair(1U, 5U)));
  EXPECT_THAT(std::get<Unsubscribe>(read_text(R"({"op":"unsubscribe","subscriptionIds":[4]})")).ids, ElementsAre(4U));
  const auto set = std::get<SetParameters>(
      read_text(R"({"op":"setParameters","parameters":[{"name":"x","value":3},{"name":"y"}],"id":"r"})"));
  EXPECT_EQ(std::get<double>(set.parameters[0].value), 3);
  EXPECT_TRUE(std::holds_alternative<std::monostate>(set.parameters[1].value));
  EXPECT_EQ(set.id, "r");
  EXPECT_FALSE(std::get<WatchGraph>(read_text(R"({"op":"unsubscribeConnectionGraph"})")).on);
}

TEST(FoxgloveRequests, binaries_are_read) {
  const Bytes call = bytes_of({2, 1, 0, 0, 0, 2, 0, 0, 0, 4, 0, 0, 0, 'j', 's', 'o', 'n', '{', '}'});
  const auto request = std::get<ServiceCall>(read_binary(call));
  EXPECT_EQ(request.service, 1U);
  EXPECT_EQ(request.call, 2U);
  EXPECT_EQ(request.encoding, "json");
  EXPECT_EQ(request.payload.size(), 2U);
  const Bytes seek = bytes_of({3, 1, 0, 0, 0, 64, 1, 57, 48, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 'a'});
  const auto control = std::get<PlaybackControl>(read_binary(seek));
  EXPECT_TRUE(control.pause);
  EXPECT_EQ(control.speed, 2.0F);
  EXPECT_EQ(control.seek_ns, 12345U);
}

TEST(FoxgloveRequests, nonsense_is_refused_with_its_cause) {
  const auto error = [](auto read) { return ThrowsMessage<ProtocolError>(HasSubstr(read)); };
  EXPECT_THAT([] { read_text("{"); }, error("not JSON"));
  EXPECT_THAT([] { read_text("[]"); }, error("object is missing"));
  EXPECT_THAT([] { read_text(R"({"op":"dance"})"); }, error("'dance' is unknown"));
  EXPECT_THAT([] { read_text(R"({"op":"subscribe","subscriptions":7})"); }, error("not a list"));
  EXPECT_THAT([] { read_text(R"({"op":"subscribe","subscriptions":[{"id":-1,"channelId":2}]})"); }, error("an id"));
  EXPECT_THAT([] { read_text(R"({"op":"setParameters","parameters":[{"name":"x","value":[1]}]})"); },
              error("a parameter"));
  EXPECT_THAT([] { read_binary({}); }, error("too short"));
  EXPECT_THAT([] { read_binary(bytes_of({9})); }, error("opcode 9"));
  EXPECT_THAT([] { read_binary(bytes_of({2, 1, 0, 0, 0, 2, 0, 0, 0, 255, 255, 255, 255})); }, error("too short"));
  EXPECT_THAT(
      [] {
        read_binary(bytes_of({3, 0, 0, 0, 192, 127, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}));
      },
      error("speed"));
}

TEST(CommandForms, requests_are_read_as_json_and_as_cdr) {
  const auto read = [](CommandKind kind, const std::string& encoding, const Bytes& bytes) {
    return read_command_request(kind, encoding, bytes);
  };
  const auto text_bytes = [](const std::string& text) {
    const auto bytes = std::as_bytes(std::span(text));
    return Bytes(bytes.begin(), bytes.end());
  };
  EXPECT_EQ(read(CommandKind::kTrigger, "json", text_bytes("{}")), "");
  EXPECT_EQ(read(CommandKind::kSetBool, "json", text_bytes(R"({"data":true})")), "true");
  EXPECT_EQ(read(CommandKind::kText, "json", text_bytes(R"({"argument":"a.map"})")), "a.map");
  EXPECT_EQ(read(CommandKind::kSetBool, "cdr", bytes_of({0, 1, 0, 0, 0})), "false");
  EXPECT_EQ(read(CommandKind::kText, "cdr", bytes_of({0, 1, 0, 0, 3, 0, 0, 0, 'h', 'i', 0})), "hi");
  EXPECT_FALSE(read(CommandKind::kText, "cdr", bytes_of({0, 1, 0, 0, 9, 0, 0, 0, 'h', 'i', 0})));
  EXPECT_FALSE(read(CommandKind::kSetBool, "json", text_bytes(R"({"data":1})")));
  EXPECT_FALSE(read(CommandKind::kText, "ros1", bytes_of({0})));
}

TEST(CommandForms, answers_are_written_in_the_encoding_of_the_request) {
  EXPECT_EQ(json::parse(text_of(command_response("json", {true, "done"}))),
            json::parse(R"({"success":true,"message":"done"})"));
  EXPECT_THAT(numbers(command_response("cdr", {true, "ok"})),
              ElementsAre(0, 1, 0, 0, 1, 0, 0, 0, 3, 0, 0, 0, 'o', 'k', 0));
}

}  // namespace
}  // namespace rtd::viewer::foxglove
