// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstring>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "common/mcap/writer.hpp"
#include "common/msg/rgbd_frame.hpp"
#include "common/ros_codec/wire.hpp"
#include "tests/support/rosbag1/bag_writer.hpp"

namespace rtd::camera::test {

/// An MCAP file that a test puts together.
class McapFile {
 public:
  explicit McapFile(const mcap::WriterOptions& options = {}) : writer_(sink_, options) {}

  void add(const std::string& topic, const std::string& type, const std::string& encoding,
           const std::vector<std::uint8_t>& bytes, double logged_s) {
    auto [channel, is_new] = channels_.try_emplace(topic, mcap::ChannelId{0});
    if (is_new) {
      const mcap::SchemaId schema = writer_.add(mcap::Schema{0, type, "", ""});
      channel->second = writer_.add(mcap::Channel{0, schema, topic, encoding, {}});
    }
    const auto time = static_cast<mcap::Timestamp>(logged_s * 1e9);
    writer_.write(mcap::Message{channel->second, 0, time, time, std::as_bytes(std::span(bytes))});
  }
  /// As ROS 2 records it.
  template <class Message>
  void add(const std::string& topic, const std::string& type, const Message& message, double logged_s) {
    add(topic, type, "cdr", ros::encode<ros::Wire::kCdr>(message), logged_s);
  }
  /// As our recorder writes it, `bytes` of it.
  void add_own(const msg::RgbdFrame& frame, double logged_s, std::size_t size = 4 + sizeof(msg::RgbdFrame)) {
    std::vector<std::uint8_t> bytes(4 + sizeof frame);
    bytes[1] = 1;
    std::memcpy(bytes.data() + 4, &frame, sizeof frame);
    bytes.resize(size);
    add("rtd/frame", "rtd_msgs::msg::dds_::RgbdFrame_", "cdr", bytes, logged_s);
  }
  void end_chunk() { writer_.end_chunk(); }
  std::string bytes() {
    writer_.close();
    return {reinterpret_cast<const char*>(sink_.bytes().data()), sink_.bytes().size()};
  }
  std::string uri() { return uri_of(bytes()); }
  std::string uri_of(const std::string& bytes) {
    file_.emplace("camera.mcap", bytes);
    return "mcap:" + file_->path().string();
  }

 private:
  io::MemorySink sink_;
  mcap::Writer writer_;
  std::map<std::string, mcap::ChannelId> channels_;
  std::optional<rtd::test::TemporaryFile> file_;
};

/// A frame of 20 x 10 px of the given values.
inline std::unique_ptr<msg::RgbdFrame> own_frame(std::int64_t stamp_ns, std::uint8_t grey, std::uint16_t depth) {
  auto frame = std::make_unique<msg::RgbdFrame>();
  frame->stamp_ns = stamp_ns;
  frame->intrinsics = {30, 31, 9.5, 4.5};
  frame->distortion = {0.1, 0, 0, 0, 0};
  frame->depth_scale_m = 0.0002;
  frame->width = 20;
  frame->height = 10;
  frame->source_id = 7;
  frame->color_bgr.fill(grey);
  frame->depth.fill(depth);
  return frame;
}

}  // namespace rtd::camera::test
