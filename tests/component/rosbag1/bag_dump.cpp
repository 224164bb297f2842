// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// bag_dump FILE: "time topic type bytes fnv1a" for each message, oldest first; damages on stderr.
#include <cinttypes>
#include <cstdio>

#include "common/rosbag1/bag_reader.hpp"

namespace {

std::uint64_t fnv1a(rtd::rosbag1::Bytes bytes) {
  std::uint64_t hash = 0xCBF29CE484222325U;
  for (const std::uint8_t byte : bytes) hash = (hash ^ byte) * 0x100000001B3U;
  return hash;
}

}  // namespace

int main(int argc, char** argv) try {
  rtd::rosbag1::BagReader reader(argc > 1 ? argv[1] : "");
  std::vector<std::string> names;
  for (const auto& topic : reader.topics()) names.push_back(topic.name);
  for (const auto& place : reader.messages(names)) {
    const auto bytes = reader.read(place);
    const auto& connection = reader.connections().at(place.connection);
    std::printf("%" PRId64 " %s %s %zu %016" PRIx64 "\n", place.time_ns, connection.topic.c_str(),
                connection.type.c_str(), bytes.size(), fnv1a(bytes));
  }
  for (const std::string& damage : reader.damages()) std::fprintf(stderr, "%s\n", damage.c_str());
  return 0;
} catch (const rtd::rosbag1::BagError& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
