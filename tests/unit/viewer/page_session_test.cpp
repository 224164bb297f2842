// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/viewer/core/page_session.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "common/msg/point_cloud.hpp"
#include "common/msg/transform_eigen.hpp"

namespace rtd::viewer {
namespace {

using nlohmann::json;
using namespace ::testing;

constexpr std::int64_t kSecond = 1'000'000'000;

std::string name_of(const Frame& frame) {
  const Bytes& bytes = frame.head.empty() ? *frame.payload : frame.head;
  if (!frame.text) return "binary " + std::to_string(std::to_integer<int>(bytes[0]));
  const auto* begin = reinterpret_cast<const char*>(bytes.data());
  return json::parse(begin, begin + bytes.size())["type"];
}

msg::MapUpdate map_of(std::uint32_t keyframes, std::size_t points_each, double x = 0) {
  msg::MapUpdate update{.session_ns = 1};
  for (std::uint32_t id = 0; id < keyframes; ++id) {
    msg::MapKeyframe keyframe{.keyframe_id = id, .content = msg::kMapPoints | msg::kMapEdges};
    keyframe.T_world_camera = msg::to_message(Eigen::Isometry3d(Eigen::Translation3d(x + 0.1 * id, 0, 0)));
    keyframe.points_m.assign(3 * points_each, 1.0F);
    if (id > 0) keyframe.covisible = {id - 1};
    update.keyframes.push_back(std::move(keyframe));
  }
  return update;
}

/// A cloud in colour, as rtd-dense publishes it.
msg::PointCloud2 cloud_of(std::size_t points) {
  std::vector<msg::CloudSlot> slots(points);
  for (std::size_t i = 0; i < points; ++i)
    slots[i] = {static_cast<float>(i % 1000), static_cast<float>(i / 1000), 1, 0};
  return msg::make_cloud(slots, "rgb", 0, "map");
}

msg::TrackingResult result_at(double x) {
  msg::TrackingResult result{};
  result.T_world_camera.translation_m = {x, 0, 0};
  return result;
}

class PageSessionTest : public ::testing::Test {
 protected:
  /// Everything that is sent at one moment, in bytes by kind.
  std::map<std::string, std::size_t> take(Session& page, std::int64_t now_ns) {
    std::map<std::string, std::size_t> bytes;
    while (auto frame = page.next(now_ns)) bytes[name_of(*frame)] += frame->size();
    return bytes;
  }
  PageHub hub{{.version = "1", .vendor = "x", .domain = 3, .control = true, .look_token = "picture"},
              {},
              {.on_call =
                   [this](const std::string& robot, const std::string& name, const std::string& argument, auto answer) {
                     calls.push_back(robot + name + "(" + argument + ")");
                     answers.push_back(answer);
                   },
               .now_ms = [] { return 5.0; }}};
  std::vector<std::string> calls;
  std::vector<std::function<void(CommandResult)>> answers;
};

TEST_F(PageSessionTest, a_page_without_the_token_sees_everything_and_calls_nothing) {
  hub.robot("");
  const auto page = hub.open(Rights::kLook);
  const auto hello = page->next(kSecond);
  ASSERT_TRUE(hello);
  const auto text_of = [](const Frame& frame) {
    const Bytes& bytes = frame.head.empty() ? *frame.payload : frame.head;
    return std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  };
  EXPECT_FALSE(json::parse(text_of(*hello))["control"]);
  EXPECT_FALSE(json::parse(text_of(*hello)).contains("look_token"));
  EXPECT_EQ(json::parse(text_of(*hub.open()->next(kSecond)))["look_token"], "picture") << "for the links it makes";
  take(*page, kSecond);
  page->on_text(R"({"op":"call","id":7,"robot":0,"name":"/slam/save_map","argument":"a"})");
  const auto refused = page->next(2 * kSecond);
  ASSERT_TRUE(refused);
  EXPECT_THAT(text_of(*refused), ::testing::HasSubstr("?token="));
  EXPECT_THAT(calls, IsEmpty());
  hub.open()->on_text(R"({"op":"call","id":7,"robot":0,"name":"/slam/save_map","argument":"a"})");
  EXPECT_THAT(calls, ElementsAre("/slam/save_map(a)"));
}

TEST_F(PageSessionTest, a_late_page_gets_the_poses_of_the_last_minute_first) {
  RobotMirror& robot = *hub.robot("");
  for (int i = 0; i <= 1000; ++i) robot.add(result_at(0.01 * i), 100.0 * i);
  const auto page = hub.open();
  std::size_t poses = 0;
  while (auto frame = page->next(kSecond))
    if (name_of(*frame) == "tracking") ++poses;
  EXPECT_EQ(poses, 300U) << "five a second";
  robot.add(result_at(99), 200'000);
  EXPECT_TRUE(take(*page, 2 * kSecond).contains("tracking"));
}

TEST_F(PageSessionTest, without_a_page_what_a_late_one_needs_is_read) {
  EXPECT_FALSE(hub.options(0));
  const PageOptions later = PageOptions::for_later(5 * kSecond, true);
  EXPECT_TRUE(later.points && later.dense && later.plan && later.image);
  EXPECT_FALSE(later.mask || later.features || later.people || PageOptions::for_later(6 * kSecond, true).image);
  EXPECT_TRUE(PageOptions::for_later(6 * kSecond, false).image) << "a short run has one as well";
}

TEST_F(PageSessionTest, a_late_page_gets_the_whole_state_and_then_changes) {
  RobotMirror& robot = *hub.robot("");
  robot.map().add(map_of(50, 100));
  for (int i = 0; i < 1000; ++i) robot.map().add_position(result_at(0.01 * i));
  const auto page = hub.open();
  const auto first = take(*page, kSecond);
  for (const char* part : {"hello", "robots", "binary 1", "binary 3", "binary 4", "binary 6"})
    EXPECT_TRUE(first.contains(part)) << part;
  EXPECT_EQ(first.at("binary 3"), 8U * 50 * 100 + 12 * 50 + 8) << "each point once, one message";
  EXPECT_THAT(take(*page, kSecond + 1), IsEmpty());
  robot.map().add(map_of(50, 100));
  const auto again = take(*page, kSecond + 2);
  EXPECT_FALSE(again.contains("binary 1")) << "no keyframe has moved";
}

TEST_F(PageSessionTest, a_page_gets_what_an_atlas_says_once_for_each_change) {
  const auto page = hub.open();
  EXPECT_THAT(take(*page, kSecond), Not(Contains(Key("atlas")))) << "there is none";
  hub.set_atlas(R"({"type":"atlas","robots":[]})");
  EXPECT_THAT(take(*page, kSecond), Contains(Key("atlas")));
  hub.set_atlas(R"({"type":"atlas","robots":[]})");
  EXPECT_THAT(take(*page, kSecond), Not(Contains(Key("atlas")))) << "it is the same";
  const auto late = hub.open();
  EXPECT_THAT(take(*late, kSecond), Contains(Key("atlas")));
}

TEST_F(PageSessionTest, a_page_gets_the_depth_when_it_asks_for_it_and_shows_images) {
  RobotMirror& robot = *hub.robot("");
  robot.add(msg::CompressedImage{.data = {1, 2, 3}});
  robot.add_depth({.data = {4, 5, 6}});
  const auto page = hub.open();
  EXPECT_FALSE(hub.options(0)->depth);
  EXPECT_THAT(take(*page, kSecond), Not(Contains(::testing::Key("binary 17"))));
  page->on_text(R"({"op":"options","depth":true})");
  EXPECT_TRUE(hub.options(0)->depth);
  EXPECT_THAT(take(*page, 2 * kSecond), Contains(::testing::Key("binary 17")));
  page->on_text(R"({"op":"options","image":false})");
  EXPECT_FALSE(hub.options(0)->depth) << "its panel is closed";
}

TEST_F(PageSessionTest, a_page_is_ready_once_it_says_so_and_until_it_is_closed) {
  auto page = hub.open();
  const auto other = hub.open();
  EXPECT_EQ(hub.ready(), 0U) << "connected, but it loads";
  page->on_text(R"({"op":"options","ready":false})");
  EXPECT_EQ(hub.ready(), 0U);
  page->on_text(R"({"op":"options","ready":true})");
  EXPECT_EQ(hub.ready(), 1U);
  page->on_text(R"({"op":"options","image":false})");
  EXPECT_EQ(hub.ready(), 1U);
  page.reset();
  EXPECT_EQ(hub.ready(), 0U);
}

TEST_F(PageSessionTest, a_closed_loop_sends_poses_and_no_points) {
  RobotMirror& robot = *hub.robot("");
  robot.map().add(map_of(100, 200));
  const auto page = hub.open();
  take(*page, kSecond);
  msg::MapUpdate moved = map_of(100, 0, 0.3);
  for (msg::MapKeyframe& keyframe : moved.keyframes) keyframe.content = 0;
  moved.loop_edges = {3, 99};
  robot.map().add(moved);
  const auto sent = take(*page, 2 * kSecond);
  std::size_t bytes = 0;
  for (const auto& [kind, size] : sent) bytes += kind == "link" ? 0 : size;
  EXPECT_THAT(sent, Not(Contains(testing::Key("binary 3"))));
  EXPECT_TRUE(sent.contains("binary 5"));
  EXPECT_LT(bytes, 5000U) << "kilobytes, not megabytes";
}

TEST_F(PageSessionTest, a_new_map_is_announced_before_its_content) {
  RobotMirror& robot = *hub.robot("");
  robot.map().add(map_of(3, 1));
  const auto page = hub.open();
  take(*page, kSecond);
  robot.map().reset();
  robot.map().add(map_of(2, 1));
  std::vector<std::string> names;
  while (auto frame = page->next(kSecond + 1)) names.push_back(name_of(*frame));
  EXPECT_EQ(names.front(), "map_reset");
  EXPECT_THAT(names, Contains("binary 1"));
}

TEST_F(PageSessionTest, a_page_gets_no_more_than_its_rate) {
  RobotMirror& robot = *hub.robot("");
  const auto page = hub.open();
  std::size_t bytes = 0;
  msg::CompressedImage image{.format = "jpeg", .data = std::vector<std::uint8_t>(90'000)};
  std::map<std::string, int> counts;
  for (int frame = 0; frame < 30 * 20; ++frame) {
    const std::int64_t now = kSecond + frame * kSecond / 30;
    image.header.stamp = {static_cast<std::int32_t>(now / kSecond), static_cast<std::uint32_t>(now % kSecond)};
    robot.add(image);
    msg::TrackingResult result{};
    result.seq = static_cast<std::uint64_t>(frame);
    robot.add(result, 0);
    while (auto sent = page->next(now)) {
      bytes += sent->size();
      ++counts[name_of(*sent)];
    }
  }
  EXPECT_LT(bytes, 20U * 800'000);
  EXPECT_GT(counts["binary 8"], 20 * 6) << "images";
  EXPECT_GT(counts["tracking"], 20 * 28) << "poses are not held up by images";
}

TEST_F(PageSessionTest, the_first_picture_of_the_largest_map_takes_three_megabytes) {
  RobotMirror& robot = *hub.robot("");
  robot.map().add(map_of(2000, 500));
  robot.add(CloudKind::kStatic, cloud_of(200'000));
  robot.add(msg::CompressedImage{.data = std::vector<std::uint8_t>(100'000)});
  for (int i = 0; i < 1800; ++i) robot.map().add_position(result_at(0.001 * i));
  const auto page = hub.open();
  page->on_text(R"({"op":"options","dense":true})");
  std::map<std::string, std::size_t> bytes;
  for (std::int64_t now = kSecond; now < 6 * kSecond; now += kSecond / 100)
    for (const auto& [kind, more] : take(*page, now)) bytes[kind] += more;
  std::size_t all = 0;
  for (const auto& [kind, some] : bytes) all += some;
  EXPECT_GT(bytes["binary 3"], 8U * 190'000) << "landmarks";
  EXPECT_GT(bytes["binary 12"], 9U * 119'000) << "the room";
  EXPECT_LT(all, 3'000'000U);
}

TEST_F(PageSessionTest, a_large_map_is_thinned_out) {
  PageHub small({}, {.bytes_per_s = 1e9, .burst_bytes = 1e9, .most_points = 1000}, {.now_ms = [] { return 0.0; }});
  small.robot("")->map().add(map_of(20, 200));
  const auto page = small.open();
  const auto sent = take(*page, kSecond);
  EXPECT_LT(sent.at("binary 3"), 20U * (12 + 8 * 51) + 8);
}

TEST_F(PageSessionTest, ten_thousand_keyframes_arrive_within_five_seconds) {
  RobotMirror& robot = *hub.robot("");
  robot.map().add(map_of(10'000, 100));
  const auto page = hub.open();
  std::size_t keyframes = 0, points = 0;
  for (std::int64_t now = kSecond; now < 6 * kSecond; now += kSecond / 100)
    for (const auto& [kind, bytes] : take(*page, now)) {
      if (kind == "binary 1") keyframes += bytes / 32;
      if (kind == "binary 3") points += bytes / 8;
    }
  EXPECT_GE(keyframes, 10'000U);
  EXPECT_GE(points, 200'000U);
}

TEST_F(PageSessionTest, hidden_panels_cost_nothing) {
  const auto page = hub.open();
  EXPECT_EQ(hub.options(0), (PageOptions{true, true, true, true, false, true}));
  page->on_text(R"({"op":"options","image":false,"mask":false,"features":false})");
  EXPECT_EQ(hub.options(0), (PageOptions{false, false, false, true, false, false}));
  const auto other = hub.open();
  EXPECT_TRUE(hub.options(0)->image) << "another page wants it";
}

TEST_F(PageSessionTest, images_are_those_of_the_robot_that_is_looked_at) {
  RobotMirror *anna = hub.robot("anna"), *bert = hub.robot("bert");
  const auto page = hub.open();
  page->on_text(R"({"op":"options","robot":1})");
  EXPECT_FALSE(hub.options(0)->image || hub.options(0)->mask || hub.options(0)->features || hub.options(0)->people);
  EXPECT_TRUE(hub.options(0)->points) << "maps of all robots are drawn";
  EXPECT_TRUE(hub.options(1)->image);
  msg::CompressedImage image{.format = "jpeg", .data = {1, 2, 3}};
  image.header.stamp.sec = 1;
  for (RobotMirror* robot : {anna, bert}) robot->add(image);
  std::vector<int> robots;
  while (auto frame = page->next(kSecond))
    if (name_of(*frame) == "binary 8") robots.push_back(std::to_integer<int>(frame->payload->at(1)));
  EXPECT_THAT(robots, ElementsAre(1));
  const auto other = hub.open();
  EXPECT_TRUE(hub.options(0)->image) << "another page shows all";
}

TEST_F(PageSessionTest, an_overlay_that_comes_after_its_image_is_sent_then) {
  RobotMirror* robot = hub.robot("");
  const auto page = hub.open();
  msg::CompressedImage image{.format = "jpeg", .data = {1, 2, 3}};
  image.header.stamp.sec = 1;
  robot->add(image);
  take(*page, kSecond);
  const auto frame = std::make_unique<msg::FeatureFrame>();
  frame->stamp_ns = kSecond;
  robot->add(*frame);
  auto sent = take(*page, 2 * kSecond);
  EXPECT_TRUE(sent.contains("binary 9"));
  EXPECT_FALSE(sent.contains("binary 8")) << "the page has the image";
  msg::Image mask{.header = image.header, .height = 1, .width = 2, .encoding = "mono8", .step = 2, .data = {0, 255}};
  robot->add(mask);
  sent = take(*page, 3 * kSecond);
  EXPECT_TRUE(sent.contains("binary 11"));
  EXPECT_FALSE(sent.contains("binary 9"));
  EXPECT_FALSE(take(*page, 4 * kSecond).contains("binary 11")) << "once";
}

TEST_F(PageSessionTest, robots_share_the_budget_fairly) {
  RobotMirror* robots[] = {hub.robot("anna"), hub.robot("bert"), hub.robot("carl")};
  const auto page = hub.open();
  msg::CompressedImage image{.format = "jpeg", .data = std::vector<std::uint8_t>(90'000)};
  std::map<int, int> images;
  for (int frame = 0; frame < 30 * 20; ++frame) {
    const std::int64_t now = kSecond + frame * kSecond / 30;
    image.header.stamp = {static_cast<std::int32_t>(now / kSecond), static_cast<std::uint32_t>(now % kSecond)};
    for (RobotMirror* robot : robots) robot->add(image);
    while (auto sent = page->next(now))
      if (name_of(*sent) == "binary 8") ++images[std::to_integer<int>(sent->payload->at(1))];
  }
  const int all = images[0] + images[1] + images[2];
  for (int robot = 0; robot < 3; ++robot) EXPECT_GT(images[robot], all / 4) << "robot " << robot << " of " << all;
}

TEST_F(PageSessionTest, buttons_call_commands_and_get_their_answer) {
  hub.robot("anna");
  auto page = hub.open();
  take(*page, kSecond);
  page->on_text(R"({"op":"call","id":4,"robot":0,"name":"/slam/reset","argument":""})");
  EXPECT_THAT(calls, ElementsAre("anna/slam/reset()"));
  answers[0]({true, "done"});
  EXPECT_TRUE(take(*page, kSecond + 1).contains("answer"));
  page->on_text(R"({"op":"call","id":5,"robot":9,"name":"/slam/reset"})");
  EXPECT_TRUE(take(*page, kSecond + 2).contains("answer")) << "an unknown robot";
  page->on_text(R"({"op":"call","id":6,"robot":0,"name":"/slam/reset"})");
  page.reset();
  answers[1]({true, "too late"});  // must not touch the page
}

TEST_F(PageSessionTest, nonsense_is_ignored) {
  const auto page = hub.open();
  take(*page, kSecond);
  for (const char* text : {"", "{", "[]", "7", R"({"op":7})", R"({"op":"options","image":"yes"})", R"({"op":"ping"})",
                           R"({"op":"call","id":-1,"name":[]})"})
    page->on_text(text);
  page->on_binary({});
  EXPECT_FALSE(page->overflowed());
  EXPECT_TRUE(hub.options(0)->image);
}

}  // namespace
}  // namespace rtd::viewer
