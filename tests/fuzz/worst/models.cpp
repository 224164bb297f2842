// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>

#include "common/geometry/transform_log.hpp"
#include "common/io/byte_sink.hpp"
#include "common/occupancy/octomap_file.hpp"
#include "common/ros2/message_json.hpp"
#include "common/ros2/ros1_to_cdr.hpp"
#include "services/camera/openni2/oni_file.hpp"
#include "services/detector/core/onnx_file.hpp"
#include "services/slam/core/store/map_store.hpp"
#include "tests/fuzz/worst/worst_case.hpp"
#include "tests/support/rosbag1/bag_writer.hpp"
#include "tests/support/sample_map.hpp"

namespace rtd::worst {
namespace {

namespace fs = std::filesystem;

Case of_text(const std::string& name, const std::string& content, const std::function<void(const std::string&)>& read) {
  const auto shared = std::make_shared<const std::string>(content);
  return {name, [shared, read] { read(*shared); }};
}

void read_octomap(const std::string& content) {
  std::istringstream in(content);
  occupancy::read_octomap(in);
}

/// Each node of the twelfth level, whose cells are a block, has one child.
std::string octomap_of_blocks(std::size_t bytes) {
  std::string nodes;
  const std::function<void(int)> fill = [&](int depth) {
    if (nodes.size() > bytes || depth > 12) {
      nodes += std::string("\0\0", 2);
    } else if (depth == 12) {
      nodes += std::string("\x01\0", 2);
    } else {
      nodes += std::string("\xFF\xFF", 2);
      for (int child = 0; child < 8; ++child) fill(depth + 1);
    }
  };
  fill(0);
  return "# Octomap OcTree binary file\nid OcTree\nsize 9\nres 0.05\ndata\n" + nodes;
}

std::string map_file(std::size_t bytes, std::uint32_t keyframes) {
  const auto each = static_cast<std::uint32_t>(1 + bytes / keyframes / 140);
  io::MemorySink sink;
  slam::write_map(
      slam::take_snapshot(test_support::sample_map(
          {.keyframes = keyframes, .features = each + 1, .seen_per_keyframe = each, .new_per_keyframe = 1, .seed = 1})),
      sink);
  return {reinterpret_cast<const char*>(sink.bytes().data()), sink.bytes().size()};
}

void read_map(const std::string& content) {
  const io::MemorySource source(io::bytes_of(content));
  const slam::Map map(slam::read_map(source));
}

std::string field(int number, const std::string& content) {
  std::string text(1, static_cast<char>(number << 3 | 2));
  std::size_t size = content.size();
  for (; size > 127; size >>= 7) text += static_cast<char>((size & 127) | 128);
  return text + static_cast<char>(size) + content;
}

void read_onnx(const std::string& content) {
  detector::read_onnx_file(reinterpret_cast<const std::uint8_t*>(content.data()), content.size());
}

std::string oni(std::size_t bytes) {
  const auto number = [](std::uint64_t value) { return test::little_endian(value, 4); };
  const std::string record = number(0x0052494E) + number(1) + number(0) + number(28) + number(0) + std::string(8, '\0');
  return "NI10" + number(1) + std::string(16, '\0') + repeated(record, bytes);
}

/// Arrays of arrays of nothing.
ros::MessageFields arrays(int levels) {
  ros::MessageFields types;
  for (int i = 0; i < levels; ++i)
    types["a/T" + std::to_string(i)] = {{"a/T" + std::to_string(i + 1), "a", ros::MessageField::Kind::kArray, 1000}};
  types["a/T" + std::to_string(levels)] = {};
  return types;
}

/// A frame below a frame below a frame, and as many stamps of the last.
void read_transforms(std::size_t bytes) {
  geometry::TransformLog log;
  const std::size_t count = bytes / 200;
  for (std::size_t i = 0; i < 2 * count; ++i) {
    msg::TFMessage message;
    msg::TransformStamped& transform = message.transforms.emplace_back();
    const std::size_t link = std::min(i, count);
    transform.header.stamp.sec = static_cast<std::int32_t>(i);
    transform.header.frame_id = link == 0 ? "world" : "f" + std::to_string(link - 1);
    transform.child_frame_id = "f" + std::to_string(link);
    transform.transform.rotation.w = 1;
    log.add(message);
  }
  for (std::size_t i = 0; i < count; ++i) log.world_pose("f" + std::to_string(count), static_cast<std::int64_t>(i), 1);
  log.between("f" + std::to_string(count), "x");
}

}  // namespace

std::vector<Case> models(std::size_t bytes, const fs::path& folder) {
  const std::vector<std::uint8_t> message(bytes / 2);
  const std::string node = field(1, field(1, "a") + field(1, "b") + field(4, "Reshape"));
  return {of_text("OctoMap: blocks", octomap_of_blocks(bytes), read_octomap),
          of_text("OctoMap: deep",
                  "# Octomap OcTree binary file\nid OcTree\nsize 9\nres 0.05\ndata\n" + repeated("\xFF\xFF", bytes),
                  read_octomap),
          of_text("OctoMap: cells",
                  "# Octomap OcTree binary file\nid OcTree\nsize 9\nres 0.05\ndata\n" + repeated("\x55\xD5", bytes),
                  read_octomap),
          of_text("OctoMap: one line", "# Octomap OcTree binary file\n" + repeated("i", bytes), read_octomap),
          of_text("map: 100 keyframes", map_file(bytes, 100), read_map),
          of_text("map: 900 keyframes", map_file(bytes, 900), read_map),
          of_text("network: nodes", field(7, repeated(node, bytes)), read_onnx),
          of_text("network: fields", field(7, field(1, repeated(field(1, ""), bytes))), read_onnx),
          of_text("network: metadata", repeated(field(14, ""), bytes), read_onnx),
          {"OpenNI2: records", [file = file_of(folder, "a.oni", oni(bytes))] { camera::require_oni_file(file); }},
          {"message: arrays of nothing as JSON",
           [message] {
             for (int i = 0; i < 1000; ++i) {
               try {
                 ros2::message_json(arrays(40), "a/T0", ros::Wire::kRos1, ros::Bytes(message).first(16), 100);
               } catch (const ros::WireError&) {
               }
             }
           }},
          {"message: arrays of nothing as CDR", [message] { ros2::Ros1ToCdr("a/T0", arrays(40))(message); }},
          {"transforms: one below the other", [bytes] { read_transforms(bytes); }}};
}

}  // namespace rtd::worst
