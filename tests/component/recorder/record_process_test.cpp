// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// rtd-record beside publishers over Fast DDS, as people use it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/mount.h>

#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <thread>

#include "common/bus/commands.hpp"
#include "common/bus/raw_bus.hpp"
#include "tests/component/bus/patterns.hpp"
#include "tests/component/recorder/recorded_file.hpp"
#include "tests/component/recorder/recorder_process.hpp"
#include "tests/support/run_command.hpp"
#include "tests/support/sanitizers.hpp"
#include "tests/support/temporary_folder.hpp"

namespace rtd::recorder {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;
using Bytes = std::vector<std::byte>;

template <class T>
Bytes cdr_of(const T& plain) {
  Bytes bytes(4 + sizeof(T), std::byte{0});
  bytes[1] = std::byte{1};
  std::memcpy(bytes.data() + 4, &plain, sizeof(T));
  return bytes;
}

/// A multiple of 4, to which RTPS pads the samples that it sends.
Bytes some_bytes(std::uint32_t number, std::size_t size) {
  Bytes bytes(size, static_cast<std::byte>(number % 251));
  bytes[0] = bytes[2] = bytes[3] = std::byte{0};
  bytes[1] = std::byte{1};
  return bytes;
}

template <class... Writer>
void wait_matched(const Writer&... writers) {
  for (int i = 0; i < 10'000 && ((writers.matched() == 0) || ...); ++i) std::this_thread::sleep_for(1ms);
  ASSERT_TRUE(((writers.matched() > 0) && ...));
  std::this_thread::sleep_for(200ms);  // the other side matches too
}

class RecordProcess : public ::testing::Test {
 protected:
  RecordProcess() {
    options_.domain = test_domain();
    options_.participant_name = "record-test";
  }

  const rtd::test::TemporaryFolder folder_;
  bus::BusOptions options_;
};

TEST_F(RecordProcess, four_topics_with_raw_frames_are_complete_to_the_byte) {
  constexpr std::uint32_t kMessages = 60;
  const auto typed = bus::connect(options_);
  const auto raw = bus::connect_raw(options_);
  auto frames = typed->writer(bus::topics::kFrame);
  auto tracking = typed->writer(bus::topics::kTracking);
  const auto odometry = raw->writer({"rt/slam/odometry", "nav_msgs::msg::dds_::Odometry_"}, {});
  const auto unknown = raw->writer({"rt/laser", "vendor_msgs::msg::dds_::Laser_"}, {});
  RecorderProcess recorder(test_domain(), {"-o", folder_ / "run.mcap"});
  wait_matched(frames, tracking, *odometry, *unknown);

  std::map<std::string, std::vector<Bytes>> sent;
  auto frame = std::make_unique<msg::RgbdFrame>();
  for (std::uint32_t i = 0; i < kMessages; ++i) {
    bus::fill_frame(*frame, i);
    msg::TrackingResult result{};
    result.seq = i;
    sent["rtd/frame"].push_back(cdr_of(*frame));
    sent["rtd/tracking"].push_back(cdr_of(result));
    sent["/slam/odometry"].push_back(some_bytes(i, 700));
    sent["/laser"].push_back(some_bytes(i, 20'000 + 4 * i));
    ASSERT_TRUE(frames.write(*frame));
    ASSERT_TRUE(tracking.write(result));
    ASSERT_TRUE(odometry->write(sent["/slam/odometry"].back()));
    ASSERT_TRUE(unknown->write(sent["/laser"].back()));
    std::this_thread::sleep_for(20ms);
  }
  std::this_thread::sleep_for(300ms);
  const int status = recorder.end_by(SIGINT);
  if (test_support::kSanitized && status == 3) GTEST_SKIP() << test_support::kTooSlow;  // messages lost
  EXPECT_EQ(status, 0);

  const RecordedFile file = read_recording(folder_ / "run.mcap");
  EXPECT_TRUE(file.has_summary);
  EXPECT_EQ(file.problems, 0U);
  for (const auto& [topic, messages] : sent) {
    ASSERT_TRUE(file.topics.contains(topic)) << topic;
    const std::vector<ReadMessage>& recorded = file.topics.at(topic);
    if (test_support::kSanitized && recorded.size() < messages.size()) GTEST_SKIP() << test_support::kTooSlow;
    ASSERT_EQ(recorded.size(), messages.size()) << topic;
    for (std::size_t i = 0; i < messages.size(); ++i) {
      ASSERT_TRUE(recorded[i].cdr == messages[i]) << topic << " message " << i;
      ASSERT_GE(recorded[i].log_time, recorded[i].publish_time);
    }
  }
}

/// Whatever its vendor (RTD_DDS) and ours are.
TEST_F(RecordProcess, begins_and_ends_recordings_by_command) {
  RecorderProcess recorder(test_domain(), {"--wait", "--recordings-dir", folder_.path()});
  const auto raw = bus::connect_raw(options_);
  const auto laser = raw->writer({"rt/laser", "vendor_msgs::msg::dds_::Laser_"}, {});
  bus::CommandClient client(options_);
  for (const char* name : {"first.mcap", "second.mcap"}) {
    const bus::CommandAnswer started = client.call("recorder/start", name, 20'000);
    ASSERT_TRUE(started.success) << started.message;
    wait_matched(*laser);
    ASSERT_TRUE(laser->write(some_bytes(1, 40)));
    std::this_thread::sleep_for(300ms);
    const bus::CommandAnswer stopped = client.call("recorder/stop", "", 20'000);
    EXPECT_TRUE(stopped.success) << stopped.message;
    EXPECT_EQ(read_recording(folder_ / name).topics.at("/laser").size(), 1U);
  }
  EXPECT_EQ(recorder.end_by(SIGINT), 0);
}

TEST_F(RecordProcess, parts_of_a_split_recording_are_complete_and_compressed) {
  constexpr std::uint32_t kMessages = 300;
  const auto raw = bus::connect_raw(options_);
  const auto writer = raw->writer({"rt/laser", "vendor_msgs::msg::dds_::Laser_"}, {});
  RecorderProcess recorder(test_domain(), {"-o", folder_ / "bag", "--split", "60kB", "--compress", "zstd", "--topics",
                                           "/laser", "--set", "record.chunk_kib=32"});
  wait_matched(*writer);
  for (std::uint32_t i = 0; i < kMessages; ++i) {
    Bytes message(3000);
    for (std::size_t j = 4; j < message.size(); ++j) message[j] = static_cast<std::byte>((j * j + i * 31) >> 3);
    ASSERT_TRUE(writer->write(message));
    std::this_thread::sleep_for(1ms);
  }
  std::this_thread::sleep_for(200ms);
  EXPECT_EQ(recorder.end_by(SIGTERM), 0);

  std::uint32_t next = 1;
  std::size_t part = 0;
  for (; fs::exists(folder_ / "bag" / ("bag_" + std::to_string(part) + ".mcap")); ++part) {
    const RecordedFile file = read_recording(folder_ / "bag" / ("bag_" + std::to_string(part) + ".mcap"));
    EXPECT_TRUE(file.has_summary);
    for (const ReadMessage& message : file.topics.at("/laser")) EXPECT_EQ(message.sequence, next++);
  }
  EXPECT_EQ(next, kMessages + 1);
  EXPECT_GT(part, 2U);
  EXPECT_TRUE(fs::exists(folder_ / "bag" / "metadata.yaml"));

  const auto command = testing::run_command(std::string(RTD_RECORD_PATH) + " join " + (folder_ / "bag").string() +
                                            " -o " + (folder_ / "joined.mcap").string());
  EXPECT_EQ(command.exit_code, 0) << command.output;
  const RecordedFile joined = read_recording(folder_ / "joined.mcap");
  ASSERT_EQ(joined.topics.at("/laser").size(), kMessages);
  for (std::uint32_t i = 0; i < kMessages; ++i) ASSERT_EQ(joined.topics.at("/laser")[i].sequence, i + 1);
}

/// A disk of a few megabytes.
class SmallDisk {
 public:
  explicit SmallDisk(fs::path folder) : folder_(std::move(folder)) {
    fs::create_directories(folder_);
    mounted_ = mount("rtd_test", folder_.c_str(), "tmpfs", 0, "size=4m") == 0;
  }
  ~SmallDisk() {
    if (mounted_) umount2(folder_.c_str(), MNT_DETACH);
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;
  bool mounted() const { return mounted_; }

 private:
  const fs::path folder_;
  bool mounted_ = false;
};

TEST_F(RecordProcess, a_full_disk_ends_it_and_keeps_what_was_written) {
  const SmallDisk disk(folder_ / "disk");
  if (!disk.mounted()) GTEST_SKIP() << "needs root (or CAP_SYS_ADMIN) to mount a small disk";
  const auto raw = bus::connect_raw(options_);
  const auto writer = raw->writer({"rt/laser", "vendor_msgs::msg::dds_::Laser_"}, {});
  RecorderProcess recorder(
      test_domain(), {"-o", folder_ / "disk" / "run.mcap", "--topics", "/laser", "--set", "record.min_free_mib=0"});
  wait_matched(*writer);
  constexpr std::size_t kSize = 100'000, kDiskBytes = 4U << 20U;
  std::uint32_t sent = 0;
  for (; sent * kSize < 2 * kDiskBytes && writer->matched() > 0; ++sent) {
    ASSERT_TRUE(writer->write(some_bytes(sent, kSize)));
    std::this_thread::sleep_for(10ms);
  }
  EXPECT_EQ(recorder.wait(), 3) << "ended by itself, and says that something is missing";

  const RecordedFile file = read_recording(folder_ / "disk" / "run.mcap");
  const std::vector<ReadMessage>& recorded = file.topics.at("/laser");
  EXPECT_GE(recorded.size() * kSize, kDiskBytes - (2U << 20U)) << "at most the last chunks are missing";
  for (std::uint32_t i = 0; i < recorded.size(); ++i) ASSERT_TRUE(recorded[i].cdr == some_bytes(i, kSize)) << i;
}

TEST_F(RecordProcess, recover_and_join_refuse_what_is_no_recording_and_write_nothing) {
  std::ofstream(folder_ / "a.bag") << "#ROSBAG V2.0\n and more of it";
  std::ofstream(folder_ / "notes.txt") << "not a recording";
  const auto run = [&](const std::string& arguments) {
    return testing::run_command(std::string(RTD_RECORD_PATH) + ' ' + arguments + " -o " +
                                (folder_ / "new.mcap").string());
  };
  for (const char* command : {"recover ", "join "}) {
    const auto bag = run(command + (folder_ / "a.bag").string()),
               notes = run(command + (folder_ / "notes.txt").string());
    EXPECT_EQ(bag.exit_code, 2);
    EXPECT_THAT(bag.output, ::testing::HasSubstr("a ROS 1 bag"));
    EXPECT_EQ(notes.exit_code, 2);
    EXPECT_THAT(notes.output, ::testing::HasSubstr("not an MCAP file"));
  }
  EXPECT_FALSE(fs::exists(folder_ / "new.mcap"));
}

TEST_F(RecordProcess, wrong_output_is_exit_code_2) {
  EXPECT_EQ(RecorderProcess(test_domain(), {"-o", "/proc/x.mcap"}).wait(), 2);
  EXPECT_EQ(RecorderProcess(test_domain(), {"-o", folder_ / "y.mcap", "--split", "often"}).wait(), 2);
  EXPECT_EQ(RecorderProcess(test_domain(), {"-o", folder_ / "y.mcap", "--compress", "rar"}).wait(), 2);
  RecorderProcess first(test_domain(), {"-o", folder_ / "z.mcap"});
  for (int i = 0; i < 5000 && !fs::exists(folder_ / "z.mcap"); ++i) std::this_thread::sleep_for(1ms);
  EXPECT_EQ(RecorderProcess(test_domain() + 1, {"-o", folder_ / "z.mcap", "--force"}).wait(), 2);
  EXPECT_EQ(first.end_by(SIGINT), 0);
}

}  // namespace
}  // namespace rtd::recorder
