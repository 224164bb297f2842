// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <sqlite3.h>

#include <opencv2/imgcodecs.hpp>

#include "common/recordings/reader.hpp"
#include "tests/unit/camera/image_bag.hpp"
#include "tests/unit/camera/mcap_file.hpp"
#include "tests/unit/camera/played_frames.hpp"

namespace rtd::camera {
namespace {

using test::ImageBag;
using test::play_all;
using test::Played;
using test::same;
using ::testing::SizeIs;

constexpr char kTables[] =
    "CREATE TABLE topics(id INTEGER PRIMARY KEY,name,type,serialization_format,offered_qos_profiles);"
    "CREATE TABLE messages(id INTEGER PRIMARY KEY,topic_id,timestamp,data);";

/// Two frames of colour and depth with their calibration.
void fill(test::McapFile& file) {
  for (const double second : {1.0, 2.0}) {
    msg::CompressedImage color, depth;
    color.header = depth.header = {msg::to_time(static_cast<std::int64_t>(second * 1e9)), "camera_color_optical_frame"};
    color.format = "rgb8; png compressed bgr8";
    cv::imencode(".png", ImageBag::color(), color.data);
    depth.format = "16UC1; compressedDepth png";
    cv::imencode(".png", ImageBag::depth(), depth.data);
    depth.data.insert(depth.data.begin(), 12, 0);
    const std::string image = "sensor_msgs/msg/CompressedImage", prefix = "/camera/camera/";
    file.add(prefix + "color/image_raw/compressed", image, color, second + 0.01);
    file.add(prefix + "color/camera_info", "sensor_msgs/msg/CameraInfo", ImageBag::camera_info(), second + 0.02);
    file.add(prefix + "aligned_depth_to_color/image_raw/compressedDepth", image, depth, second + 0.05);
  }
}

std::vector<std::string> names(const recordings::Reader& recording) {
  std::vector<std::string> names;
  for (const recordings::RecordedTopic& topic : recording.topics()) names.push_back(topic.name);
  return names;
}

/// Writes what the recording contains as rosbag2 does; returns the number of messages.
int copy_to_db3(recordings::Reader& recording, const std::filesystem::path& path) {
  sqlite3* database = nullptr;
  EXPECT_EQ(sqlite3_open(path.c_str(), &database), SQLITE_OK);
  sqlite3_exec(database, kTables, nullptr, nullptr, nullptr);
  for (const recordings::RecordedTopic& topic : recording.topics()) {
    const std::string ros2_type = "sensor_msgs/msg/" + topic.type.substr(topic.type.find('/') + 1);
    const std::string sql = "INSERT INTO topics VALUES(NULL,'" + topic.name + "','" + ros2_type + "','cdr','');";
    EXPECT_EQ(sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK);
  }
  sqlite3_stmt* insert = nullptr;
  sqlite3_prepare_v2(database, "INSERT INTO messages SELECT NULL, id, ?, ? FROM topics WHERE name = ?", -1, &insert,
                     nullptr);
  int copied = 0;
  recording.play(names(recording));
  for (auto message = recording.next(); message; message = recording.next(), ++copied) {
    sqlite3_bind_int64(insert, 1, message->recorded_ns);
    sqlite3_bind_blob(insert, 2, message->bytes.data(), static_cast<int>(message->bytes.size()), SQLITE_TRANSIENT);
    sqlite3_bind_text(insert, 3, message->topic.c_str(), -1, SQLITE_TRANSIENT);
    EXPECT_EQ(sqlite3_step(insert), SQLITE_DONE);
    sqlite3_reset(insert);
  }
  sqlite3_finalize(insert);
  sqlite3_close(database);
  return copied;
}

class Db3SourceTest : public ::testing::Test {
 protected:
  Db3SourceTest() {
    fill(file_);
    mcap_uri_ = file_.uri();
    std::filesystem::remove(db3_);
    const auto recording = recordings::open_reader(mcap_uri_.substr(5));
    copied_ = copy_to_db3(*recording, db3_);
  }
  ~Db3SourceTest() override { std::filesystem::remove(db3_); }

  const std::filesystem::path db3_ =
      std::filesystem::temp_directory_path() / ("rtd_db3_source_" + std::to_string(getpid()) + ".db3");
  test::McapFile file_;
  std::string mcap_uri_;
  int copied_ = 0;
};

TEST_F(Db3SourceTest, messages_are_those_of_the_mcap_file_byte_for_byte) {
  ASSERT_EQ(copied_, 6);
  const auto mcap = recordings::open_reader(mcap_uri_.substr(5)), db3 = recordings::open_reader(db3_);
  mcap->play(names(*mcap));
  db3->play(names(*db3));
  for (int i = 0; i < copied_; ++i) {
    const auto expected = mcap->next(), found = db3->next();
    ASSERT_TRUE(expected && found) << i;
    EXPECT_EQ(found->topic, expected->topic);
    EXPECT_EQ(found->type, expected->type);
    EXPECT_EQ(found->recorded_ns, expected->recorded_ns);
    EXPECT_EQ(found->bytes, expected->bytes);
  }
  EXPECT_FALSE(db3->next());
}

TEST_F(Db3SourceTest, frames_are_those_of_the_mcap_file) {
  const Played played = play_all("db3:" + db3_.string());
  ASSERT_THAT(played.frames, SizeIs(2));
  EXPECT_EQ(played.frames[1].image.stamp_ns, 2'000'000'000);
  EXPECT_TRUE(same(played.frames[0].image.color_bgr, ImageBag::color()));
  EXPECT_TRUE(same(played.frames[1].image.depth, ImageBag::depth()));
}

}  // namespace
}  // namespace rtd::camera
