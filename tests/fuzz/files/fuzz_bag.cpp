// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// Changed ROS 1 bags: no exception but BagError.
#include <fmt/format.h>
#include <filesystem>

#include "common/ros_codec/message_definition.hpp"
#include "common/rosbag1/bag_reader.hpp"
#include "tests/fuzz/fuzz_loop.hpp"
#include "tests/support/rosbag1/bag_writer.hpp"

namespace rtd::rosbag1 {
namespace {

namespace fs = std::filesystem;

struct Counted {
  std::uint64_t bags = 0, messages = 0, sum = 0;
};

/// Two topics, three chunks.
test::BagWriter sample(const std::string& compression) {
  test::BagWriter bag(compression);
  const auto a = bag.connection("/a", "std_msgs/A", "Header h\n===\nMSG: std_msgs/Header\nuint32 seq\n"),
             b = bag.connection("/b", "std_msgs/B");
  for (std::int64_t i = 1; i < 8; ++i) {
    const std::vector<std::uint8_t> content(static_cast<std::size_t>(40 * i), static_cast<std::uint8_t>(i));
    bag.message(i % 2 == 0 ? a : b, i * 1'000'000'000, content);
    if (i % 3 == 0) bag.end_chunk();
  }
  return bag;
}

std::vector<io::Bytes> seeds() {
  std::vector<io::Bytes> files;
  for (const char* compression : {"none", "bz2", "lz4"}) {
    files.push_back(fuzz::bytes_of(sample(compression).closed()));
    files.push_back(fuzz::bytes_of(sample(compression).killed()));
  }
  return files;
}

void read_definitions(const BagReader& reader) {
  for (const auto& [id, connection] : reader.connections()) {
    try {
      ros::parse_definition(connection.type, connection.definition);
    } catch (const ros::DefinitionError&) {
    }
  }
}

void read_all(const fs::path& path, Counted& counted) {
  BagReader reader(path);
  ++counted.bags;
  read_definitions(reader);
  std::vector<std::string> names;
  for (const Topic& topic : reader.topics()) names.push_back(topic.name);
  for (const MessagePlace& place : reader.messages(names)) {
    try {
      for (const std::uint8_t byte : reader.read(place)) counted.sum += byte;  // touches each byte
      ++counted.messages;
    } catch (const BagError&) {
    }
  }
}

std::string try_input(const fuzz::FuzzFile& file, const io::Bytes& input, Counted& counted) {
  file.write(input);
  try {
    read_all(file.path(), counted);
  } catch (const BagError&) {
  }
  return "";
}

}  // namespace
}  // namespace rtd::rosbag1

int main(int argc, char** argv) {
  using namespace rtd;
  const std::vector<io::Bytes> files = rosbag1::seeds();
  const fuzz::FuzzFile file(".bag");
  rosbag1::Counted counted;
  return fuzz::run_fuzz(
      argc, argv,
      {.failed_path = "fuzz_bag_failed.bag",
       .make = [&](fuzz::Random& random) { return fuzz::mutate_one(files, random); },
       .test = [&](const io::Bytes& input, fuzz::Random&) { return rosbag1::try_input(file, input, counted); },
       .counted = [&] { return fmt::format("bags opened {}, messages read {}", counted.bags, counted.messages); }});
}
