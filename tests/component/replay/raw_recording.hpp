// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <condition_variable>
#include <cstring>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "common/bus/offered_qos.hpp"
#include "common/bus/raw_bus.hpp"
#include "common/bus/robot.hpp"
#include "common/mcap/writer.hpp"
#include "common/ros2/names.hpp"

namespace rtd::replay {

/// A message as a recording has it, or as it came.
struct Piece {
  std::string topic;  ///< as DDS has it
  std::int64_t log_ns = 0, publish_ns = 0;
  std::string cdr;
  std::string encoding = "cdr";  ///< of its channel: that of the first piece of the topic
};

/// "\0\1\0\0" and the rest of a little-endian sample.
inline std::string cdr_of(const std::string& fields) {
  return std::string("\0\1\0\0", 4) + fields;
}
inline std::string cdr_of(std::uint64_t seq, std::size_t bytes) {
  std::string fields(std::max(bytes, sizeof(seq)), '\0');
  for (std::size_t i = 0; i < fields.size(); ++i) fields[i] = static_cast<char>(seq * 31 + i * 7);
  std::memcpy(fields.data(), &seq, sizeof(seq));
  return cdr_of(fields);
}

inline std::string type_of(const std::string& topic) {
  if (topic == "rtd/frame") return "rtd_msgs::msg::dds_::RgbdFrame_";
  if (topic == "rtd/tracking") return "rtd_msgs::msg::dds_::TrackingResult_";
  if (topic == "rtd/features") return "rtd_msgs::msg::dds_::FeatureFrame_";
  return "test_msgs::msg::dds_::Blob_";
}

/// Writes a recording as rtd record does: names of ROS 2, QoS in the channel. `idl`: text of the types, not kept when
/// empty.
inline void write_recording(const std::string& path, const std::vector<Piece>& pieces, bool reliable = true,
                            const std::string& idl = "") {
  io::FileSink sink(path, io::IfExists::kReplace);
  mcap::Writer writer(sink, {.profile = "ros2", .chunk_size = 20'000});
  std::map<std::string, mcap::ChannelId> channels;
  bus::RawQos qos;
  qos.reliable = reliable;
  for (const Piece& piece : pieces) {
    if (!channels.contains(piece.topic)) {
      const mcap::SchemaId schema =
          writer.add(mcap::Schema{0, ros2::ros_type(type_of(piece.topic)), idl.empty() ? "" : "omgidl", idl});
      channels[piece.topic] = writer.add(mcap::Channel{0,
                                                       schema,
                                                       ros2::ros_topic(piece.topic),
                                                       piece.encoding,
                                                       {{"offered_qos_profiles", bus::offered_qos_text({qos})}}});
    }
    writer.write(mcap::Message{channels.at(piece.topic), 1, static_cast<mcap::Timestamp>(piece.log_ns),
                               static_cast<mcap::Timestamp>(piece.publish_ns), io::bytes_of(piece.cdr)});
  }
  writer.close();
}

/// Records whatever appears in a domain, as rtd record does.
class Recorder {
 public:
  explicit Recorder(bus::RawBus& bus) : bus_(bus) {
    bus_.watch([this](const bus::TopicWriter& writer, bus::WriterChange change) { listen(writer, change); });
  }
  ~Recorder() {
    bus_.watch(nullptr);
    readers_.clear();
  }

  /// What came, in order, once there are so many or none has come for long.
  std::vector<Piece> wait(std::size_t count, std::chrono::seconds patience = std::chrono::seconds(20)) {
    std::unique_lock lock(mutex_);
    came_.wait_for(lock, patience, [&] { return pieces_.size() >= count; });
    return pieces_;
  }

 private:
  void listen(const bus::TopicWriter& writer, bus::WriterChange change) {
    if (change != bus::WriterChange::kAppeared || writer.topic.name == "rtd/status") return;
    const std::string topic = writer.topic.name;
    if (bus::is_internal_to_ros(topic)) return;
    if (readers_.contains(topic)) return;
    EXPECT_EQ(writer.topic.type, topic == "rt/clock" ? "rosgraph_msgs::msg::dds_::Clock_" : type_of(topic));
    bus::RawHandlers handlers;
    handlers.on_sample = [this, topic](const bus::RawSample& sample) {
      const std::lock_guard lock(mutex_);
      pieces_.push_back({topic, sample.received_ns, sample.source_ns,
                         std::string(reinterpret_cast<const char*>(sample.cdr().data()), sample.cdr().size()), "cdr"});
      came_.notify_all();
    };
    readers_[topic] = bus_.reader(writer.topic, {.reliable = writer.qos.reliable, .depth = 4096}, std::move(handlers));
  }

  bus::RawBus& bus_;
  std::mutex mutex_;
  std::condition_variable came_;
  std::vector<Piece> pieces_;
  std::map<std::string, std::unique_ptr<bus::RawReader>> readers_;
};

inline std::vector<Piece> of_topic(const std::vector<Piece>& pieces, const std::string& topic) {
  std::vector<Piece> found;
  for (const Piece& piece : pieces)
    if (piece.topic == topic) found.push_back(piece);
  return found;
}

/// The same payloads with the same publish times in the same order.
inline void expect_same(const std::vector<Piece>& recorded, const std::vector<Piece>& again, const std::string& topic) {
  const std::vector<Piece> a = of_topic(recorded, topic), b = of_topic(again, topic);
  ASSERT_EQ(a.size(), b.size()) << topic;
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_TRUE(a[i].cdr == b[i].cdr) << topic << " message " << i;
    ASSERT_EQ(a[i].publish_ns, b[i].publish_ns) << topic << " message " << i;
  }
}

}  // namespace rtd::replay
