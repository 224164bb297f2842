// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <sqlite3.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <random>

#include "common/camera/open/source_factory.hpp"
#include "common/recordings/reader.hpp"
#include "common/rosbag2/db3_reader.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/camera/image_bag.hpp"
#include "tests/unit/camera/mcap_file.hpp"
#include "tests/unit/camera/played_frames.hpp"

namespace rtd::rosbag2 {
namespace {

namespace fs = std::filesystem;
using namespace ::testing;

constexpr char kHumble[] =
    "CREATE TABLE topics(id INTEGER PRIMARY KEY,name TEXT NOT NULL,type TEXT NOT NULL,serialization_format TEXT NOT "
    "NULL,offered_qos_profiles TEXT NOT NULL);"
    "CREATE TABLE messages(id INTEGER PRIMARY KEY,topic_id INTEGER NOT NULL,timestamp INTEGER NOT NULL, data BLOB NOT "
    "NULL);"
    "CREATE INDEX timestamp_idx ON messages (timestamp ASC);"
    "INSERT INTO topics VALUES(1,'/a','std_msgs/msg/A','cdr',''),(2,'/b','std_msgs/msg/B','cdr','');";
constexpr char kJazzy[] =
    "CREATE TABLE schema(schema_version INTEGER PRIMARY KEY,ros_distro TEXT NOT NULL);"
    "CREATE TABLE metadata(id INTEGER PRIMARY KEY,metadata_version INTEGER NOT NULL,metadata TEXT NOT NULL);"
    "CREATE TABLE topics(id INTEGER PRIMARY KEY,name TEXT NOT NULL,type TEXT NOT NULL,serialization_format TEXT NOT "
    "NULL,offered_qos_profiles TEXT NOT NULL,type_description_hash TEXT NOT NULL);"
    "CREATE TABLE message_definitions(id INTEGER PRIMARY KEY,topic_type TEXT NOT NULL,encoding TEXT NOT "
    "NULL,encoded_message_definition TEXT NOT NULL,type_description_hash TEXT NOT NULL);"
    "CREATE TABLE messages(id INTEGER PRIMARY KEY,topic_id INTEGER NOT NULL,timestamp INTEGER NOT NULL, data BLOB NOT "
    "NULL);"
    "CREATE INDEX timestamp_idx ON messages (timestamp ASC);"
    "INSERT INTO schema VALUES(4,'jazzy');"
    "INSERT INTO topics VALUES(1,'/a','std_msgs/msg/A','cdr','','RIHS01_0'),(2,'/b','std_msgs/msg/B','cdr','','');";
/// Recorded as 3, 1, 2; 20 kB messages use overflow pages.
constexpr char kMessages[] =
    "INSERT INTO messages(topic_id,timestamp,data) VALUES(1,3000000000,zeroblob(20000)),(2,1000000000,x'00010203'),"
    "(1,2000000000,x'07');";

class Db3ReaderTest : public ::testing::Test {
 protected:
  static sqlite3* make(const fs::path& path, const std::string& sql) {
    sqlite3* database = nullptr;
    EXPECT_EQ(sqlite3_open(path.c_str(), &database), SQLITE_OK);
    EXPECT_EQ(sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK) << sqlite3_errmsg(database);
    return database;
  }
  fs::path closed(const std::string& sql) const {
    fs::path path = folder_ / "a?b%c#d.db3";
    sqlite3_close(make(path, sql));
    return path;
  }
  fs::path written(const std::string& content) const { return folder_.write("raw.db3", content); }

  const rtd::test::TemporaryFolder folder_;
};

void expect_three_messages(Db3Reader reader) {
  EXPECT_THAT(reader.damages(), IsEmpty());
  EXPECT_EQ(reader.topics().at(1).messages, 2U);
  EXPECT_EQ(reader.topics().at(2).type, "std_msgs/msg/B");
  const auto places = reader.messages({"/a", "/b"});
  ASSERT_THAT(places, SizeIs(3));
  EXPECT_THAT(reader.read(places[0]), ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(reader.read(places[1]), ElementsAre(7));
  EXPECT_EQ(reader.read(places[2]), std::vector<std::uint8_t>(20000));
  EXPECT_THAT(reader.messages({"/b"}), SizeIs(1));
}

TEST_F(Db3ReaderTest, reads_all_messages_in_order_of_time) {
  expect_three_messages(Db3Reader(closed(std::string(kHumble) + kMessages)));
}

TEST_F(Db3ReaderTest, reads_the_schema_of_jazzy) {
  expect_three_messages(Db3Reader(closed(std::string(kJazzy) + kMessages)));
}

TEST_F(Db3ReaderTest, reads_a_file_that_was_never_closed_and_leaves_it_as_it_is) {
  const fs::path open = folder_ / "open.db3", left = folder_ / "left.db3";
  sqlite3* writer = make(open, std::string("PRAGMA journal_mode=WAL;") + kHumble + kMessages);
  fs::copy_file(open, left);
  fs::copy_file(open.string() + "-wal", left.string() + "-wal");
  sqlite3_close(writer);
  const std::string file = rtd::test::read_text(left), log = rtd::test::read_text(left.string() + "-wal");
  ASSERT_FALSE(log.empty());
  expect_three_messages(Db3Reader(left));
  EXPECT_EQ(rtd::test::read_text(left), file);
  EXPECT_EQ(rtd::test::read_text(left.string() + "-wal"), log);
}

TEST_F(Db3ReaderTest, refuses_files_that_are_no_recording) {
  const auto open = [](const fs::path& path) { return [path] { Db3Reader{path}; }; };
  EXPECT_THAT(open(folder_ / "none.db3"), ThrowsMessage<Db3Error>(HasSubstr("No such file")));
  EXPECT_THAT(open(written("")), ThrowsMessage<Db3Error>(HasSubstr("empty")));
  EXPECT_THAT(open(written(std::string(5000, 'x'))), ThrowsMessage<Db3Error>(HasSubstr("not a database")));
  const fs::path whole = closed("CREATE TABLE t(a)");
  EXPECT_THAT(open(whole), ThrowsMessage<Db3Error>(HasSubstr("lacks the table")));
  std::ofstream(whole.string() + "-wal") << "log";
  ASSERT_EQ(mkfifo((whole.string() + "-journal").c_str(), 0600), 0);
  EXPECT_THAT(open(whole), ThrowsMessage<Db3Error>(HasSubstr("-journal: is a pipe"))) << "SQLite would wait for it";
}

TEST_F(Db3ReaderTest, refuses_a_view_in_place_of_the_messages) {
  const fs::path path = closed(
      "CREATE TABLE topics(id INTEGER PRIMARY KEY,name,type,serialization_format);"
      "CREATE VIEW messages AS WITH RECURSIVE r(x) AS (SELECT 1 UNION ALL SELECT x+1 FROM r) SELECT 1 AS topic_id, x "
      "AS timestamp, x AS rowid FROM r");
  EXPECT_THAT([&] { Db3Reader{path}; }, ThrowsMessage<Db3Error>(HasSubstr("lacks the table")));
}

TEST_F(Db3ReaderTest, cut_file_gives_what_is_left_and_reports_the_loss) {
  std::string many = kHumble;
  for (int i = 0; i < 200; ++i) many += "INSERT INTO messages VALUES(NULL,1," + std::to_string(i) + ",zeroblob(1000));";
  const std::string whole = rtd::test::read_text(closed(many));
  Db3Reader reader(written(whole.substr(0, whole.size() / 2)));
  EXPECT_THAT(reader.damages(), SizeIs(1));
  EXPECT_GT(reader.messages({"/a"}).size(), 20U);
  EXPECT_LT(reader.messages({"/a"}).size(), 200U);
}

TEST_F(Db3ReaderTest, survives_flipped_bytes) {
  const std::string sound = rtd::test::read_text(closed(std::string(kJazzy) + kMessages));
  std::mt19937 random(7);
  int refused = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    std::string damaged = sound;
    for (int i = 0; i < 8; ++i) damaged[random() % damaged.size()] = static_cast<char>(random());
    try {
      Db3Reader reader(written(damaged));
      for (const Db3Place& place : reader.messages({"/a", "/b"})) EXPECT_LE(reader.read(place).size(), 1U << 20);
    } catch (const Db3Error&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 0);
}

TEST_F(Db3ReaderTest, messages_are_played_as_cdr) {
  const auto recording = recordings::open_reader(closed(std::string(kJazzy) + kMessages));
  ASSERT_THAT(recording->topics(), SizeIs(2));
  EXPECT_EQ(recording->topics()[0].type, "std_msgs/A");
  recording->play({"/a"});
  const auto first = recording->next();
  ASSERT_TRUE(first);
  EXPECT_EQ(first->recorded_ns, 2'000'000'000);
  EXPECT_EQ(first->wire, ros::Wire::kCdr);
  EXPECT_THAT(first->bytes, ElementsAre(7));
  EXPECT_TRUE(recording->next());
  EXPECT_FALSE(recording->next());
  EXPECT_EQ(camera::complete_uri("x/y.db3"), "db3:x/y.db3");
}

}  // namespace
}  // namespace rtd::rosbag2

namespace rtd::camera {
namespace {

using test::ImageBag;
using test::play_all;
using test::Played;
using test::same;
using namespace ::testing;

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
    const auto recording = recordings::open_reader(mcap_uri_.substr(5));
    copied_ = copy_to_db3(*recording, db3_);
  }

  const rtd::test::TemporaryFolder folder_;
  const std::filesystem::path db3_ = folder_ / "copied.db3";
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
