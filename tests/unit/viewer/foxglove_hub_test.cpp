// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/viewer/core/foxglove_hub.hpp"

#include <gmock/gmock.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "services/viewer/core/outbox.hpp"

namespace rtd::viewer {
namespace {

using foxglove::Schema;
using nlohmann::json;
using namespace ::testing;

const Schema kSchema{"cdr", "std_msgs/msg/String", "ros2msg", "string data"};

std::string text_of(const Frame& frame) {
  return {reinterpret_cast<const char*>(frame.head.data()), frame.head.size()};
}

/// All that waits for a client; binary messages by their opcode.
std::vector<json> take(Session& session) {
  std::vector<json> messages;
  while (auto frame = session.next(0))
    messages.push_back(frame->text ? json::parse(text_of(*frame)) : json(std::to_integer<int>(frame->head[0])));
  return messages;
}

std::vector<std::string> ops(const std::vector<json>& messages) {
  std::vector<std::string> names;
  for (const json& message : messages)
    names.push_back(message.is_object() ? message["op"].get<std::string>() : "binary " + message.dump());
  return names;
}

class FoxgloveHubTest : public ::testing::Test {
 protected:
  FoxgloveHooks hooks() {
    FoxgloveHooks hooks;
    hooks.on_wanted = [this](std::uint32_t channel, bool on) { wanted.emplace_back(channel, on); };
    hooks.on_call = [this](const CommandInfo& command, const std::string& argument, auto answer) {
      calls.push_back(command.name + " " + argument);
      answers.push_back(answer);
    };
    hooks.on_set = [](const foxglove::Parameter& parameter, auto answer) {
      answer({parameter.name == "good", "it does not exist"});
    };
    hooks.on_playback = [this](const foxglove::PlaybackControl& control, auto answer) {
      controls.push_back(control);
      answers.push_back(answer);
    };
    hooks.realtime_ns = [this] { return now_ns; };
    return hooks;
  }
  FoxgloveHub hub{"name", "session", {}, hooks()};
  std::int64_t now_ns = 1'000'000'000'000;
  std::vector<foxglove::PlaybackControl> controls;
  std::vector<std::pair<std::uint32_t, bool>> wanted;
  std::vector<std::string> calls;
  std::vector<std::function<void(CommandResult)>> answers;
};

TEST_F(FoxgloveHubTest, a_client_is_greeted_and_receives_the_channels) {
  const auto id = hub.add_channel("/a", kSchema);
  const auto client = hub.open();
  const auto first = take(*client);
  EXPECT_THAT(ops(first), ElementsAre("serverInfo", "advertise"));
  EXPECT_EQ(first[1]["channels"][0]["id"], id);
  hub.add_channel("/b", kSchema);
  EXPECT_THAT(ops(take(*client)), ElementsAre("advertise"));
  hub.remove_channel(id);
  EXPECT_THAT(ops(take(*client)), ElementsAre("unadvertise"));
  EXPECT_EQ(hub.add_channel("/a", kSchema), id) << "the same topic and type";
  EXPECT_NE(hub.add_channel("/a", {"cdr", "other/msg/Type", "", ""}), id);
}

TEST_F(FoxgloveHubTest, only_subscribed_channels_are_wanted_and_delivered) {
  const auto id = hub.add_channel("/a", kSchema);
  auto first = hub.open();
  const auto second = hub.open();
  take(*first);
  take(*second);
  const std::string subscribe =
      R"({"op":"subscribe","subscriptions":[{"id":7,"channelId":)" + std::to_string(id) + "}]}";
  first->on_text(subscribe);
  second->on_text(subscribe);
  EXPECT_THAT(wanted, ElementsAre(std::pair(id, true)));
  hub.publish(id, 5, std::make_shared<const Bytes>(3));
  EXPECT_THAT(ops(take(*first)), ElementsAre("binary 1"));
  first->on_text(R"({"op":"unsubscribe","subscriptionIds":[7]})");
  hub.publish(id, 6, std::make_shared<const Bytes>(3));
  EXPECT_THAT(take(*first), IsEmpty());
  EXPECT_EQ(take(*second).size(), 2U);
  wanted.clear();
  first.reset();
  EXPECT_THAT(wanted, IsEmpty());
  second->on_text(R"({"op":"unsubscribe","subscriptionIds":[7]})");
  EXPECT_THAT(wanted, ElementsAre(std::pair(id, false)));
}

TEST_F(FoxgloveHubTest, a_client_that_leaves_frees_its_channels) {
  const auto id = hub.add_channel("/a", kSchema);
  auto client = hub.open();
  client->on_text(R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":1}]})");
  client.reset();
  EXPECT_THAT(wanted, ElementsAre(std::pair(id, true), std::pair(id, false)));
  EXPECT_FALSE(hub.wanted(id));
}

TEST_F(FoxgloveHubTest, wrong_requests_are_answered_and_cost_nothing_else) {
  const auto client = hub.open();
  take(*client);
  client->on_text(R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":99}]})");
  client->on_text(R"({"op":"unsubscribe","subscriptionIds":[5]})");
  client->on_text("garbage");
  client->on_binary({});
  client->on_text(R"({"op":"advertise","channels":[{"id":1,"topic":"/x","encoding":"cdr","schemaName":"y"}]})");
  const auto answers_now = take(*client);
  EXPECT_THAT(ops(answers_now), ElementsAre("status", "status", "status", "status", "status"));
  EXPECT_THAT(answers_now[4]["message"].get<std::string>(), HasSubstr("--publish"));
  EXPECT_FALSE(client->overflowed());
}

TEST_F(FoxgloveHubTest, a_client_that_floods_and_does_not_read_is_given_up) {
  const auto client = hub.open();
  for (int i = 0; i < 2000; ++i) client->on_text("garbage");
  EXPECT_TRUE(client->overflowed());
}

TEST_F(FoxgloveHubTest, commands_are_services) {
  hub.set_commands({{"/slam/reset", CommandKind::kTrigger}, {"/filter/set_mode", CommandKind::kText}});
  auto client = hub.open();
  const auto greeting = take(*client);
  ASSERT_THAT(ops(greeting), ElementsAre("serverInfo", "advertise", "advertiseServices"));
  EXPECT_EQ(greeting[2]["services"][0]["type"], "std_srvs/srv/Trigger");
  EXPECT_EQ(greeting[2]["services"][1]["request"]["schema"], "string argument\n");
  const std::string call(std::string_view("\x02\x01\x00\x00\x00\x09\x00\x00\x00\x04\x00\x00\x00json{}", 19));
  client->on_binary(std::as_bytes(std::span(call)));
  EXPECT_THAT(calls, ElementsAre("/slam/reset "));
  EXPECT_THAT(take(*client), IsEmpty());
  answers[0]({true, "done"});
  EXPECT_THAT(ops(take(*client)), ElementsAre("binary 3"));
  client->on_binary(std::as_bytes(std::span(call)));
  client.reset();
  answers[1]({true, "too late"});  // must not touch the client
  hub.set_commands({});
  const auto other = hub.open();
  take(*other);
  other->on_binary(std::as_bytes(std::span(call)));
  EXPECT_THAT(ops(take(*other)), ElementsAre("serviceCallFailure"));
}

TEST_F(FoxgloveHubTest, a_client_that_only_looks_causes_nothing) {
  hub.set_commands({{"/slam/save_map", CommandKind::kText}});
  const auto looker = hub.open(foxglove::kSubprotocols[0], Rights::kLook), other = hub.open();
  const auto greeting = take(*looker);
  ASSERT_THAT(ops(greeting), ElementsAre("serverInfo", "advertise")) << "no services";
  EXPECT_THAT(greeting[0]["capabilities"].dump(), testing::Not(HasSubstr("services")));
  const std::string call(std::string_view("\x02\x01\x00\x00\x00\x09\x00\x00\x00\x04\x00\x00\x00json{}", 19));
  looker->on_binary(std::as_bytes(std::span(call)));
  looker->on_text(R"({"op":"setParameters","parameters":[{"name":"good","value":1}]})");
  EXPECT_THAT(ops(take(*looker)), ElementsAre("serviceCallFailure", "status"));
  EXPECT_THAT(calls, IsEmpty());
  take(*other);
  hub.set_commands({{"/slam/reset", CommandKind::kTrigger}});
  EXPECT_THAT(take(*looker), IsEmpty());
  EXPECT_EQ(take(*other).size(), 2U) << "one is gone, one is new";
}

TEST_F(FoxgloveHubTest, parameters_are_read_set_and_watched) {
  hub.set_parameters({{"good", 1.0}});
  const auto client = hub.open();
  take(*client);
  client->on_text(R"({"op":"getParameters","parameterNames":[],"id":"q"})");
  EXPECT_EQ(take(*client)[0]["parameters"][0]["value"], 1.0);
  client->on_text(R"({"op":"subscribeParameterUpdates","parameterNames":["good"]})");
  hub.set_parameters({{"good", 2.0}});
  hub.set_parameters({{"good", 2.0}});
  EXPECT_EQ(take(*client).size(), 1U) << "only the change";
  client->on_text(R"({"op":"setParameters","parameters":[{"name":"bad","value":1}]})");
  EXPECT_EQ(take(*client)[0]["message"], "parameter 'bad': it does not exist");
}

TEST_F(FoxgloveHubTest, what_a_client_has_set_is_answered_with_its_new_value) {
  hub.set_parameters({{"good", 1.0}, {"bad", 2.0}});
  const auto client = hub.open();
  take(*client);
  client->on_text(
      R"({"op":"setParameters","id":"7","parameters":[{"name":"good","value":5},{"name":"bad","value":5}]})");
  const auto news = take(*client);
  ASSERT_THAT(ops(news), ElementsAre("status", "parameterValues"));
  EXPECT_EQ(news[1]["id"], "7");
  EXPECT_EQ(news[1]["parameters"][0]["value"], 5.0) << "the heartbeat with it comes later";
  EXPECT_EQ(news[1]["parameters"][1]["value"], 2.0) << "refused";
}

TEST(Played, continues_from_where_it_was) {
  Played played{.begin_ns = 100, .end_ns = 1'000, .position_ns = 200, .speed = 2, .at_ns = 50};
  EXPECT_EQ(played.position_at(150), 400U);
  EXPECT_EQ(played.position_at(5'000), 1'000U);
  EXPECT_EQ(played.position_at(-5'000), 100U);
  played.paused = true;
  EXPECT_EQ(played.position_at(150), 200U);
  played.ended = true;
  EXPECT_EQ(played.position_at(150), 1'000U);
}

TEST_F(FoxgloveHubTest, a_replay_that_begins_is_offered_to_clients_that_are_there) {
  const auto client = hub.open();
  const json before = take(*client)[0];
  EXPECT_THAT(before["capabilities"], Not(Contains("playbackControl")));
  const Played played{.begin_ns = 0, .end_ns = 5'000'000'000, .at_ns = now_ns};
  hub.set_played(played);
  hub.set_played(played);
  const auto news = take(*client);
  ASSERT_THAT(ops(news), ElementsAre("serverInfo", "binary 5", "binary 5")) << "the description once";
  EXPECT_THAT(news[0]["capabilities"], Contains("playbackControl"));
  EXPECT_EQ(news[0]["dataEndTime"]["sec"], 5);
  EXPECT_EQ(news[0]["sessionId"], before["sessionId"]) << "the client keeps what it has";
  hub.set_played(std::nullopt);
  const json live = take(*client)[0];
  EXPECT_THAT(live["capabilities"], Not(Contains("playbackControl")));
  EXPECT_FALSE(live.contains("dataEndTime"));
}

/// Binary messages of one kind, without their opcode.
std::vector<Bytes> take_binary(Session& session, int opcode) {
  std::vector<Bytes> found;
  while (auto frame = session.next(0))
    if (!frame->text && std::to_integer<int>(frame->head[0]) == opcode)
      found.emplace_back(frame->head.begin() + 1, frame->head.end());
  return found;
}

template <class T>
T at(const Bytes& bytes, std::size_t place) {
  T value;
  std::memcpy(&value, bytes.data() + place, sizeof(T));
  return value;
}

/// A request of a client; `seek_ns` 0: none.
std::string control(bool pause, float speed, std::uint64_t seek_ns, const std::string& id) {
  ByteWriter writer(std::uint8_t{3}, static_cast<std::uint8_t>(pause), speed, static_cast<std::uint8_t>(seek_ns > 0),
                    seek_ns);
  writer.put_text(id);
  const Bytes bytes = writer.take();
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

TEST_F(FoxgloveHubTest, a_seek_is_answered_with_the_position_and_the_id_of_the_request) {
  constexpr std::uint64_t kBegin = 7'000'000'000, kEnd = 17'000'000'000;
  hub.set_played(Played{.begin_ns = kBegin, .end_ns = kEnd, .position_ns = kBegin, .at_ns = now_ns});
  const auto client = hub.open();
  take(*client);
  const std::string seek = control(true, 2, 9'000'000'000, "req"), past = control(false, 1, kEnd + 5, "late");
  client->on_binary(std::as_bytes(std::span(seek)));
  ASSERT_EQ(controls.size(), 1U);
  EXPECT_TRUE(take_binary(*client, 5).empty()) << "not done yet";
  now_ns += 500;
  answers[0]({true, ""});
  const auto states = take_binary(*client, 5);
  ASSERT_EQ(states.size(), 1U);
  EXPECT_EQ(at<std::uint8_t>(states[0], 0), 1) << "paused";
  EXPECT_EQ(at<std::uint64_t>(states[0], 1), 9'000'000'000U);
  EXPECT_EQ(at<float>(states[0], 9), 2.0F);
  EXPECT_EQ(at<std::uint8_t>(states[0], 13), 1) << "did seek";
  EXPECT_EQ(std::string(reinterpret_cast<const char*>(states[0].data()) + 18, 3), "req");
  hub.set_played(Played{.begin_ns = kBegin, .end_ns = kEnd, .position_ns = kBegin, .at_ns = now_ns - 1});
  EXPECT_EQ(hub.played()->position_ns, 9'000'000'000U) << "a heartbeat of before the seek";
  client->on_binary(std::as_bytes(std::span(past)));
  answers[1]({false, "the replay has ended"});
  EXPECT_EQ(take(*client)[0]["message"], "the replay has ended");
}

TEST_F(FoxgloveHubTest, a_client_without_playback_control_gets_no_state_of_it) {
  const auto old = hub.open("foxglove.websocket.v1");
  take(*old);
  hub.set_played(Played{.begin_ns = 0, .end_ns = 10, .at_ns = now_ns});
  EXPECT_THAT(ops(take(*old)), ElementsAre("serverInfo"));
}

TEST_F(FoxgloveHubTest, while_a_recording_is_played_all_times_are_recorded_ones) {
  const auto id = hub.add_channel("/a", kSchema);
  const auto client = hub.open();
  client->on_text(R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":1}]})");
  take(*client);
  const auto log_time = [&](std::int64_t source_ns) {
    hub.publish(id, source_ns, std::make_shared<const Bytes>(3));
    return at<std::uint64_t>(take_binary(*client, 1).at(0), 4);
  };
  EXPECT_EQ(log_time(now_ns), static_cast<std::uint64_t>(now_ns)) << "live";
  hub.set_played(Played{.begin_ns = 5'000, .end_ns = 9'000, .position_ns = 6'000, .speed = 1, .at_ns = now_ns});
  EXPECT_EQ(log_time(5'500), 5'500U) << "played";
  EXPECT_EQ(log_time(now_ns + 100), 6'100U) << "published while it is played";
  now_ns += 200;
  take(*client);
  hub.send_time();
  EXPECT_EQ(at<std::uint64_t>(take_binary(*client, 2).at(0), 0), 6'200U);
}

TEST_F(FoxgloveHubTest, the_graph_comes_whole_and_then_its_changes) {
  foxglove::ConnectionGraph graph;
  graph.published["/a"] = {"1"};
  hub.set_graph(graph);
  const auto client = hub.open();
  take(*client);
  client->on_text(R"({"op":"subscribeConnectionGraph"})");
  EXPECT_THAT(ops(take(*client)), ElementsAre("connectionGraphUpdate"));
  hub.set_graph(graph);
  EXPECT_THAT(take(*client), IsEmpty());
}

}  // namespace
}  // namespace rtd::viewer
