// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <vector>

#include "services/recorder/core/message_queue.hpp"
#include "services/recorder/core/output_files.hpp"
#include "services/recorder/core/topic_registry.hpp"
#include "tests/support/temporary_folder.hpp"

namespace rtd::recorder {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

QueuedMessage message(std::uint32_t sequence, std::size_t size) {
  auto block = std::make_shared<bus::ByteBlock>();
  block->assign(std::vector<std::byte>(size));
  return {0, sequence, 0, 0, std::move(block)};
}

TEST(MessageQueue, keeps_order_and_refuses_the_newest_when_full) {
  MessageQueue queue(1000);
  for (std::uint32_t i = 0; i < 10; ++i) EXPECT_TRUE(queue.push(message(i, 100)));
  EXPECT_FALSE(queue.push(message(10, 1)));
  EXPECT_EQ(queue.bytes(), 1000U);
  EXPECT_EQ(queue.pop()->sequence, 0U);
  EXPECT_TRUE(queue.push(message(11, 100)));
  for (const std::uint32_t sequence : {1U, 2U, 3U, 4U, 5U, 6U, 7U, 8U, 9U, 11U}) {
    EXPECT_EQ(queue.pop()->sequence, sequence);
  }
  EXPECT_EQ(queue.bytes(), 0U);
}

TEST(MessageQueue, images_leave_room_for_poses) {
  MessageQueue queue(8 * 100'000);
  for (std::uint32_t i = 0; i < 7; ++i) EXPECT_TRUE(queue.push(message(i, 100'000)));
  EXPECT_FALSE(queue.push(message(7, 100'000)));
  for (std::uint32_t i = 0; i < 100; ++i) EXPECT_TRUE(queue.push(message(i, 1000)));
  EXPECT_FALSE(queue.push(message(0, 1000)));
}

TEST(MessageQueue, closed_it_gives_out_what_it_has) {
  MessageQueue queue(1000);
  queue.push(message(1, 10));
  queue.close();
  queue.wait_for(10s);  // does not
  EXPECT_FALSE(queue.push(message(2, 10)));
  EXPECT_EQ(queue.pop()->sequence, 1U);
  EXPECT_FALSE(queue.pop());
}

namespace fs = std::filesystem;

class OutputFolder : public ::testing::Test {
 protected:
  void put(const std::string& name, const std::string& text = "x") const { folder_.write(name, text); }
  std::string in(const std::string& name) const { return folder_.file(name); }

  const rtd::test::TemporaryFolder folder_;
};

TEST(OutputFiles, are_one_file_numbered_files_or_a_folder) {
  EXPECT_EQ(OutputFiles("a/run.mcap", false).file(0), "a/run.mcap");
  EXPECT_EQ(OutputFiles("a/run.mcap", true).file(2), "a/run_2.mcap");
  EXPECT_EQ(OutputFiles("a/run", false).file(0), "a/run/run_0.mcap");
  EXPECT_EQ(OutputFiles("a/run/", false).file(0), "a/run/run_0.mcap");
  EXPECT_EQ(OutputFiles("run.mcap", false).metadata(), "") << "the folder is the user's";
  EXPECT_EQ(OutputFiles("run.mcap", true).metadata(), "./metadata.yaml");
  EXPECT_EQ(OutputFiles("run", false).metadata(), "run/metadata.yaml");
}

TEST_F(OutputFolder, finds_earlier_files_of_this_name_only) {
  for (const char* name : {"run.mcap", "run_0.mcap", "run_12.mcap", "run_x.mcap", "run_.mcap", "other_0.mcap"})
    put(name);
  EXPECT_THAT(OutputFiles(in("run.mcap"), false).existing(), ElementsAre(folder_ / "run.mcap"));
  EXPECT_THAT(OutputFiles(in("run.mcap"), true).existing(),
              ElementsAre(folder_ / "run_0.mcap", folder_ / "run_12.mcap"));
  EXPECT_THAT(OutputFiles(in("new.mcap"), true).existing(), IsEmpty());
  EXPECT_THAT(OutputFiles(in("no/such/folder"), true).existing(), IsEmpty());
}

TEST_F(OutputFolder, finds_a_free_name_beside) {
  EXPECT_EQ(OutputFiles::free_beside(in("run.mcap"), false).file(0), folder_ / "run.mcap");
  put("run.mcap");
  put("run.1.mcap");
  EXPECT_EQ(OutputFiles::free_beside(in("run.mcap"), false).file(0), folder_ / "run.2.mcap");
  fs::create_directories(folder_ / "bag");
  put("bag/bag_0.mcap");
  EXPECT_EQ(OutputFiles::free_beside(in("bag"), true).file(0), folder_ / "bag.1" / "bag.1_0.mcap");
}

TEST_F(OutputFolder, leaves_the_metadata_of_others_alone) {
  const OutputFiles files(in("run.mcap"), true);
  EXPECT_TRUE(files.owns_metadata());
  put("metadata.yaml", "rosbag2_bagfile_information:\n  relative_file_paths:\n    - run_0.mcap\n");
  EXPECT_TRUE(files.owns_metadata());
  put("metadata.yaml", "rosbag2_bagfile_information:\n  relative_file_paths:\n    - other_0.mcap\n");
  EXPECT_FALSE(files.owns_metadata());
  for (const char* unrelated : {"name: my site\n", "", "rosbag2_bagfile_information:\n  storage_identifier: mcap\n"}) {
    put("metadata.yaml", unrelated);
    EXPECT_FALSE(files.owns_metadata()) << unrelated;
  }
  fs::remove(folder_ / "metadata.yaml");
  fs::create_symlink("nowhere", folder_ / "metadata.yaml");
  EXPECT_FALSE(files.owns_metadata());
}

constexpr std::uint64_t kSecond = 1'000'000'000;

TEST(SplitPolicy, reads_sizes_and_times) {
  EXPECT_EQ(parse_split("500MB")->bytes, 500'000'000U);
  EXPECT_EQ(parse_split("1GiB")->bytes, 1ULL << 30);
  EXPECT_EQ(parse_split("1.5gb")->bytes, 1'500'000'000U);
  EXPECT_EQ(parse_split("60s")->duration_ns, 60 * kSecond);
  EXPECT_EQ(parse_split("5min")->duration_ns, 300 * kSecond);
  EXPECT_EQ(parse_split("2h")->duration_ns, 7200 * kSecond);
  for (const char* nonsense : {"", "1", "GB", "-1GB", "0s", "1 GB", "1XB", "nanGB", "1e30GB", "1GBs"}) {
    EXPECT_FALSE(parse_split(nonsense)) << nonsense;
  }
}

TEST(SplitPolicy, by_size_a_file_stays_below) {
  const SplitPolicy policy{1000, 0};
  EXPECT_TRUE(policy.has_room(900, 100, 0, 0));
  EXPECT_FALSE(policy.has_room(900, 101, 0, 0));
}

TEST(SplitPolicy, by_time_a_file_covers_less) {
  const SplitPolicy policy{0, 10 * kSecond};
  EXPECT_TRUE(policy.has_room(1 << 30, 1 << 30, 5 * kSecond, 15 * kSecond - 1));
  EXPECT_FALSE(policy.has_room(0, 0, 5 * kSecond, 15 * kSecond));
  EXPECT_TRUE(policy.has_room(0, 0, 5 * kSecond, 4 * kSecond)) << "a message out of order";
}

TEST(SplitPolicy, never_without_a_limit) {
  EXPECT_FALSE(SplitPolicy{}.on());
  EXPECT_TRUE(SplitPolicy{}.has_room(~0ULL / 2, 1, 0, ~0ULL));
}

TEST(TopicFilter, a_star_crosses_slashes) {
  const TopicFilter slam({"rt/slam/*"});
  EXPECT_TRUE(slam.wants("rt/slam/odometry"));
  EXPECT_TRUE(slam.wants("rt/slam/debug/points"));
  EXPECT_FALSE(slam.wants("rt/tf"));
  EXPECT_TRUE(TopicFilter({"*"}).wants("rtd/frame"));
}

TEST(TopicFilter, takes_names_of_ros_too) {
  const TopicFilter filter({"/slam/odometry", "/camera/*"});
  EXPECT_TRUE(filter.wants("rt/slam/odometry"));
  EXPECT_TRUE(filter.wants("rt/camera/color/camera_info"));
  EXPECT_FALSE(filter.wants("rt/slam/odometry2"));
  EXPECT_FALSE(filter.wants("rtd/frame"));
}

TEST(TopicFilter, knows_the_other_signs_of_a_shell) {
  EXPECT_TRUE(TopicFilter({"rtd/[fk]*"}).wants("rtd/keyframes"));
  EXPECT_FALSE(TopicFilter({"rtd/[fk]*"}).wants("rtd/status"));
  EXPECT_TRUE(TopicFilter({"rt/camera?/image"}).wants("rt/camera2/image"));
  EXPECT_FALSE(TopicFilter({}).wants("rt/tf"));
}

TEST(TopicFilter, takes_requests_and_replies_of_services_only_by_their_names) {
  EXPECT_FALSE(TopicFilter({"*"}).wants("rr/slam/resetReply"));
  EXPECT_TRUE(TopicFilter({"rr/*"}).wants("rr/slam/resetReply"));
}

TEST(TopicFilter, of_a_robot_leaves_out_the_topics_of_others) {
  const TopicFilter all({"*"}, "anna"), pose({"/slam/pose", "rtd/frame"}, "anna");
  EXPECT_TRUE(all.wants("rt/anna/slam/pose"));
  EXPECT_TRUE(all.wants("rt/tf"));
  EXPECT_FALSE(all.wants("rt/bert/slam/pose"));
  EXPECT_TRUE(TopicFilter({"*"}).wants("rt/bert/slam/pose")) << "without a name: all robots";
  EXPECT_TRUE(pose.wants("rt/anna/slam/pose"));
  EXPECT_TRUE(pose.wants("rtd/anna/frame"));
  EXPECT_FALSE(pose.wants("rtd/bert/frame"));
}

}  // namespace
}  // namespace rtd::recorder
