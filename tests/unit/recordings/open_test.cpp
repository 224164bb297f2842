// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/recordings/open.hpp"

#include <sys/stat.h>

#include <fstream>
#include <random>

#include "common/camera/open/source_factory.hpp"
#include "common/mcap/recording_file.hpp"
#include "common/recordings/parts.hpp"
#include "services/recorder/inspect/inspect_commands.hpp"
#include "tests/support/rosbag1/bag_writer.hpp"
#include "tests/unit/recordings/sample_files.hpp"

namespace rtd::recordings {
namespace {

namespace fs = std::filesystem;
using test::messages_of;
using test::packed;
using test::Sample;
using test::samples;
using namespace ::testing;

class OpenTest : public ::testing::Test {
 protected:
  /// Checks that the path holds exactly these messages and nothing is lost.
  void holds(const std::string& path, const std::vector<Sample>& expected) {
    const Opened opened = open(path);
    EXPECT_THAT(opened.damages, IsEmpty());
    EXPECT_EQ(messages_of(*opened.source), expected);
    EXPECT_TRUE(is_recording(path));
  }
  int info(const std::string& path) {
    out_.str({});
    err_.str({});
    return run_info({.file = path}, out_, err_);
  }

  test::Folder folder_;
  std::ostringstream out_, err_;
};

TEST_F(OpenTest, an_mcap_file_is_opened_where_it_lies) {
  const std::string path = folder_.mcap("a.mcap", samples(0, 6));
  holds(path, samples(0, 6));
  EXPECT_EQ(open(path).imported, "");
}

TEST_F(OpenTest, a_database_keeps_times_types_definitions_and_qos) {
  const std::string path = folder_.db3("a.db3", samples(0, 6));
  holds(path, samples(0, 6));
  const Opened opened = open(path);
  const mcap::IndexedReader reader(*opened.source);
  std::map<std::string, std::string> definitions;
  for (const auto& [id, channel] : reader.summary().channels) {
    const mcap::Schema& schema = reader.summary().schemas.at(channel.schema_id);
    definitions[channel.topic] = schema.name + ' ' + schema.data;
    EXPECT_EQ(channel.message_encoding, "cdr");
    EXPECT_EQ(channel.metadata.contains("offered_qos_profiles"), channel.topic == "/imu");
  }
  EXPECT_EQ(definitions["/odom"], "my_msgs/msg/Odd int8 odd");
  EXPECT_EQ(definitions["/imu"], "std_msgs/msg/String ");
}

TEST_F(OpenTest, a_ros1_bag_keeps_its_encoding) {
  rtd::test::BagWriter bag;
  const std::uint32_t imu = bag.connection("/imu", "sensor_msgs/Imu");
  const std::vector<std::uint8_t> bytes = {'x', 'y'};
  bag.message(imu, 5'000'000, bytes);
  const std::string path = folder_.write("a.bag", bag.closed());
  holds(path, {{"/imu", 5'000'000, "xy"}});
  const Opened opened = open(path);
  const mcap::IndexedReader reader(*opened.source);
  EXPECT_EQ(reader.summary().channels.begin()->second.message_encoding, "ros1");
}

TEST_F(OpenTest, split_folders_of_either_storage_are_one_recording) {
  folder_.db3("bag/bag_0.db3", samples(0, 4));
  folder_.db3("bag/bag_1.db3", samples(4, 4));
  folder_.write(
      "bag/metadata.yaml",
      "rosbag2_bagfile_information:\n  relative_file_paths: [bag_0.db3, bag_1.db3]\n  compression_mode: ''\n");
  holds(folder_ / "bag", samples(0, 8));
  EXPECT_THAT(open(folder_ / "bag").imported, HasSubstr("2 files"));
  folder_.mcap("split/s_9.mcap", samples(0, 4));
  folder_.mcap("split/s_10.mcap", samples(4, 4));
  holds(folder_ / "split", samples(0, 8));
  EXPECT_THAT(parts_of(folder_ / "split").files.front().string(), HasSubstr("s_9")) << "without metadata, by number";
}

TEST_F(OpenTest, files_packed_with_zstd_are_unpacked) {
  folder_.mcap("a.mcap", samples(0, 6));
  holds(folder_.write("a.mcap.zst", packed(rtd::test::read_text(folder_ / "a.mcap"))), samples(0, 6));
  folder_.db3("a.db3", samples(0, 6));
  const std::string part = folder_.write("bag/a.db3.zstd", packed(rtd::test::read_text(folder_ / "a.db3")));
  holds(part, samples(0, 6));
  folder_.write("bag/metadata.yaml",
                "rosbag2_bagfile_information: {relative_file_paths: [a.db3.zstd], compression_format: zstd, "
                "compression_mode: FILE}");
  holds(folder_ / "bag", samples(0, 6));
}

TEST_F(OpenTest, messages_packed_one_by_one_are_unpacked) {
  std::vector<Sample> messages = samples(0, 6);
  for (Sample& message : messages) message.data = packed(message.data);
  folder_.db3("bag/a.db3", messages);
  const char* metadata =
      "rosbag2_bagfile_information: {relative_file_paths: [%], compression_format: zstd, "
      "compression_mode: MESSAGE}";
  const auto write_metadata = [&](const std::string& name) {
    std::string text = metadata;
    text.replace(text.find('%'), 1, name);
    folder_.write("bag/metadata.yaml", text);
  };
  write_metadata("a.db3");
  holds(folder_ / "bag", samples(0, 6));
  folder_.mcap("bag/b.mcap", messages);
  write_metadata("b.mcap");
  holds(folder_ / "bag", samples(0, 6));
  messages[2].data[5] ^= 0x55;
  messages[3].data = "no zstd";
  folder_.mcap("bag/b.mcap", messages);
  const Opened opened = open(folder_ / "bag");
  EXPECT_GE(opened.damages.size(), 1U);
  EXPECT_THAT(opened.damages.back(), HasSubstr("cannot be unpacked"));
  EXPECT_LT(messages_of(*opened.source).size(), 6U);
}

TEST_F(OpenTest, what_is_missing_or_damaged_is_named_and_the_rest_is_there) {
  folder_.db3("bag_0.db3", samples(0, 4));
  folder_.metadata({"bag_0.db3", "bag_1.db3"});
  const Opened opened = open(folder_.path());
  EXPECT_THAT(opened.damages, ElementsAre(HasSubstr("bag_1.db3 is missing")));
  EXPECT_EQ(messages_of(*opened.source), samples(0, 4));
  EXPECT_EQ(info(folder_.path()), 3);
  EXPECT_THAT(out_.str(), HasSubstr("bag_1.db3 is missing"));

  std::vector<Sample> many = samples(0, 1000);
  std::mt19937 random(1);
  for (Sample& message : many) {
    for (int i = 0; i < 4000; ++i) message.data += static_cast<char>(random());
  }
  folder_.mcap("a.mcap", many);
  const std::string whole = packed(rtd::test::read_text(folder_ / "a.mcap"));
  const Opened cut = open(folder_.write("cut.mcap.zst", whole.substr(0, whole.size() - 20)));
  EXPECT_THAT(cut.damages, ElementsAre(HasSubstr("cut.mcap.zst")));
  EXPECT_GT(messages_of(*cut.source).size(), 100U) << "what was unpacked before is there";
}

TEST_F(OpenTest, a_folder_gives_only_what_lies_in_it) {
  folder_.mcap("other.mcap", samples(0, 6));
  folder_.mcap("bag/bag_0.mcap", samples(0, 4));
  const auto write_metadata = [&](const std::string& name) {
    folder_.write("bag/metadata.yaml",
                  "rosbag2_bagfile_information: {relative_file_paths: [bag_0.mcap, " + name + "]}");
  };
  for (const std::string& name : {std::string("../other.mcap"), folder_ / "other.mcap", std::string("/etc/passwd")}) {
    write_metadata(name);
    const Opened opened = open(folder_ / "bag");
    EXPECT_EQ(messages_of(*opened.source), samples(0, 4)) << name;
    EXPECT_THAT(opened.damages, ElementsAre(HasSubstr(name + " is missing")));
  }
  for (const char* target : {"../other.mcap", "../none.mcap"}) {
    fs::remove(folder_ / "bag/link.mcap");
    fs::create_symlink(target, folder_ / "bag/link.mcap");
    write_metadata("link.mcap");
    EXPECT_THAT([&] { open(folder_ / "bag"); },
                ThrowsMessage<mcap::RecordingFileError>(
                    AllOf(HasSubstr("bag/link.mcap: leads out of the folder"), HasSubstr("name the file itself"))));
  }
}

TEST_F(OpenTest, what_is_no_recording_is_refused_with_the_reason) {
  const auto refuses = [](const std::string& path, const std::string& text) {
    EXPECT_THAT([&] { open(path); }, ThrowsMessage<mcap::RecordingFileError>(HasSubstr(text))) << path;
  };
  refuses(folder_ / "none.mcap", "none.mcap");
  refuses(folder_.path(), "holds no recording");
  folder_.mcap("two/a_0.mcap", samples(0, 2));
  folder_.mcap("two/b_0.mcap", samples(0, 2));
  refuses(folder_ / "two", "2 recordings of different names");
  refuses(folder_.write("a.txt", "hello"), "not an MCAP file");
  refuses(folder_.write("a.zst", packed("hello")), "not an MCAP file");
  refuses(folder_.write("a.db3", "SQLite format 3 and nothing"), "a.db3");
  folder_.write("m/metadata.yaml", "rosbag2_bagfile_information: [");
  refuses(folder_ / "m", "metadata.yaml cannot be read");
  folder_.write("m/metadata.yaml", "other: 1");
  refuses(folder_ / "m", "describes no recording");
  folder_.write("m/metadata.yaml", "rosbag2_bagfile_information: {relative_file_paths: [x.db3]}");
  refuses(folder_ / "m", "none of the files");
  folder_.write("m/metadata.yaml",
                "rosbag2_bagfile_information: {relative_file_paths: [x.db3], compression_format: lz4}");
  refuses(folder_ / "m", "'lz4': only zstd is known");
  fs::remove(folder_ / "m/metadata.yaml");
  ASSERT_EQ(mkfifo((folder_ / "m/metadata.yaml").c_str(), 0600), 0);
  refuses(folder_ / "m", "metadata.yaml: is a pipe");
  for (const char* name : {"p.mcap", "p.db3", "p.bag"}) {
    ASSERT_EQ(mkfifo((folder_ / name).c_str(), 0600), 0);
    refuses(folder_ / name, std::string(name) + ": is a pipe");
  }
}

TEST_F(OpenTest, nothing_stays_behind_in_the_folder_for_temporary_files) {
  const fs::path temporary = folder_ / "tmp";
  fs::create_directory(temporary);
  ASSERT_EQ(setenv("TMPDIR", temporary.c_str(), 1), 0);
  folder_.db3("a.db3", samples(0, 6));
  {
    const Opened opened = open(folder_.write("a.db3.zst", packed(rtd::test::read_text(folder_ / "a.db3"))));
    EXPECT_TRUE(fs::is_empty(temporary)) << "already while it is read";
    EXPECT_EQ(messages_of(*opened.source).size(), 6U);
  }
  unsetenv("TMPDIR");
}

TEST_F(OpenTest, info_and_diff_take_every_form) {
  folder_.db3("bag/bag_0.db3", samples(0, 4));
  folder_.db3("bag/bag_1.db3", samples(4, 4));
  const std::string whole = folder_.db3("whole.db3", samples(0, 8));
  EXPECT_EQ(info(folder_ / "bag"), 0) << err_.str();
  EXPECT_THAT(out_.str(),
              AllOf(HasSubstr("2 files copied into MCAP"), HasSubstr("/odom"), HasSubstr("my_msgs/msg/Odd")));
  DiffRequest request;
  request.a = folder_ / "bag";
  request.b = whole;
  EXPECT_EQ(run_diff(request, out_, err_), 0) << out_.str() << err_.str();
  request.b = folder_.db3("other.db3", samples(0, 7));
  EXPECT_EQ(run_diff(request, out_, err_), 1);
}

TEST_F(OpenTest, bare_paths_become_sources) {
  folder_.db3("bag/bag_0.db3", samples(0, 4));
  fs::create_directory(folder_ / "tum");
  fs::create_directory(folder_ / "pairs");
  std::ofstream(folder_ / "tum/associations.txt") << "1 a 1 b\n";
  EXPECT_EQ(camera::complete_uri(folder_ / "bag"), "mcap:" + folder_ / "bag");
  EXPECT_EQ(camera::complete_uri(folder_ / "tum"), "tum:" + folder_ / "tum");
  EXPECT_EQ(camera::complete_uri(folder_ / "tum?masks=1"), "tum:" + folder_ / "tum?masks=1");
  EXPECT_EQ(camera::complete_uri(folder_ / "pairs"), "folder:" + folder_ / "pairs");
  EXPECT_EQ(camera::complete_uri("x.mcap.zst"), "mcap:x.mcap.zst");
  EXPECT_EQ(camera::complete_uri("x.tar.zst"), "x.tar.zst");
}

}  // namespace
}  // namespace rtd::recordings
