// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <unistd.h>

#include <cstring>
#include <memory>
#include <sstream>

#include "common/msg/features.hpp"
#include "common/msg/rgbd_frame.hpp"
#include "common/msg/tracking.hpp"
#include "common/ros_codec/wire.hpp"
#include "services/recorder/inspect/inspect_commands.hpp"
#include "services/recorder/inspect/payload_diff.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/recorder/inspect/sample_recording.hpp"

namespace rtd::recordings {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class RecordingCommandsTest : public testing::Test {
 protected:
  std::string file(const std::string& name, const io::Bytes& bytes) const {
    return file(name, std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  }
  std::string file(const std::string& name, const std::string& text) const { return folder_.write(name, text); }
  int info(const std::string& path, bool json = false) { return run_info({path, json}, out_, err_); }
  int diff(const std::string& a, const std::string& b, bool json = false) { return run_diff({a, b, json}, out_, err_); }

  const rtd::test::TemporaryFolder folder_;
  std::ostringstream out_, err_;
};

TEST_F(RecordingCommandsTest, info_of_a_good_file_is_exit_code_0) {
  EXPECT_EQ(info(file("a.mcap", recording_of(regular_messages("/pose", 5)))), 0);
  EXPECT_THAT(out_.str(), testing::AllOf(HasSubstr("/pose"), HasSubstr("100.00"), HasSubstr("all right")));
}

TEST_F(RecordingCommandsTest, info_of_a_cut_file_is_exit_code_3_behind_what_can_be_read) {
  io::Bytes bytes = recording_of(regular_messages("/pose", 5));
  bytes.resize(bytes.size() - 10);
  EXPECT_EQ(info(file("a.mcap", bytes), true), 3);
  EXPECT_THAT(out_.str(), HasSubstr("\"messages\": 5"));
}

TEST_F(RecordingCommandsTest, json_replaces_bytes_that_are_not_utf8) {
  const std::string latin1 = file("a.mcap", recording_of(regular_messages("/caf\xe9", 5), {}, "test_msgs/msg/B\xf6"));
  EXPECT_EQ(info(latin1, true), 0) << err_.str();
  EXPECT_EQ(diff(latin1, latin1, true), 0) << err_.str();
  EXPECT_THAT(out_.str(), testing::AllOf(HasSubstr("/caf\xef\xbf\xbd"), HasSubstr("B\xef\xbf\xbd")));
}

TEST_F(RecordingCommandsTest, what_is_no_recording_is_named_with_a_way_out) {
  EXPECT_EQ(info(file("a.bag", std::string("#ROSBAG V2.0\nxxx"))), 2);
  EXPECT_THAT(err_.str(), testing::AllOf(HasSubstr("rtd info: "), HasSubstr("a.bag")));
  EXPECT_EQ(info(file("a.txt", std::string("hello"))), 2);
  EXPECT_THAT(err_.str(), HasSubstr("not an MCAP file"));
  EXPECT_EQ(info(file("empty.mcap", std::string())), 2);
  EXPECT_THAT(err_.str(), HasSubstr("empty"));
  EXPECT_EQ(info("/nonexistent/a.mcap"), 2);
  EXPECT_THAT(err_.str(), HasSubstr("/nonexistent/a.mcap"));
}

TEST_F(RecordingCommandsTest, a_folder_stands_for_the_only_recording_in_it) {
  EXPECT_EQ(info(folder_.path().string()), 2);
  EXPECT_THAT(err_.str(),
              HasSubstr("holds no recording (metadata.yaml, .mcap, .db3): name a recording or a folder with one\n"));
  file("a_0.mcap", recording_of(regular_messages("/pose", 5)));
  EXPECT_EQ(info(folder_.path().string()), 0);
  EXPECT_EQ(diff(folder_.path().string(), folder_.path().string()), 0);
  file("b_0.mcap", recording_of(regular_messages("/pose", 5)));
  EXPECT_EQ(info(folder_.path().string()), 2);
  EXPECT_THAT(err_.str(), testing::AllOf(HasSubstr("name one of them"), testing::Not(HasSubstr("Is a directory"))));
}

TEST_F(RecordingCommandsTest, diff_says_equal_and_different_by_its_exit_code) {
  std::vector<SampleMessage> messages = regular_messages("/pose", 5);
  const std::string a = file("a.mcap", recording_of(messages));
  EXPECT_EQ(diff(a, a), 0);
  EXPECT_THAT(out_.str(), HasSubstr("equal"));
  messages[2].payload = "other";
  EXPECT_EQ(diff(a, file("b.mcap", recording_of(messages))), 1);
  EXPECT_THAT(out_.str(), HasSubstr("/pose: first different payload: message 2 in A"));
}

TEST_F(RecordingCommandsTest, diff_of_a_damaged_recording_is_no_clean_bill) {
  mcap::WriterOptions options;
  options.chunk_size = 100;
  io::Bytes bytes = recording_of(regular_messages("/pose", 5), options);
  const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  bytes[text.find("payload 2")] ^= std::byte{1};
  const std::string damaged = file("a.mcap", bytes);
  EXPECT_EQ(diff(damaged, damaged), 3);
  EXPECT_THAT(err_.str(), HasSubstr("damaged"));
}

TEST_F(RecordingCommandsTest, diff_names_what_it_compares_and_how_to_convert) {
  const std::string packed = file("a.gz", std::string("\x1f\x8b\x08"));
  EXPECT_EQ(diff(packed, packed), 2);
  EXPECT_THAT(err_.str(), testing::AllOf(HasSubstr("a.gz is compressed with gzip: unpack it first"),
                                         HasSubstr("compares two recordings (MCAP, rosbag2, ROS 1 bag);")));
  const std::string table = file("a.csv", std::string("1 2 3 4\n"));
  EXPECT_EQ(diff(table, table), 2);
  EXPECT_THAT(err_.str(), HasSubstr("a.csv is not a recording; 'rtd diff' compares"));
  EXPECT_EQ(diff(file("a.mcap", recording_of(regular_messages("/pose", 5))), table), 2);
  EXPECT_THAT(err_.str(), HasSubstr("two trajectories: cmp, or 'rtd eval A B'"));
}

template <class T>
std::vector<std::byte> payload(const T& message) {
  std::vector<std::byte> bytes(4 + sizeof(T));
  bytes[1] = std::byte{1};
  std::memcpy(bytes.data() + 4, &message, sizeof(T));
  return bytes;
}

TEST(PayloadDiff, names_the_field_of_a_feature_that_differs) {
  auto a = std::make_unique<msg::FeatureFrame>();
  auto b = std::make_unique<msg::FeatureFrame>();
  b->count = 7;
  b->features[12].static_probability = 0.5F;
  b->features[13].static_probability = 0.25F;
  b->features[2047].descriptor[31] = 9;
  b->stage_ms[2] = 1.5F;
  EXPECT_THAT(
      differences("rtd_msgs/msg/FeatureFrame", payload(*a), payload(*b)),
      ElementsAre("count: 0 | 7", "stage_ms:[2] 0 | 1.5 (of the run)",
                  "features.static_probability: 2 values, first[12] 0 | 0.5", "features.descriptor:[2047][31] 0 | 9"));
}

/// The last field of each type of ours is found where the compiler has it.
TEST(PayloadDiff, fits_the_structs_of_the_wire) {
  auto frame = std::make_unique<msg::RgbdFrame>(), other_frame = std::make_unique<msg::RgbdFrame>();
  other_frame->depth.back() = 3;
  EXPECT_THAT(differences("rtd_msgs/msg/RgbdFrame", payload(*frame), payload(*other_frame)),
              ElementsAre("depth:[307199] 0 | 3"));
  msg::TrackingResult result{}, other_result{};
  other_result.stage_ms.back() = 2;
  EXPECT_THAT(differences("rtd_msgs/msg/TrackingResult", payload(result), payload(other_result)),
              ElementsAre("stage_ms:[7] 0 | 2 (of the run)"));
  msg::KeyframeEvent event{}, other_event{};
  other_event.kind = msg::KeyframeEventKind::kRemoved;
  EXPECT_THAT(differences("rtd_msgs::msg::dds_::KeyframeEvent_", payload(event), payload(other_event)),
              ElementsAre("kind: 0 | 2"));
}

TEST(PayloadDiff, knows_where_the_fields_of_the_run_are) {
  msg::TrackingResult result{};
  std::vector<std::byte> bytes = payload(result);
  for (const ByteRange& range : run_ranges("rtd_msgs/msg/TrackingResult"))
    std::fill(bytes.begin() + static_cast<std::ptrdiff_t>(range.begin),
              bytes.begin() + static_cast<std::ptrdiff_t>(range.end), std::byte{1});
  std::memcpy(&result, bytes.data() + 4, sizeof(result));
  EXPECT_NE(result.published_ns, 0);
  EXPECT_NE(result.finished_ns, 0);
  EXPECT_NE(result.stage_ms[7], 0);
  EXPECT_EQ(result.stamp_ns, 0);
  EXPECT_EQ(result.T_world_camera.translation_m[0], 0);
  EXPECT_EQ(result.landmarks, 0U);
}

TEST(PayloadDiff, other_types_and_sizes_are_compared_by_bytes) {
  const auto bytes = [](const char* text) { return std::as_bytes(std::span(text, std::strlen(text))); };
  EXPECT_THAT(run_ranges("std_msgs/msg/String"), IsEmpty());
  EXPECT_THAT(differences("std_msgs/msg/String", bytes("abcd"), bytes("abXdef")),
              ElementsAre("size: 4 | 6 bytes", "first at byte 2 of the payload"));
  const std::vector<std::byte> cut(10, std::byte{1});
  EXPECT_THAT(differences("rtd_msgs/msg/TrackingResult", cut, payload(msg::TrackingResult{})),
              testing::Contains(HasSubstr("too short")));
}

TEST(PayloadDiff, names_fields_and_lengths_of_standard_messages) {
  msg::TFMessage a, b;
  a.transforms.resize(2);
  b.transforms.resize(3);
  b.transforms[1].header.frame_id = "map";
  b.transforms[1].transform.rotation.w = 0.5;
  const auto cdr = [](const msg::TFMessage& message) { return ros::encode<ros::Wire::kCdr>(message); };
  const auto bytes_a = cdr(a), bytes_b = cdr(b);
  EXPECT_THAT(
      differences("tf2_msgs/msg/TFMessage", std::as_bytes(std::span(bytes_a)), std::as_bytes(std::span(bytes_b))),
      ElementsAre("transforms: 2 | 3 elements", "transforms.header.frame_id:[1] \"\" | \"map\"",
                  "transforms.transform.rotation.w:[1] 1 | 0.5"));
}

}  // namespace
}  // namespace rtd::recordings
