// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/recorder/recorder_service.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <thread>

#include "common/bus/commands.hpp"
#include "common/bus/raw_bus.hpp"
#include "common/ros2/schema_texts.hpp"
#include "common/service/config.hpp"
#include "tests/component/recorder/recorded_file.hpp"
#include "tests/support/people_messages.hpp"
#include "tests/support/service_fixture.hpp"

namespace rtd::recorder {
namespace {

using namespace std::chrono_literals;
using ::testing::AllOf;
using ::testing::HasSubstr;

std::vector<std::byte> cdr(std::uint8_t content, std::size_t size = 32) {
  std::vector<std::byte> bytes(size, std::byte{content});
  bytes[0] = bytes[2] = bytes[3] = std::byte{0};
  bytes[1] = std::byte{1};
  return bytes;
}

class RecorderTest : public test_support::ServiceFixture<RecorderService> {
 protected:
  RecorderTest() : raw_(bus::connect_raw(bus_options_)) {
    std::filesystem::create_directories(folder_);
    config_.output = folder_ / "run.mcap";
  }
  std::unique_ptr<bus::RawWriter> writer(const std::string& topic, const std::string& type, bus::RawQos qos = {}) {
    return raw_->writer({topic, type}, {qos});
  }
  /// As a replay has it.
  std::unique_ptr<bus::RawWriter> schemas_writer() {
    bus::RawQos latched;
    latched.durability = bus::RawQos::Durability::kTransientLocal;
    return writer(ros2::kSchemasTopic, ros2::kSchemasType, latched);
  }
  static void wait_matched(const bus::RawWriter& writer, int readers = 1) {
    for (int i = 0; i < 5000 && writer.matched() < readers; ++i) std::this_thread::sleep_for(1ms);
    ASSERT_EQ(writer.matched(), readers);
  }

  const std::shared_ptr<bus::RawBus> raw_;
};

TEST_F(RecorderTest, commands_end_a_recording_and_begin_another) {
  start(service::Pace::kRealtime);
  const auto pose = writer("rt/slam/pose", "geometry_msgs::msg::dds_::PoseStamped_");
  wait_matched(*pose);
  for (std::uint8_t i = 0; i < 5; ++i) pose->write(cdr(i));
  ASSERT_TRUE(wait_metric("messages", 5));
  EXPECT_TRUE(wait_metric("recording", 1));
  bus::CommandClient client(bus_options_);
  const bus::CommandAnswer busy = client.call("recorder/start", "", 10'000);
  EXPECT_FALSE(busy.success);
  EXPECT_THAT(busy.message, HasSubstr("already recording to " + config_.output));
  const bus::CommandAnswer stopped = client.call("recorder/stop", "", 10'000);
  EXPECT_TRUE(stopped.success);
  EXPECT_THAT(stopped.message, AllOf(HasSubstr("recorded 5 messages, none lost"), HasSubstr(config_.output)));
  EXPECT_TRUE(wait_state(msg::ServiceState::kReady, "not recording"));
  EXPECT_TRUE(wait_metric("recording", 0));
  EXPECT_FALSE(client.call("recorder/stop", "", 10'000).success);
  pose->write(cdr(99));  // it is not recorded

  EXPECT_FALSE(client.call("recorder/start", "run", 10'000).success) << "it exists";
  const std::string second = folder_ / "second.mcap";
  const bus::CommandAnswer started = client.call("recorder/start", "second", 10'000);
  EXPECT_TRUE(started.success) << started.message;
  EXPECT_EQ(started.message, "recording to " + second);
  wait_matched(*pose);
  pose->write(cdr(7));
  ASSERT_TRUE(wait_metric("messages", 1));
  EXPECT_EQ(stop(), service::kOk);
  EXPECT_EQ(read_recording(config_.output).topics.at("/slam/pose").size(), 5U);
  const RecordedFile again = read_recording(second);
  ASSERT_EQ(again.topics.at("/slam/pose").size(), 1U);
  EXPECT_EQ(again.topics.at("/slam/pose")[0].cdr, cdr(7));
  EXPECT_EQ(again.topics.size(), 1U) << "no commands";
}

std::vector<std::byte> as_bytes(const std::vector<std::uint8_t>& cdr) {
  const auto bytes = std::as_bytes(std::span(cdr));
  return {bytes.begin(), bytes.end()};
}

TEST_F(RecorderTest, people_are_pixelated_where_they_are_known_to_be_and_everything_elsewhere) {
  config_.blur_people = true;
  const cv::Mat room = test_support::room_with_person();
  const auto frame = writer("rtd/frame", "rtd_msgs::msg::dds_::RgbdFrame_");
  const auto detections = writer("rt/detector/detections", "vision_msgs::msg::dds_::Detection2DArray_");
  start(service::Pace::kRealtime);
  wait_matched(*frame);
  wait_matched(*detections);
  const auto write_frame = [&](std::int64_t stamp_ns) {
    frame->write(as_bytes(test_support::frame_cdr(stamp_ns, room)));
  };
  const auto detect = [&](std::int64_t stamp_ns) {
    detections->write(as_bytes(test_support::cdr_of(test_support::detections(stamp_ns, {test_support::kPerson}))));
  };
  write_frame(1'000'000'000);
  detect(1'000'000'000);
  detect(1'300'000'000);
  write_frame(9'000'000'000);
  ASSERT_TRUE(wait_metric("messages", 3)) << "nothing more can come for the first frame";
  EXPECT_EQ(stop(), service::kOk);
  const RecordedFile recorded = read_recording(config_.output);
  const auto colors = [&](std::size_t i) {
    const std::vector<std::byte>& cdr = recorded.topics.at("rtd/frame").at(i).cdr;
    const auto* const bytes = reinterpret_cast<const std::uint8_t*>(cdr.data());
    return test_support::colors_of({bytes, bytes + cdr.size()});
  };
  EXPECT_LT(test_support::likeness(room, colors(0)), 0.5);
  EXPECT_LT(test_support::likeness(room, colors(1)), 0.5);
  const cv::Rect wall(220, 0, 100, 240);
  EXPECT_EQ(cv::norm(colors(0)(wall), room(wall), cv::NORM_INF), 0);
  EXPECT_GT(cv::norm(colors(1)(wall), room(wall), cv::NORM_INF), 0) << "nothing was known";
  const io::FileSource source(config_.output);
  mcap::IndexedReader reader(source);
  for (const mcap::MetadataIndex& index : reader.summary().metadata_indexes) {
    if (index.name != "rtd:people") continue;
    const auto people = reader.metadata(index)->metadata;
    EXPECT_EQ(people.at("blurred"), "1");
    EXPECT_EQ(people.at("hidden"), "1");
    return;
  }
  ADD_FAILURE() << "the file does not say what was done";
}

TEST_F(RecorderTest, a_command_writes_only_recordings_and_only_in_their_folder) {
  config_.wait = config_.force = true;
  config_.folder = folder_ / "recordings";
  std::filesystem::create_directories(config_.folder);
  const auto put = [](const std::filesystem::path& file) { std::ofstream(file) << "mine"; };
  const auto is_mine = [](const std::filesystem::path& file) {
    std::string text;
    std::getline(std::ifstream(file), text);
    return text == "mine";
  };
  put(folder_ / ".profile");
  const std::filesystem::path recordings = config_.folder;
  put(recordings / "metadata.yaml");
  put(recordings / "notes.mcap");
  std::filesystem::create_symlink(folder_ / ".profile", recordings / "link.mcap");
  std::filesystem::create_symlink(folder_ / "made", recordings / "dangling.mcap");
  start(service::Pace::kRealtime);
  EXPECT_TRUE(wait_state(msg::ServiceState::kReady, "not recording"));
  bus::CommandClient client(bus_options_);
  const auto begin = [&](const std::string& name) { return client.call("recorder/start", name, 10'000); };
  for (const std::string& name : {(folder_ / "made").string(), (folder_ / "made.mcap").string(), std::string("../made"),
                                  std::string("sub/made"), std::string(".profile"), std::string("/etc/none/x")}) {
    const bus::CommandAnswer answer = begin(name);
    EXPECT_FALSE(answer.success) << name;
    EXPECT_THAT(answer.message, HasSubstr("this is not a name of a recording")) << name;
  }
  for (const char* name : {"notes", "link", "dangling"}) {
    const bus::CommandAnswer answer = begin(name);
    EXPECT_FALSE(answer.success) << name;
    EXPECT_THAT(answer.message, HasSubstr("exists and is not a recording")) << name;
  }
  const bus::CommandAnswer good = begin("run");
  EXPECT_EQ(good.message, "recording to " + (recordings / "run.mcap").string());
  EXPECT_TRUE(client.call("recorder/stop", "", 10'000).success);
  const bus::CommandAnswer unnamed = begin("");
  EXPECT_THAT(unnamed.message, HasSubstr("recording to " + folder_.string())) << "as configured";
  EXPECT_EQ(stop(), service::kOk);
  EXPECT_TRUE(is_mine(folder_ / ".profile") && is_mine(recordings / "notes.mcap"));
  EXPECT_TRUE(is_mine(recordings / "metadata.yaml")) << "it is not of rosbag2";
  EXPECT_FALSE(std::filesystem::exists(folder_ / "made") || std::filesystem::exists(folder_ / "made.mcap"));
}

TEST_F(RecorderTest, that_waits_writes_nothing_until_it_is_started) {
  config_.wait = true;
  start(service::Pace::kRealtime);
  EXPECT_TRUE(wait_state(msg::ServiceState::kReady, "not recording"));
  EXPECT_FALSE(std::filesystem::exists(config_.output));
  bus::CommandClient client(bus_options_);
  EXPECT_EQ(client.call("recorder/start", "", 10'000).message, "recording to " + config_.output);
  EXPECT_TRUE(std::filesystem::exists(config_.output));
}

TEST_F(RecorderTest, records_known_and_unknown_types_byte_by_byte) {
  start(service::Pace::kRealtime);
  const auto pose = writer("rt/slam/pose", "geometry_msgs::msg::dds_::PoseStamped_");
  const auto thing = writer("some/thing", "Thing");
  wait_matched(*pose);
  wait_matched(*thing);
  for (std::uint8_t i = 0; i < 20; ++i) {
    pose->write(cdr(i), 1000 + i);
    thing->write(cdr(i, 100'000), 2000 + i);
  }
  ASSERT_TRUE(wait_metric("acknowledged", 40));
  ASSERT_TRUE(wait_metric("acknowledged:/slam/pose", 20));
  EXPECT_EQ(stop(), service::kOk);

  const RecordedFile file = read_recording(config_.output);
  EXPECT_TRUE(file.has_summary);
  EXPECT_EQ(file.problems, 0U);
  ASSERT_EQ(file.topics.at("/slam/pose").size(), 20U);
  ASSERT_EQ(file.topics.at("some/thing").size(), 20U);
  EXPECT_EQ(file.type_of.at("/slam/pose"), "geometry_msgs/msg/PoseStamped");
  EXPECT_EQ(file.type_of.at("some/thing"), "Thing");
  for (std::uint8_t i = 0; i < 20; ++i) {
    const ReadMessage& message = file.topics.at("/slam/pose")[i];
    EXPECT_EQ(message.cdr, cdr(i));
    EXPECT_EQ(message.publish_time, 1000U + i);
    EXPECT_EQ(message.sequence, i + 1U);
    EXPECT_EQ(file.topics.at("some/thing")[i].cdr, cdr(i, 100'000));
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "metadata.yaml")) << "one file needs none";
}

TEST_F(RecorderTest, keeps_the_text_of_a_type_that_a_replay_publishes) {
  start(service::Pace::kRealtime);
  const auto schemas = schemas_writer();
  const auto laser = writer("rt/laser", "vendor_msgs::msg::dds_::Laser_");
  std::this_thread::sleep_for(50ms);
  EXPECT_EQ(laser->matched(), 0) << "it waits for the text";
  schemas->write(ros2::encode_schemas(
      {{"vendor_msgs::msg::dds_::Laser_", {"vendor_msgs/msg/Laser", "ros2msg", "float32 range\n"}},
       {"geometry_msgs::msg::dds_::PoseStamped_", {"geometry_msgs/msg/PoseStamped", "ros2msg", "not this"}}}));
  wait_matched(*laser);
  laser->write(cdr(1));
  const auto pose = writer("rt/slam/pose", "geometry_msgs::msg::dds_::PoseStamped_");
  wait_matched(*pose);
  pose->write(cdr(2));
  ASSERT_TRUE(wait_metric("acknowledged", 2));
  EXPECT_EQ(stop(), service::kOk);

  const io::FileSource source(config_.output);
  const mcap::IndexedReader reader(source);
  std::map<std::string, mcap::Schema> schema_of;
  for (const auto& [id, channel] : reader.summary().channels)
    schema_of[channel.topic] = reader.summary().schemas.at(channel.schema_id);
  EXPECT_EQ(schema_of.size(), 2U) << "the texts themselves are not recorded";
  EXPECT_EQ(schema_of["/laser"].name, "vendor_msgs/msg/Laser");
  EXPECT_EQ(schema_of["/laser"].encoding, "ros2msg");
  EXPECT_EQ(schema_of["/laser"].data, "float32 range\n");
  EXPECT_NE(schema_of["/slam/pose"].data, "not this") << "built in";
}

TEST_F(RecorderTest, waits_for_texts_for_a_while_only) {
  start(service::Pace::kRealtime);
  const auto silent = schemas_writer();
  const auto laser = writer("rt/laser", "vendor_msgs::msg::dds_::Laser_");
  wait_matched(*laser);
  EXPECT_EQ(stop(), service::kOk);
}

TEST_F(RecorderTest, records_only_what_matches_and_says_that_it_waits) {
  config_.topics = {"/slam/*"};
  launch(service::Pace::kRealtime);
  ASSERT_TRUE(wait_state(msg::ServiceState::kReady, "no topic matches yet"));
  const auto other = writer("rt/tf", "tf2_msgs::msg::dds_::TFMessage_");
  const auto pose = writer("rt/slam/pose", "geometry_msgs::msg::dds_::PoseStamped_");
  wait_matched(*pose);
  EXPECT_EQ(other->matched(), 0);
  pose->write(cdr(1));
  ASSERT_TRUE(wait_state(msg::ServiceState::kRunning));
}

TEST_F(RecorderTest, a_latched_message_from_before_is_recorded) {
  bus::RawQos latched;
  latched.durability = bus::RawQos::Durability::kTransientLocal;
  latched.depth = 1;
  const auto info = writer("rt/camera_info", "sensor_msgs::msg::dds_::CameraInfo_", latched);
  info->write(cdr(9));
  launch(service::Pace::kRealtime);
  ASSERT_TRUE(wait_metric("acknowledged:/camera_info", 1));
}

TEST_F(RecorderTest, writers_that_offer_different_things_are_each_recorded_once) {
  start(service::Pace::kRealtime);
  bus::RawQos modest;
  modest.reliable = false;
  const auto reliable = writer("rt/imu", "Imu");
  const auto best_effort = writer("rt/imu", "Imu", modest);
  wait_matched(*reliable, 2);
  wait_matched(*best_effort);
  for (std::uint8_t i = 0; i < 10; ++i) {
    reliable->write(cdr(i));
    best_effort->write(cdr(100 + i));
  }
  ASSERT_TRUE(wait_metric("acknowledged:/imu", 20));
  EXPECT_EQ(stop(), service::kOk);
  EXPECT_EQ(read_recording(config_.output).topics.at("/imu").size(), 20U);
}

TEST_F(RecorderTest, what_has_no_room_is_counted_named_and_makes_the_exit_code_3) {
  config_.queue_mib = 1;
  start(service::Pace::kRealtime);
  const auto thing = writer("some/thing", "Thing");
  const auto pose = writer("rt/slam/pose", "Pose");
  wait_matched(*thing);
  wait_matched(*pose);
  thing->write(cdr(1, 2'000'000));  // never fits
  pose->write(cdr(2));
  ASSERT_TRUE(wait_metric("lost_in_queue", 1));
  ASSERT_TRUE(wait_state(msg::ServiceState::kDegraded, "1 messages lost"));
  EXPECT_EQ(stop(), service::kPartialLoss);

  const RecordedFile file = read_recording(config_.output);
  EXPECT_TRUE(file.topics.at("some/thing").empty());
  EXPECT_EQ(file.topics.at("/slam/pose").size(), 1U);
  const io::FileSource source(config_.output);
  mcap::IndexedReader reader(source);
  ASSERT_EQ(reader.summary().metadata_indexes.size(), 1U);
  const auto losses = reader.metadata(reader.summary().metadata_indexes[0]);
  EXPECT_EQ(losses->metadata.at("some/thing"), "in_transit=0 in_queue=1");
}

TEST_F(RecorderTest, an_earlier_recording_is_replaced_only_by_force) {
  { std::ofstream(config_.output) << "earlier"; }
  launch(service::Pace::kRealtime);
  EXPECT_THROW(stop(), service::ConfigError);
  EXPECT_EQ(std::filesystem::file_size(config_.output), 7U);
}

TEST_F(RecorderTest, refuses_a_file_that_another_recorder_writes) {
  config_.force = true;
  const io::FileSink other(config_.output);
  launch(service::Pace::kRealtime);
  EXPECT_THROW(stop(), service::ConfigError);
}

TEST_F(RecorderTest, refuses_a_folder_that_it_cannot_make_and_a_split_that_is_none) {
  { std::ofstream(folder_ / "file") << ""; }
  config_.output = folder_ / "file" / "run";
  launch(service::Pace::kRealtime);
  EXPECT_THROW(stop(), service::ConfigError);
  config_.output = folder_ / "run.mcap";
  config_.split = "often";
  launch(service::Pace::kRealtime);
  EXPECT_THROW(stop(), service::ConfigError);
}

TEST_F(RecorderTest, ends_in_good_order_before_the_disk_is_full) {
  config_.min_free_mib = 1'000'000;  // more than there is
  launch(service::Pace::kRealtime);
  EXPECT_EQ(running_code(), service::kPartialLoss);
  EXPECT_TRUE(read_recording(config_.output).has_summary);
}

}  // namespace
}  // namespace rtd::recorder
