// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <lz4.h>
#include <zstd.h>

#include "common/mcap/writer.hpp"

namespace rtd::mcap {
namespace {

/// Two files with everything that a writer can write: three topics in several chunks, an attachment, metadata, a split.
Bytes written_with(const WriterOptions& options) {
  io::MemorySink first, second;
  Writer writer(first, options);
  const SchemaId pose = writer.add(Schema{0, "geometry_msgs/msg/PoseStamped", "ros2msg", "Header header"});
  const ChannelId channels[] = {writer.add(Channel{0, pose, "/camera_pose", "cdr", {{"qos", "- depth: 10"}}}),
                                writer.add(Channel{0, 0, "/raw", "", {}}),
                                writer.add(Channel{0, pose, "/odom", "cdr", {{"a", "1"}, {"b", "2"}}})};
  std::uint32_t state = 1;
  for (std::uint32_t i = 0; i < 400; ++i) {
    std::string data(i * 7 % 90, '\0');
    for (char& byte : data) byte = static_cast<char>((state = state * 1664525 + 1013904223) >> 27);
    writer.write(Message{channels[i % 3], i, 1000 + 10 * i, 990 + 10 * i, io::bytes_of(data)});
    if (i == 100) writer.write(Attachment{5, 6, "calibration.yaml", "text/yaml", io::bytes_of("fx: 525"), 0});
    if (i == 200) writer.write(Metadata{"run", {{"mode", "rtd"}}});
    if (i == 300) writer.split(second);
    if (i % 150 == 60) writer.end_chunk();
  }
  writer.close();
  Bytes both = first.bytes();
  both.insert(both.end(), second.bytes().begin(), second.bytes().end());
  return both;
}

struct Expected {
  Compression compression;
  bool self_contained_chunks;
  std::size_t size;
  std::uint32_t crc;
};

class WriterIdentity : public testing::TestWithParam<Expected> {};

TEST_P(WriterIdentity, same_messages_give_the_same_bytes_as_ever) {
  const auto [compression, self_contained_chunks, size, crc] = GetParam();
  if (compression == Compression::kLz4 && LZ4_versionNumber() != 10904) GTEST_SKIP() << "recorded with LZ4 1.9.4";
  if (compression == Compression::kZstd && ZSTD_versionNumber() != 10504) GTEST_SKIP() << "recorded with zstd 1.5.4";
  WriterOptions options{.profile = "ros2", .library = "test", .compression = compression, .chunk_size = 2048};
  options.self_contained_chunks = self_contained_chunks;
  const Bytes bytes = written_with(options);
  EXPECT_EQ(bytes.size(), size);
  EXPECT_EQ(io::crc32(bytes), crc);
}

INSTANTIATE_TEST_SUITE_P(Compressions, WriterIdentity,
                         testing::Values(Expected{Compression::kNone, false, 41732, 0x9bc54b36},
                                         Expected{Compression::kNone, true, 46825, 0xe9b775cd},
                                         Expected{Compression::kLz4, false, 37644, 0x31484829},
                                         Expected{Compression::kLz4, true, 41133, 0x1e96d7ce},
                                         Expected{Compression::kZstd, false, 29382, 0x90c888e9},
                                         Expected{Compression::kZstd, true, 32620, 0x11d9ce85}));

}  // namespace
}  // namespace rtd::mcap
