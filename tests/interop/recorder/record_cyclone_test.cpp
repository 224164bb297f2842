// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <sstream>

#include "tests/component/recorder/recorded_file.hpp"
#include "tests/component/recorder/recorder_process.hpp"
#include "tests/support/temporary_folder.hpp"

namespace rtd::recorder {
namespace {

namespace fs = std::filesystem;

constexpr const char* kOnLoopback =
    "<CycloneDDS><Domain><General><Interfaces><NetworkInterface name='lo' multicast='true'/></Interfaces>"
    "</General></Domain></CycloneDDS>";

std::uint32_t field(const ReadMessage& message, std::size_t index) {
  std::uint32_t value = 0;
  std::memcpy(&value, message.cdr.data() + 4 + 4 * index, sizeof(value));
  return value;
}

TEST(RecordCyclone, types_unknown_to_this_program_are_recorded) {
  constexpr std::uint32_t kMessages = 100;
  const rtd::test::TemporaryFolder folder;
  RecorderProcess recorder(test_domain(), {"-o", folder / "run.mcap"});
  std::ostringstream command;
  command << "CYCLONEDDS_URI=\"" << kOnLoopback << "\" timeout 30 " CYCLONE_WRITER_PATH " " << test_domain() << ' '
          << kMessages;
  ASSERT_EQ(std::system(command.str().c_str()), 0);
  EXPECT_EQ(recorder.end_by(SIGINT), 0);

  const RecordedFile file = read_recording(folder / "run.mcap");
  const auto& plain = file.topics.at("/unknown/plain");
  const auto& keyed = file.topics.at("/unknown/keyed");
  EXPECT_EQ(file.type_of.at("/unknown/plain"), "unknown_msgs/msg/Plain");
  ASSERT_EQ(plain.size(), kMessages);
  ASSERT_EQ(keyed.size(), kMessages);
  for (std::uint32_t i = 0; i < kMessages; ++i) {
    EXPECT_EQ(field(plain[i], 0), i);
    EXPECT_EQ(field(plain[i], 1), 17U);  // the length of the text and its end
    EXPECT_STREQ(reinterpret_cast<const char*>(plain[i].cdr.data() + 12), "from Cyclone DDS");
    EXPECT_EQ(field(keyed[i], 0), i % 3);
    EXPECT_EQ(field(keyed[i], 1), i);
    EXPECT_LE(plain[i].publish_time, plain[i].log_time);
  }
}

}  // namespace
}  // namespace rtd::recorder
