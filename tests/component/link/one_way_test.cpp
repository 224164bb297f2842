// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/link/one_way.hpp"

#include <gmock/gmock.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "tests/support/eventually.hpp"
#include "tests/support/inbox.hpp"
#include "tests/support/test_domain.hpp"

namespace rtd::link {
namespace {

using test_support::eventually;
using namespace std::chrono_literals;
using ::testing::Each;

/// Two domains, a link between them, and a program in each. The vendors of the domains.
class OneWayTest : public ::testing::TestWithParam<std::pair<const char*, const char*>> {
 protected:
  OneWayTest()
      : robot_(connect(GetParam().first, domain())),
        fleet_(connect(GetParam().second, domain() + 1)),
        robot_side_(connect(GetParam().first, domain())),
        fleet_side_(connect(GetParam().second, domain() + 1)) {
    start(default_rules());
  }
  ~OneWayTest() override {
    ended_ = true;
    ticker_.join();
  }

  static std::uint32_t domain() { return test_domain(); }
  static std::shared_ptr<bus::RawBus> connect(const std::string& vendor, std::uint32_t domain) {
    bus::BusOptions options;
    options.vendor = vendor;
    options.domain = domain;
    return bus::connect_raw(options);
  }
  void start(const std::vector<std::string>& rules) {
    rules_.emplace("anna", rules);
    out_.emplace(*robot_side_, *fleet_side_, *rules_, Direction::kToFleet);
    in_.emplace(*fleet_side_, *robot_side_, *rules_, Direction::kToRobot);
    ticker_ = std::thread([this] {
      for (; !ended_; std::this_thread::sleep_for(20ms)) {
        out_->tick();
        in_->tick();
      }
    });
  }
  static std::vector<std::byte> bytes(std::size_t size, int number) {
    std::vector<std::byte> cdr(size, static_cast<std::byte>(number % 251));
    cdr[0] = cdr[2] = cdr[3] = std::byte{0};
    cdr[1] = std::byte{1};
    return cdr;
  }
  using Samples = test_support::Inbox<bus::RawSample>;
  static std::unique_ptr<bus::RawReader> read(bus::RawBus& bus, const bus::RawTopic& topic, const Samples& samples,
                                              const bus::RawReaderOptions& options = {}) {
    bus::RawHandlers handlers;
    handlers.on_sample = [samples](bus::RawSample sample) {
      samples.take(std::make_shared<const bus::RawSample>(std::move(sample)));
    };
    return bus.reader(topic, options, std::move(handlers));
  }

  static inline const bus::RawTopic kJpegs{"rt/anna/camera/color/image_raw/compressed",
                                           "sensor_msgs::msg::dds_::CompressedImage_"},
      kBoxes{"rt/anna/detector/detections", "vision_msgs::msg::dds_::Detection2DArray_"},
      kInfo{"rt/anna/camera/color/camera_info", "sensor_msgs::msg::dds_::CameraInfo_"};
  std::shared_ptr<bus::RawBus> robot_, fleet_, robot_side_, fleet_side_;
  std::optional<LinkRules> rules_;
  std::optional<OneWay> out_, in_;
  std::atomic<bool> ended_{false};
  std::thread ticker_;
};

TEST_P(OneWayTest, passes_bytes_and_times_both_ways) {
  const Samples jpegs, boxes;
  const auto jpeg_writer = robot_->writer(kJpegs, {}), box_writer = fleet_->writer(kBoxes, {});
  const auto jpeg_reader = read(*fleet_, kJpegs, jpegs), box_reader = read(*robot_, kBoxes, boxes);
  ASSERT_TRUE(eventually([&] { return jpeg_writer->matched() > 0 && jpeg_reader->matched() > 0; }));
  ASSERT_TRUE(eventually([&] { return box_writer->matched() > 0 && box_reader->matched() > 0; }));
  std::this_thread::sleep_for(300ms);  // the other sides match too
  constexpr int kCount = 50;
  for (int i = 0; i < kCount; ++i) {
    jpeg_writer->write(bytes(60'000, i), 1'700'000'000'000'000'000 + i * 1000);
    box_writer->write(bytes(400, i + 100), 1'700'000'000'000'000'000 + i * 2000);
    std::this_thread::sleep_for(5ms);
  }
  ASSERT_TRUE(jpegs.wait_count(kCount));
  ASSERT_TRUE(boxes.wait_count(kCount));
  for (int i = 0; i < kCount; ++i) {
    const auto jpeg = jpegs.at(static_cast<std::size_t>(i)), box = boxes.at(static_cast<std::size_t>(i));
    EXPECT_TRUE(std::ranges::equal(jpeg->cdr(), bytes(60'000, i))) << i;
    EXPECT_TRUE(std::ranges::equal(box->cdr(), bytes(400, i + 100))) << i;
    EXPECT_NEAR(static_cast<double>(jpeg->source_ns - 1'700'000'000'000'000'000), i * 1000.0, 2.0);
  }
}

TEST_P(OneWayTest, reads_an_image_topic_only_while_the_other_side_does) {
  const auto camera = robot_->writer(kJpegs, {});
  std::this_thread::sleep_for(500ms);
  EXPECT_EQ(camera->matched(), 0) << "the camera need not encode";
  {
    const auto reader = read(*fleet_, kJpegs, {});
    EXPECT_TRUE(eventually([&] { return camera->matched() > 0; }));
  }
  EXPECT_TRUE(eventually([&] { return camera->matched() == 0; }));
}

TEST_P(OneWayTest, late_readers_get_what_is_latched) {
  bus::RawWriterOptions latched;
  latched.qos.durability = bus::RawQos::Durability::kTransientLocal;
  latched.qos.depth = 1;
  const auto writer = robot_->writer(kInfo, latched);
  writer->write(bytes(400, 7));
  std::this_thread::sleep_for(500ms);
  const Samples infos;
  const auto reader = read(*fleet_, kInfo, infos, {.transient_local = true});
  ASSERT_TRUE(infos.wait_count(1));
  EXPECT_TRUE(std::ranges::equal(infos.at(0)->cdr(), bytes(400, 7)));
}

/// The only topic that passes in both directions.
TEST_P(OneWayTest, heartbeats_do_not_come_back) {
  const bus::RawTopic status{"rtd/anna/status", "rtd_msgs::msg::dds_::ServiceStatus_"};
  // A string "link" and then zeros: a heartbeat that passes in both directions.
  std::vector<std::byte> heartbeat(80, std::byte{0});
  heartbeat[1] = std::byte{1};
  heartbeat[4] = std::byte{5};
  std::ranges::transform(std::string_view("link"), heartbeat.begin() + 8, [](char c) { return std::byte(c); });
  const Samples at_robot, at_fleet;
  const auto robot_reader = read(*robot_, status, at_robot), fleet_reader = read(*fleet_, status, at_fleet);
  const auto robot_writer = robot_->writer(status, {}), fleet_writer = fleet_->writer(status, {});
  ASSERT_TRUE(eventually([&] { return robot_writer->matched() > 1 && fleet_writer->matched() > 1; }));
  std::this_thread::sleep_for(500ms);
  constexpr std::size_t kCount = 200;
  for (std::size_t i = 0; i < kCount; ++i) {
    robot_writer->write(heartbeat);
    fleet_writer->write(heartbeat);
    std::this_thread::sleep_for(2ms);
  }
  EXPECT_TRUE(at_robot.wait_count(2 * kCount));
  EXPECT_TRUE(at_fleet.wait_count(2 * kCount));
  std::this_thread::sleep_for(500ms);
  EXPECT_EQ(at_robot.all().size(), 2 * kCount) << "its own and those of the fleet, once";
  EXPECT_EQ(at_fleet.all().size(), 2 * kCount);
}

TEST_P(OneWayTest, nothing_else_passes) {
  const bus::RawTopic keyframes{"rtd/anna/keyframes", "rtd_msgs::msg::dds_::KeyframeEvent_"},
      other{"rt/bert/slam/pose", "geometry_msgs::msg::dds_::PoseStamped_"}, mine{"rt/anna/slam/pose", other.type};
  const auto a = robot_->writer(keyframes, {}), b = robot_->writer(other, {}), c = robot_->writer(mine, {});
  const auto topics_of = [&] {
    std::vector<std::string> names;
    for (const bus::TopicWriter& writer : fleet_->writers()) names.push_back(writer.topic.name);
    return names;
  };
  EXPECT_TRUE(eventually([&] { return std::ranges::count(topics_of(), mine.name) == 1; }));
  std::this_thread::sleep_for(300ms);
  EXPECT_THAT(topics_of(), Each(testing::AnyOf("rt/anna/slam/pose", "ros_discovery_info")))
      << "each connection announces itself as a node";
}

TEST_P(OneWayTest, a_topic_goes_with_its_last_writer) {
  auto writer = robot_->writer(kJpegs, {});
  const auto there = [&] {
    return std::ranges::count(fleet_->writers(), kJpegs.name, [](const auto& w) { return w.topic.name; }) > 0;
  };
  EXPECT_TRUE(eventually(there));
  writer.reset();
  EXPECT_TRUE(eventually([&] { return !there(); }));
  writer = robot_->writer(kJpegs, {});
  EXPECT_TRUE(eventually(there)) << "and comes back";
}

std::vector<std::pair<const char*, const char*>> vendors() {
  std::vector<std::pair<const char*, const char*>> pairs;
  const std::vector<std::string> there = bus::dds_vendors();
  const auto has = [&](const char* name) { return std::ranges::count(there, name) > 0; };
  if (has("fastdds")) pairs.emplace_back("fastdds", "fastdds");
  if (has("cyclonedds")) pairs.emplace_back("cyclonedds", "cyclonedds");
  if (pairs.size() == 2) pairs.emplace_back("fastdds", "cyclonedds");
  return pairs;
}

INSTANTIATE_TEST_SUITE_P(Vendors, OneWayTest, ::testing::ValuesIn(vendors()),
                         [](const auto& pair) { return std::string(pair.param.first) + "_" + pair.param.second; });

}  // namespace
}  // namespace rtd::link
