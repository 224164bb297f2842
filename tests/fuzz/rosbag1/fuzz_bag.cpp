// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// Feeds changed ROS 1 bags to the reader: fuzz_bag [inputs] [seed]. What must hold for every input: no crash, no
/// sanitizer report, bounded memory, no exception but BagError. Exit code 1 and the input in fuzz_bag_failed.bag
/// otherwise. The preset asan-ubsan gives it its teeth.
#include <unistd.h>

#include <filesystem>

#include "common/ros_codec/message_definition.hpp"
#include "common/rosbag1/bag_reader.hpp"
#include "tests/fuzz/fuzz_loop.hpp"
#include "tests/fuzz/mcap/mutation.hpp"
#include "tests/support/rosbag1/bag_writer.hpp"

namespace rtd::rosbag1 {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxAllocated = 64 << 20;  // chunks of false size are unpacked into 4 MiB and doubled

struct Counted {
  std::uint64_t bags = 0, messages = 0, sum = 0;
};

io::Bytes bytes_of(const std::string& text) {
  const auto bytes = io::bytes_of(text);
  return {bytes.begin(), bytes.end()};
}

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
    files.push_back(bytes_of(sample(compression).closed()));
    files.push_back(bytes_of(sample(compression).killed()));
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

std::string try_input(const fs::path& path, const io::Bytes& input, Counted& counted) {
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(input.data()), static_cast<std::streamsize>(input.size()));
  try {
    read_all(path, counted);
  } catch (const BagError&) {
  }
  if (const std::size_t peak = rtd::testing::peak_allocation(); peak > kMaxAllocated)
    return "it made the reader hold " + std::to_string(peak) + " bytes";
  return "";
}

}  // namespace
}  // namespace rtd::rosbag1

int main(int argc, char** argv) {
  using namespace rtd;
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("rtd_fuzz_" + std::to_string(getpid()) + ".bag");
  const std::vector<io::Bytes> files = rosbag1::seeds();
  rosbag1::Counted counted;
  const int result = rtd::testing::run_fuzz(
      argc, argv, "fuzz_bag_failed.bag",
      [&](std::mt19937_64& random) {
        return mcap::mutate(files[random() % files.size()], files[random() % files.size()], random);
      },
      [&](const io::Bytes& input, std::mt19937_64&) { return rosbag1::try_input(path, input, counted); },
      [&] {
        return "bags opened " + std::to_string(counted.bags) + ", messages read " + std::to_string(counted.messages);
      });
  std::filesystem::remove(path);
  return result;
}
