// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <sqlite3.h>

#include "common/mcap/recording_file.hpp"
#include "services/recorder/inspect/inspect_commands.hpp"
#include "services/recorder/inspect/recording_report.hpp"
#include "tests/unit/camera/image_bag.hpp"
#include "tests/unit/recorder/inspect/sample_recording.hpp"

namespace rtd::recordings {
namespace {

using testing::HasSubstr;
using ::testing::SizeIs;

constexpr mcap::WriterOptions small_chunks(mcap::Compression compression = mcap::Compression::kNone) {
  mcap::WriterOptions options;
  options.compression = compression;
  options.chunk_size = 300;
  return options;
}

/// 20 poses with number 8 and 9 lost, and one frame.
std::vector<SampleMessage> messages_with_a_gap() {
  std::vector<SampleMessage> messages = regular_messages("/pose", 20);
  messages.erase(messages.begin() + 7, messages.begin() + 9);
  messages.push_back({"/frame", 1'500'000'000, std::string(400, 'f')});
  return messages;
}

const ChannelReport& channel(const RecordingReport& report, const char* topic) {
  for (const ChannelReport& entry : report.channels)
    if (entry.channel.topic == topic) return entry;
  throw std::runtime_error(std::string("no ") + topic);
}

RecordingReport report_of(const io::Bytes& file, const ReportOptions& options = {}) {
  return report_on(io::MemorySource(file), options);
}

void expect_the_gap(const RecordingReport& report) {
  EXPECT_EQ(report.messages, 19U);
  EXPECT_EQ(report.end_ns - report.start_ns, 500'000'000U);
  const ChannelReport& pose = channel(report, "/pose");
  EXPECT_EQ(pose.type, "test_msgs/msg/pose");
  EXPECT_EQ(pose.timing.messages, 18U);
  EXPECT_EQ(pose.timing.median_period_ns, 10'000'000U);
  EXPECT_EQ(pose.timing.largest_gap_ns, 30'000'000U);
  EXPECT_EQ(pose.timing.gaps, 1U);
  EXPECT_TRUE(report.has_summary);
  EXPECT_FALSE(report.damaged());
  ASSERT_EQ(report.metadata.size(), 1U);
  EXPECT_EQ(report.metadata[0].metadata.at("made_by"), "test");
}

TEST(RecordingReport, reports_all_of_a_small_file) {
  const RecordingReport report = report_of(recording_of(messages_with_a_gap(), small_chunks()));
  expect_the_gap(report);
  EXPECT_TRUE(report.read_all);
  EXPECT_EQ(channel(report, "/pose").sequences->missing(), 2U);
  EXPECT_EQ(channel(report, "/frame").payload_bytes, 400U);
  EXPECT_GT(report.chunks.at("").chunks, 2U);
}

TEST(RecordingReport, reports_the_same_of_a_big_file_from_its_summary_and_indexes) {
  ReportOptions big;
  big.small_file_bytes = 0;
  const RecordingReport report =
      report_of(recording_of(messages_with_a_gap(), small_chunks(mcap::Compression::kZstd)), big);
  expect_the_gap(report);
  EXPECT_FALSE(report.read_all);
  EXPECT_FALSE(channel(report, "/pose").sequences.has_value());
  EXPECT_GT(report.chunks.at("zstd").chunks, 2U);
}

TEST(RecordingReport, numbers_that_run_through_all_topics_are_no_loss_of_each) {
  std::vector<SampleMessage> messages;
  for (std::uint32_t i = 0; i < 30; ++i)
    messages.push_back({i % 3 == 0 ? "/pose" : "/frame", 1'000'000'000 + i * 10'000'000ULL, "x", i + 1});
  messages.erase(messages.begin() + 10);
  const RecordingReport report = report_of(recording_of(messages));
  EXPECT_EQ(report.missing_in_shared_counter, 1U);
  EXPECT_THAT(to_text(report, "x.mcap"), HasSubstr("lost: 1 of the sequence numbers that all topics share"));
  const nlohmann::json json = to_json(report, "x.mcap");
  EXPECT_EQ(json["shared_sequence"]["missing"], 1);
  EXPECT_TRUE(json["topics"][0]["sequence"].is_null());
}

TEST(RecordingReport, reads_everything_where_the_indexes_are_missing) {
  mcap::WriterOptions options = small_chunks();
  options.use_message_index = false;
  ReportOptions big;
  big.small_file_bytes = 0;
  EXPECT_TRUE(report_of(recording_of(messages_with_a_gap(), options), big).read_all);
}

TEST(RecordingReport, a_cut_file_gives_what_is_readable_and_what_is_wrong) {
  io::Bytes file = recording_of(messages_with_a_gap(), small_chunks());
  file.resize(file.size() / 2);
  const RecordingReport report = report_of(file);
  EXPECT_GT(report.messages, 0U);
  EXPECT_LT(report.messages, 19U);
  EXPECT_FALSE(report.has_summary);
  EXPECT_TRUE(report.damaged());
  EXPECT_THAT(to_text(report, "x.mcap"), HasSubstr("problem"));
}

TEST(RecordingReport, names_the_chunk_whose_checksum_is_wrong) {
  io::Bytes file = recording_of(messages_with_a_gap(), small_chunks());
  const std::string text(reinterpret_cast<const char*>(file.data()), file.size());
  file[text.find("/pose payload 3")] ^= std::byte{1};
  const RecordingReport report = report_of(file);
  EXPECT_TRUE(report.damaged());
  EXPECT_THAT(checksum_text(report), HasSubstr("WRONG"));
  EXPECT_THAT(to_text(report, "x.mcap"), HasSubstr("Chunk"));
}

TEST(RecordingReport, the_end_that_a_file_being_written_does_not_have_is_no_damage) {
  io::MemorySink sink;
  mcap::Writer writer(sink);
  const mcap::ChannelId id = writer.add(mcap::Channel{0, 0, "/pose", "cdr", {}});
  writer.write(mcap::Message{id, 1, 10, 10, io::bytes_of("abc")});
  writer.end_chunk();
  RecordingReport report = report_of(sink.bytes());
  EXPECT_TRUE(report.damaged());
  report.being_written = true;
  EXPECT_FALSE(report.damaged());
  EXPECT_EQ(report.messages, 1U);
  EXPECT_THAT(to_text(report, "x.mcap"), HasSubstr("being written"));
}

TEST(RecordingReport, reports_what_the_recorder_knows_to_be_lost) {
  RecordingReport report;
  EXPECT_TRUE(report.losses().empty());
  report.metadata.push_back({"rtd:losses", {{"total", "0"}}});
  EXPECT_THAT(to_text(report, "x.mcap"), HasSubstr("nothing, according to the recorder"));
  report.metadata[0].metadata = {{"/pose", "in_transit=3 in_queue=0"}, {"total", "3"}};
  EXPECT_THAT(to_text(report, "x.mcap"), HasSubstr("/pose: in_transit=3 in_queue=0"));
}

TEST(RecordingReport, json_has_what_the_text_has) {
  const nlohmann::json json = to_json(report_of(recording_of(messages_with_a_gap(), small_chunks())), "x.mcap");
  EXPECT_EQ(json["messages"], 19);
  EXPECT_EQ(json["topics"].size(), 2U);
  EXPECT_EQ(json["topics"][1]["topic"], "/pose");
  EXPECT_EQ(json["topics"][1]["sequence"]["missing"], 2);
  EXPECT_EQ(json["metadata"][0]["values"]["made_by"], "test");
  EXPECT_EQ(json["damaged"], false);
}

std::filesystem::path path_of(const std::string& uri) {
  return uri.substr(uri.find(':') + 1);
}

TEST(OtherFormatReport, counts_and_times_the_messages_of_a_bag) {
  camera::test::ImageBag bag;
  bag.add_info();
  for (const double second : {1.0, 2.0, 3.0}) {
    bag.add_color(second);
    bag.add_depth(second);
  }
  const std::string file = path_of(bag.uri());
  const auto report = report_on_other_format(file);
  ASSERT_TRUE(report);
  EXPECT_EQ(report->format, "ROS 1 bag");
  EXPECT_EQ(report->messages, 7U);
  ASSERT_THAT(report->channels, SizeIs(3));
  for (const ChannelReport& channel : report->channels) {
    if (channel.channel.topic == camera::test::ImageBag::kInfo) continue;
    EXPECT_EQ(channel.timing.messages, 3U) << channel.channel.topic;
    EXPECT_NEAR(channel.timing.rate_hz, 1, 1e-6) << channel.channel.topic;
    EXPECT_EQ(channel.type, "sensor_msgs/Image");
  }
  EXPECT_FALSE(report->damaged());
  const std::string text = to_text(*report, "a.bag");
  EXPECT_THAT(text, HasSubstr("ROS 1 bag"));
  EXPECT_THAT(text, HasSubstr("7 on 3 topics"));
  EXPECT_EQ(text.find("checksums"), std::string::npos) << "it has none";
  EXPECT_EQ(to_json(*report, "a.bag")["format"], "ROS 1 bag");
}

TEST(OtherFormatReport, shows_topics_of_a_database_that_have_no_message) {
  const rtd::test::TemporaryFile file("a.db3", "");
  std::filesystem::remove(file.path());
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(file.path().c_str(), &database), SQLITE_OK);
  constexpr char kContent[] =
      "CREATE TABLE topics(id INTEGER PRIMARY KEY,name,type,serialization_format,offered_qos_profiles);"
      "CREATE TABLE messages(id INTEGER PRIMARY KEY,topic_id,timestamp,data);"
      "INSERT INTO topics VALUES(1,'/imu','sensor_msgs/msg/Imu','cdr',''),(2,'/odom','nav_msgs/msg/Odometry','cdr','');"
      "INSERT INTO messages(topic_id,timestamp,data) VALUES(1,1000,x'00010000'),(1,2000,x'0001000007');";
  EXPECT_EQ(sqlite3_exec(database, kContent, nullptr, nullptr, nullptr), SQLITE_OK);
  sqlite3_close(database);
  const auto report = report_on_other_format(file.path());
  ASSERT_TRUE(report);
  ASSERT_THAT(report->channels, SizeIs(2));
  EXPECT_EQ(report->messages, 2U);
  EXPECT_EQ(report->channels[0].payload_bytes, 9U);
  EXPECT_EQ(report->channels[1].channel.topic, "/odom");
  EXPECT_EQ(report->channels[1].timing.messages, 0U);
  EXPECT_EQ(report->end_ns - report->start_ns, 1000U);
}

TEST(OtherFormatReport, is_for_files_of_other_programs_only) {
  const rtd::test::TemporaryFile text("a.txt", "hello"), broken("a.bag", "#ROSBAG V2.0\nxxx");
  EXPECT_FALSE(report_on_other_format(text.path()));
  EXPECT_FALSE(report_on_other_format("/nonexistent"));
  EXPECT_THROW(report_on_other_format(broken.path()), mcap::RecordingFileError);
}

}  // namespace
}  // namespace rtd::recordings
