// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// Commands between a server and a client of every vendor.
#include "common/bus/commands.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <future>
#include <stdexcept>
#include <thread>
#include <tuple>

#include "common/bus/command_codec.hpp"
#include "common/bus/raw_bus.hpp"
#include "tests/component/bus/peer_process.hpp"
#include "tests/support/inprocess/inprocess_bus.hpp"

namespace rtd::bus {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using Cause = CommandError::Cause;

constexpr int kPatience_ms = 8000;

BusOptions options_with(const std::string& vendor, const std::string& robot = {}) {
  BusOptions options = options_of(vendor);
  options.robot = robot;
  return options;
}

CommandAnswer echo(const CommandRequest& request) {
  return {true, "got '" + request.argument + "'"};
}

/// The error that a call ends with.
template <class Call>
std::pair<Cause, std::string> error_of(const Call& call) {
  try {
    call();
  } catch (const CommandError& error) {
    return {error.cause(), error.what()};
  }
  throw std::logic_error("the call succeeded");
}

/// Services of a connection to Cyclone DDS are offered through Fast DDS, which answers clients of both.
std::string serving_vendor(const std::string& vendor) {
  return vendor == "cyclonedds" && std::ranges::count(dds_vendors(), "fastdds") > 0 ? "fastdds" : vendor;
}

/// Vendor of the server, vendor of the client.
class Commands : public testing::TestWithParam<std::tuple<std::string, std::string>> {
 protected:
  std::shared_ptr<Bus> bus_ = connect(options_with(std::get<0>(GetParam())));
  CommandClient client_{options_with(std::get<1>(GetParam()))};
};

TEST_P(Commands, of_each_kind_are_answered) {
  const CommandServer reset(*bus_, "slam/reset", CommandKind::kTrigger, echo);
  const CommandServer only(*bus_, "slam/localize_only", CommandKind::kSetBool, echo);
  const CommandServer save(*bus_, "slam/save_map", CommandKind::kText, echo);
  EXPECT_EQ(client_.call("slam/reset", "", kPatience_ms).message, "got ''");
  EXPECT_EQ(client_.call("/slam/localize_only", "on", kPatience_ms).message, "got 'true'");
  EXPECT_EQ(client_.call("slam/localize_only", "false", kPatience_ms).message, "got 'false'");
  const CommandAnswer answer = client_.call("slam/save_map", "/tmp/a map", kPatience_ms);
  EXPECT_TRUE(answer.success);
  EXPECT_EQ(answer.message, "got '/tmp/a map'");
}

/// As a node of ROS 2 calls them, which knows nothing of the vendor of the server.
TEST_P(Commands, are_answered_to_a_client_of_either_rmw) {
  const CommandServer server(*bus_, "slam/save_map", CommandKind::kText, echo);
  const auto node = connect_raw(options_with(std::get<1>(GetParam())));
  std::promise<std::pair<CallId, CommandAnswer>> answered;
  const auto client = node->create_calls(call_topics("slam/save_map", CommandKind::kText), CallRole::kClient,
                                         [&](const CallId& id, std::span<const std::byte> cdr) {
                                           answered.set_value({id, decode_answer(cdr)});
                                         });
  const auto is_available = [&] { return client->matched_readers() == 1 && client->matched_writers() == 1; };
  for (int i = 0; i < 1600 && !is_available(); ++i) std::this_thread::sleep_for(5ms);
  ASSERT_TRUE(is_available()) << "one server, whatever its process uses";
  std::this_thread::sleep_for(100ms);
  const std::optional<CallId> asked = client->request(encode_request(CommandKind::kText, {"room"}));
  ASSERT_TRUE(asked);
  auto future = answered.get_future();
  ASSERT_EQ(future.wait_for(std::chrono::milliseconds(kPatience_ms)), std::future_status::ready);
  const auto [id, answer] = future.get();
  EXPECT_EQ(id, *asked);
  EXPECT_EQ(answer.message, "got 'room'");
}

/// As `ros2 param get` in a script: a client appears while that before it has not quite gone.
TEST_P(Commands, of_clients_in_quick_succession_are_all_answered) {
  if (serving_vendor(std::get<0>(GetParam())) != "fastdds" || std::get<1>(GetParam()) != "fastdds")
    GTEST_SKIP() << "only clients of Fast DDS name the reader of their answer";
  const CommandServer server(*bus_, "slam/save_map", CommandKind::kText, echo);
  const auto node = connect_raw(options_with("fastdds"));
  int answered = 0;
  constexpr int kClients = 200;
  for (int i = 0; i < kClients; ++i) {
    auto answer = std::make_shared<std::promise<void>>();
    const auto client = node->create_calls(call_topics("slam/save_map", CommandKind::kText), CallRole::kClient,
                                           [answer](const auto&, const auto&) { answer->set_value(); });
    const auto is_available = [&] { return client->matched_readers() > 0 && client->matched_writers() > 0; };
    for (int wait = 0; wait < 10'000 && !is_available(); ++wait) std::this_thread::sleep_for(1ms);
    ASSERT_TRUE(client->request(encode_request(CommandKind::kText, {"room"})));
    if (answer->get_future().wait_for(2s) == std::future_status::ready) ++answered;
  }
  EXPECT_EQ(answered, kClients);
}

TEST_P(Commands, are_listed_with_type_vendor_and_robot) {
  const CommandServer reset(*bus_, "slam/reset", CommandKind::kTrigger, echo);
  const auto annas = bus_->of_robot("anna");
  const CommandServer seek(*annas, "replay/seek", CommandKind::kText, echo);
  for (int i = 0; i < 1000 && client_.commands().size() < 2; ++i) std::this_thread::sleep_for(5ms);
  const std::vector<FoundCommand> all = client_.commands();
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[0].full_name(), "/anna/replay/seek");
  EXPECT_EQ(all[0].robot, "anna");
  EXPECT_EQ(all[0].kind, CommandKind::kText);
  EXPECT_EQ(all[1].full_name(), "/slam/reset");
  EXPECT_EQ(all[1].vendor, serving_vendor(std::get<0>(GetParam())));
  EXPECT_EQ(client_.call("anna/replay/seek", "7", kPatience_ms).message, "got '7'");
}

TEST_P(Commands, reach_the_robot_of_the_client) {
  const auto annas = bus_->of_robot("anna");
  const CommandServer own(*bus_, "slam/reset", CommandKind::kTrigger, [](const auto&) -> CommandAnswer {
    return {true, "unnamed"};
  });
  const CommandServer hers(*annas, "slam/reset", CommandKind::kTrigger, [](const auto&) -> CommandAnswer {
    return {true, "anna"};
  });
  CommandClient of_anna(options_with(std::get<1>(GetParam()), "anna"));
  EXPECT_EQ(of_anna.call("slam/reset", "", kPatience_ms).message, "anna");
  EXPECT_EQ(client_.call("slam/reset", "", kPatience_ms).message, "unnamed");
}

TEST_P(Commands, many_at_once_get_each_its_own_answer) {
  const CommandServer server(*bus_, "slam/save_map", CommandKind::kText, echo);
  CommandClient other(options_with(std::get<1>(GetParam())));
  std::vector<std::future<CommandAnswer>> answers;
  const auto ask = [](CommandClient& client, std::string text) {
    return std::async(std::launch::async, [&client, text] { return client.call("slam/save_map", text, kPatience_ms); });
  };
  for (int i = 0; i < 6; ++i) answers.push_back(ask(i % 2 == 0 ? client_ : other, std::to_string(i)));
  for (std::size_t i = 0; i < answers.size(); ++i)
    EXPECT_EQ(answers[i].get().message, "got '" + std::to_string(i) + "'");
}

TEST_P(Commands, whose_handler_throws_fail_with_its_text) {
  const CommandServer server(*bus_, "slam/reset", CommandKind::kTrigger, [](const auto&) -> CommandAnswer {
    throw std::runtime_error("no map: nothing was tracked yet");
  });
  const CommandAnswer answer = client_.call("slam/reset", "", kPatience_ms);
  EXPECT_FALSE(answer.success);
  EXPECT_EQ(answer.message, "no map: nothing was tracked yet");
}

TEST_P(Commands, that_no_process_offers_name_the_nearest) {
  const CommandServer server(*bus_, "slam/reset", CommandKind::kTrigger, echo);
  EXPECT_TRUE(client_.call("slam/reset", "", kPatience_ms).success);
  const auto [cause, text] = error_of([&] { client_.call("slam/rset", "", 100); });
  EXPECT_EQ(cause, Cause::kNotFound);
  EXPECT_THAT(text, HasSubstr("did you mean /slam/reset?"));
}

TEST_P(Commands, with_a_wrong_argument_are_not_sent) {
  std::atomic<int> calls{0};
  const auto count = [&calls](const CommandRequest&) -> CommandAnswer { return {true, std::to_string(++calls)}; };
  const CommandServer reset(*bus_, "slam/reset", CommandKind::kTrigger, count);
  const CommandServer only(*bus_, "slam/localize_only", CommandKind::kSetBool, count);
  const auto with_text = error_of([&] { client_.call("slam/reset", "now", kPatience_ms); });
  EXPECT_EQ(with_text.first, Cause::kWrongArgument);
  const auto [cause, text] = error_of([&] { client_.call("slam/localize_only", "perhaps", kPatience_ms); });
  EXPECT_EQ(cause, Cause::kWrongArgument);
  EXPECT_THAT(text, HasSubstr("takes true or false, not 'perhaps'"));
  EXPECT_EQ(calls, 0);
}

TEST_P(Commands, that_take_too_long_end_with_the_timeout) {
  std::promise<void> end;
  const CommandServer server(*bus_, "slam/save_map", CommandKind::kText,
                             [ended = end.get_future().share()](const CommandRequest& request) -> CommandAnswer {
                               if (request.argument == "slow") ended.wait();
                               return {true, request.argument};
                             });
  EXPECT_EQ(client_.call("slam/save_map", "quick", kPatience_ms).message, "quick");
  const auto [cause, text] = error_of([&] { client_.call("slam/save_map", "slow", 300); });
  EXPECT_EQ(cause, Cause::kNoAnswer);
  EXPECT_THAT(text, HasSubstr("did not answer within 0.3 s"));
  end.set_value();
  EXPECT_EQ(client_.call("slam/save_map", "quick", kPatience_ms).message, "quick");  // not the late answer
}

TEST_P(Commands, offered_by_two_programs_are_refused_until_one_ends) {
  const CommandServer first(*bus_, "slam/reset", CommandKind::kTrigger, echo);
  auto other_program = connect(options_with(std::get<0>(GetParam())));
  auto second = std::make_unique<CommandServer>(*other_program, "slam/reset", CommandKind::kTrigger, echo);
  const auto two = [this] {
    const auto all = client_.commands();
    return all.size() == 1 && all[0].servers == 2;
  };
  for (int i = 0; i < 1000 && !two(); ++i) std::this_thread::sleep_for(5ms);
  const auto [cause, text] = error_of([&] { client_.call("slam/reset", "", 200); });
  EXPECT_EQ(cause, Cause::kSeveral);
  EXPECT_THAT(text, HasSubstr("2 programs offer /slam/reset"));
  second.reset();
  other_program.reset();  // Fast DDS learns of a Cyclone DDS writer's end only by its participant's
  EXPECT_TRUE(client_.call("slam/reset", "", kPatience_ms).success);
}

TEST_P(Commands, whose_server_ends_meanwhile_say_so) {
  std::promise<void> called, end;
  auto server = std::make_unique<CommandServer>(*bus_, "slam/reset", CommandKind::kTrigger, [&](const auto&) {
    called.set_value();
    end.get_future().wait();
    return CommandAnswer{true, ""};
  });
  auto answer = std::async(std::launch::async, [this] {
    try {
      return client_.call("slam/reset", "", kPatience_ms).message;
    } catch (const CommandError& error) {
      return std::string(error.what());
    }
  });
  called.get_future().wait();
  std::thread ending([&] { server.reset(); });
  std::this_thread::sleep_for(50ms);
  end.set_value();
  ending.join();
  EXPECT_THAT(answer.get(), testing::AnyOf("", HasSubstr("ended before it answered")));
}

TEST_P(Commands, outlive_a_client_that_leaves_before_the_answer) {
  std::promise<void> called, end;
  const CommandServer server(*bus_, "slam/save_map", CommandKind::kText, [&](const CommandRequest& request) {
    if (request.argument == "slow") {
      called.set_value();
      end.get_future().wait();
    }
    return CommandAnswer{true, "done"};
  });
  {
    CommandClient leaving(options_with(std::get<1>(GetParam())));
    leaving.call("slam/save_map", "quick", kPatience_ms);
    const auto gave_up =
        std::async(std::launch::async, [&] { error_of([&] { leaving.call("slam/save_map", "slow", 300); }); });
    called.get_future().wait();
  }
  end.set_value();
  EXPECT_EQ(client_.call("slam/save_map", "quick", kPatience_ms).message, "done");
}

std::vector<std::tuple<std::string, std::string>> pairs() {
  std::vector<std::tuple<std::string, std::string>> all = {{inprocess::vendor(), inprocess::vendor()}};
  for (const std::string& server : dds_vendors())
    for (const std::string& client : dds_vendors()) all.emplace_back(server, client);
  return all;
}

INSTANTIATE_TEST_SUITE_P(Pairs, Commands, testing::ValuesIn(pairs()), [](const auto& test) {
  return std::get<0>(test.param) + "_server_" + std::get<1>(test.param) + "_client";
});

class MalformedCommands : public testing::TestWithParam<std::string> {};

TEST_P(MalformedCommands, do_not_keep_good_ones_from_being_answered) {
  const auto bus = connect(options_with(GetParam()));
  const CommandServer server(*bus, "slam/save_map", CommandKind::kText, echo);
  const auto raw = connect_raw(options_with(GetParam()));
  const CallTopics topics = call_topics("slam/save_map", CommandKind::kText);
  const auto writer = raw->writer({topics.request, topics.request_type}, {});
  for (int i = 0; i < 1000 && writer->matched() == 0; ++i) std::this_thread::sleep_for(5ms);
  ASSERT_EQ(writer->matched(), 1);
  std::this_thread::sleep_for(100ms);  // until the other side has matched, too
  std::vector<std::byte> endless(200, std::byte{0xff}), huge(3'000'000, std::byte{0x41});
  endless[0] = std::byte{0};
  endless[1] = std::byte{1};
  huge[0] = std::byte{0};
  huge[1] = std::byte{1};
  for (const auto& bytes : {std::vector<std::byte>(4), std::vector<std::byte>(19), endless, huge}) {
    EXPECT_TRUE(writer->write(bytes));
    writer->wait_acknowledged(1000);
  }
  CommandClient client(options_with(GetParam()));
  EXPECT_EQ(client.call("slam/save_map", "good", kPatience_ms).message, "got 'good'");
}

INSTANTIATE_TEST_SUITE_P(Vendors, MalformedCommands, testing::ValuesIn(inprocess::all_vendors()),
                         [](const auto& test) { return test.param; });

}  // namespace
}  // namespace rtd::bus
