// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/recorder/core/recording.hpp"

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <thread>

#include "common/bus/offered_qos.hpp"
#include "common/mcap/indexed_reader.hpp"

namespace rtd::recorder {
namespace {

using namespace std::chrono_literals;
constexpr std::int64_t kMs = 1'000'000;

/// A disk of limited size.
class SmallDisk final : public io::ByteSink {
 public:
  explicit SmallDisk(std::uint64_t size) : size_(size) {}
  void append(std::initializer_list<io::ByteView> parts) override {
    std::uint64_t more = 0;
    for (const auto part : parts) more += part.size();
    if (memory_.position() + more > size_) throw io::IoError(ENOSPC, "no room");
    memory_.append(parts);
    written_ = memory_.position();
  }
  std::uint64_t position() const override { return written_; }
  std::uint64_t sync() override { return position(); }
  const io::Bytes& bytes() const { return memory_.bytes(); }

 private:
  std::uint64_t size_;
  io::MemorySink memory_;
  std::atomic<std::uint64_t> written_ = 0;  ///< sync() is called in another thread
};

class RecordingTest : public ::testing::Test {
 protected:
  void begin(RecordingOptions options = {}) {
    recording_.emplace(
        options,
        [this](std::size_t number) {
          EXPECT_EQ(number, disks_.size());
          disks_.push_back(std::make_shared<SmallDisk>(disk_size_));
          return disks_.back();
        },
        book_, sync_);
  }
  QueuedMessage message(std::size_t topic, std::size_t size, std::uint64_t received_ns) {
    auto block = std::make_shared<bus::ByteBlock>();
    block->assign(std::vector<std::byte>(size, std::byte{7}));
    return {topic, ++sequence_, received_ns, received_ns - 5, std::move(block)};
  }
  std::uint64_t messages_in(std::size_t disk) const {
    const io::MemorySource source(disks_[disk]->bytes());
    mcap::IndexedReader reader(source);
    std::uint64_t count = 0;
    mcap::MessageCursor cursor = reader.messages();
    while (cursor.next() != nullptr) ++count;
    return count;
  }
  /// Messages of the topic that are acknowledged, once they are so many.
  std::uint64_t wait_acknowledged(std::size_t topic, std::uint64_t expected) {
    for (int i = 0; i < 2000; ++i) {
      const auto messages = sync_.acknowledged().messages;
      if (messages.size() > topic && messages[topic] >= expected) return messages[topic];
      std::this_thread::sleep_for(1ms);
    }
    return 0;
  }

  std::uint64_t disk_size_ = 1 << 30;
  std::vector<std::shared_ptr<SmallDisk>> disks_;
  TopicRegistry book_;
  SyncThread sync_{0ms};
  std::optional<Recording> recording_;
  std::uint32_t sequence_ = 0;
};

TEST_F(RecordingTest, messages_are_acknowledged_when_their_chunk_is_ended) {
  const std::size_t pose = book_.find_or_add("rt/slam/pose", "geometry_msgs::msg::dds_::PoseStamped_");
  begin();
  recording_->write(message(pose, 100, 1000), 0);
  recording_->write(message(pose, 100, 2000), 50 * kMs);
  recording_->tick(99 * kMs);
  EXPECT_TRUE(sync_.acknowledged().messages.empty());
  recording_->tick(100 * kMs);
  EXPECT_EQ(wait_acknowledged(pose, 2), 2U);

  recording_->write(message(pose, 2'000'000, 3000), 150 * kMs);  // fills a chunk at once
  EXPECT_EQ(wait_acknowledged(pose, 3), 3U);
  EXPECT_EQ(sync_.acknowledged().bytes, disks_[0]->position());
}

TEST_F(RecordingTest, keeps_the_order_of_delivery_when_a_lost_message_was_sent_again) {
  const std::size_t pose = book_.find_or_add("rt/slam/pose", "geometry_msgs::msg::dds_::PoseStamped_");
  const std::size_t path = book_.find_or_add("rt/slam/path", "nav_msgs::msg::dds_::Path_");
  begin();
  const std::uint64_t start = 60'000'000'000;
  recording_->write(message(pose, 10, start + 124 * kMs), 0);  // delivered first, but received last: lost once
  recording_->write(message(pose, 10, start), 0);
  recording_->write(message(path, 10, start + 1), 0);
  recording_->write(message(pose, 10, start + 130 * kMs), 0);
  recording_->write(message(pose, 10, start - 3'000 * kMs), 0);  // the clock was set back
  recording_->finish({});

  const io::MemorySource source(disks_[0]->bytes());
  mcap::IndexedReader reader(source);
  mcap::MessageCursor cursor = reader.messages();
  std::vector<std::uint32_t> order;
  while (const mcap::Message* read = cursor.next()) order.push_back(read->sequence);
  EXPECT_EQ(order, (std::vector<std::uint32_t>{5, 3, 1, 2, 4}));
}

TEST_F(RecordingTest, says_what_ros2_tools_look_for) {
  const std::size_t pose = book_.find_or_add("rt/slam/pose", "geometry_msgs::msg::dds_::PoseStamped_");
  const std::size_t thing = book_.find_or_add("rtd/thing", "Thing");
  bus::RawQos latched;
  latched.durability = bus::RawQos::Durability::kTransientLocal;
  book_.add_offer(pose, {});
  book_.add_offer(pose, latched);
  book_.add_offer(pose, latched);
  begin();
  recording_->write(message(pose, 64, 1000), 0);
  recording_->finish({mcap::Metadata{"rtd:losses", {{"total", "0"}}}});

  const io::MemorySource source(disks_[0]->bytes());
  mcap::IndexedReader reader(source);
  EXPECT_EQ(reader.problems().total(), 0U);
  const mcap::Summary& summary = reader.summary();
  EXPECT_EQ(summary.header.profile, "ros2");
  ASSERT_EQ(summary.channels.size(), 2U) << "a topic without message too";
  const mcap::Channel& channel = summary.channels.at(1);
  EXPECT_EQ(channel.topic, "/slam/pose");
  EXPECT_EQ(channel.message_encoding, "cdr");
  EXPECT_EQ(bus::parse_offered_qos(channel.metadata.at("offered_qos_profiles")).size(), 2U);
  const mcap::Schema& schema = summary.schemas.at(channel.schema_id);
  EXPECT_EQ(schema.name, "geometry_msgs/msg/PoseStamped");
  EXPECT_EQ(schema.encoding, "ros2msg");
  const mcap::Schema& unknown = summary.schemas.at(summary.channels.at(2).schema_id);
  EXPECT_EQ(unknown.name, "Thing");
  EXPECT_EQ(unknown.data, "");
  EXPECT_EQ(summary.channels.at(2).topic, "rtd/thing");
  EXPECT_EQ(book_.topic(thing).counts.written, 0U);
  EXPECT_EQ(summary.metadata_indexes.size(), 1U);
  mcap::MessageCursor cursor = reader.messages();
  const mcap::Message* const recorded = cursor.next();
  ASSERT_NE(recorded, nullptr);
  EXPECT_EQ(recorded->log_time, 1000U);
  EXPECT_EQ(recorded->publish_time, 995U);
  EXPECT_EQ(recorded->sequence, 1U);
}

TEST_F(RecordingTest, a_type_that_is_not_built_in_is_described_by_what_the_book_learns) {
  const ros2::TypeDefinition laser{"vendor_msgs/msg/Laser", "ros2msg", "float32 range\n"};
  const std::size_t before = book_.find_or_add("rt/front", "vendor_msgs::msg::dds_::Laser_");
  EXPECT_FALSE(book_.knows("vendor_msgs::msg::dds_::Laser_"));
  book_.learn("vendor_msgs::msg::dds_::Laser_", laser);
  book_.learn("vendor_msgs::msg::dds_::Laser_", {"vendor_msgs/msg/Laser", "ros2msg", "another"});
  EXPECT_TRUE(book_.knows("vendor_msgs::msg::dds_::Laser_"));
  const std::size_t after = book_.find_or_add("rt/back", "vendor_msgs::msg::dds_::Laser_");
  for (const std::size_t topic : {before, after}) EXPECT_EQ(book_.topic(topic).type.text, laser.text);
  book_.learn("geometry_msgs::msg::dds_::PoseStamped_", laser);
  EXPECT_NE(book_.topic(book_.find_or_add("rt/p", "geometry_msgs::msg::dds_::PoseStamped_")).type.text, laser.text);
}

TEST_F(RecordingTest, each_part_of_a_split_recording_stands_alone) {
  const std::size_t pose = book_.find_or_add("rt/slam/pose", "geometry_msgs::msg::dds_::PoseStamped_");
  RecordingOptions options;
  options.split.bytes = 20'000;
  begin(options);
  for (std::uint64_t i = 0; i < 100; ++i) recording_->write(message(pose, 1000, 1000 + i), 0);
  recording_->finish({});

  ASSERT_GT(disks_.size(), 4U);
  std::uint64_t messages = 0, bytes = 0;
  for (std::size_t i = 0; i < disks_.size(); ++i) {
    EXPECT_LT(disks_[i]->position(), 24'000U) << "the summary comes on top";
    EXPECT_EQ(messages_in(i), recording_->files()[i].messages);
    messages += messages_in(i);
    bytes += disks_[i]->position();
  }
  EXPECT_EQ(messages, 100U);
  EXPECT_EQ(recording_->bytes(), bytes);
  sync_.finish();
  EXPECT_EQ(sync_.acknowledged().messages.at(pose), 100U);
  EXPECT_EQ(sync_.acknowledged().bytes, bytes);
}

TEST_F(RecordingTest, a_full_disk_keeps_what_was_written) {
  const std::size_t pose = book_.find_or_add("rt/slam/pose", "geometry_msgs::msg::dds_::PoseStamped_");
  disk_size_ = 50'000;
  RecordingOptions options;
  options.chunk_bytes = 4000;
  begin(options);
  const auto fill = [&] {
    for (std::uint64_t i = 0; i < 100; ++i) recording_->write(message(pose, 1000, 1000 + i), 0);
  };
  EXPECT_THROW(fill(), io::IoError);
  EXPECT_THROW(recording_->finish({}), io::IoError);
  sync_.finish();
  const std::uint64_t acknowledged = sync_.acknowledged().messages.at(pose);
  EXPECT_GT(acknowledged, 30U);
  EXPECT_EQ(messages_in(0), acknowledged);
}

TEST_F(RecordingTest, metadata_yaml_is_what_rosbag2_reads) {
  const std::size_t pose = book_.find_or_add("rt/slam/pose", "geometry_msgs::msg::dds_::PoseStamped_");
  book_.add_offer(pose, {});
  begin();
  recording_->write(message(pose, 64, 1000), 0);
  recording_->write(message(pose, 64, 4000), 0);
  recording_->finish({});

  const YAML::Node bag =
      YAML::Load(bag_metadata_text({"run_0.mcap"}, recording_->files(), book_.topics()))["rosbag2_bagfile_information"];
  EXPECT_EQ(bag["version"].as<int>(), 5);
  EXPECT_EQ(bag["storage_identifier"].as<std::string>(), "mcap");
  EXPECT_EQ(bag["duration"]["nanoseconds"].as<std::uint64_t>(), 3000U);
  EXPECT_EQ(bag["starting_time"]["nanoseconds_since_epoch"].as<std::uint64_t>(), 1000U);
  EXPECT_EQ(bag["message_count"].as<int>(), 2);
  EXPECT_EQ(bag["compression_format"].as<std::string>(), "");
  EXPECT_EQ(bag["relative_file_paths"].as<std::vector<std::string>>(), std::vector<std::string>{"run_0.mcap"});
  EXPECT_EQ(bag["files"][0]["path"].as<std::string>(), "run_0.mcap");
  EXPECT_EQ(bag["files"][0]["message_count"].as<int>(), 2);
  const YAML::Node topic = bag["topics_with_message_count"][0];
  EXPECT_EQ(topic["message_count"].as<int>(), 2);
  EXPECT_EQ(topic["topic_metadata"]["name"].as<std::string>(), "/slam/pose");
  EXPECT_EQ(topic["topic_metadata"]["type"].as<std::string>(), "geometry_msgs/msg/PoseStamped");
  EXPECT_EQ(topic["topic_metadata"]["offered_qos_profiles"].as<std::string>(), bus::offered_qos_text({bus::RawQos{}}));
}

}  // namespace
}  // namespace rtd::recorder
