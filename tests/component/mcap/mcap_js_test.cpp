// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// Our files in the MCAP project's own reader with its CRC checks, and its files in ours. Needs node and
/// deploy/setup.sh --viewers; skips without.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "tests/support/run_command.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/mcap/sample_file.hpp"

namespace rtd::mcap {
namespace {

class McapJs : public ::testing::Test {
 protected:
  void SetUp() override {
    if (rtd::testing::run_command("node --version").exit_code != 0) GTEST_SKIP() << "node is not installed";
    if (!std::filesystem::is_directory(std::filesystem::path(MCAP_JS_FOLDER) / "node_modules/@mcap/core"))
      GTEST_SKIP() << "no @mcap/core in " << MCAP_JS_FOLDER << ": run deploy/setup.sh --viewers";
  }

  rtd::testing::CommandResult run(const std::string& action) const {
    return rtd::testing::run_command("timeout 60 node '" MCAP_JS_SCRIPT "' '" MCAP_JS_FOLDER "' " + action + " '" +
                                     file_.string() + "'");
  }
  const rtd::test::TemporaryFolder folder_;
  const std::filesystem::path file_ = folder_ / "a.mcap";
};

/// As the script prints them.
std::string lines_of(const std::vector<StoredMessage>& messages) {
  std::string lines;
  for (const StoredMessage& message : messages) {
    lines += message.topic + ' ' + std::to_string(message.sequence) + ' ' + std::to_string(message.log_time) + ' ' +
             std::to_string(message.publish_time) + ' ';
    for (const char c : message.data) {
      constexpr const char* kDigits = "0123456789abcdef";
      lines += {kDigits[static_cast<unsigned char>(c) / 16], kDigits[static_cast<unsigned char>(c) % 16]};
    }
    lines += '\n';
  }
  return lines;
}

TEST_F(McapJs, reads_our_files_in_file_order_and_by_index) {
  const auto messages = sample_messages(200, 100);
  for (const Compression compression : {Compression::kNone, Compression::kLz4, Compression::kZstd}) {
    WriterOptions options;
    options.profile = "ros2";
    options.compression = compression;
    options.chunk_size = 3000;
    options.self_contained_chunks = compression == Compression::kZstd;
    const Bytes bytes = file_of(messages, options);
    std::ofstream(file_, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    for (const char* const action : {"stream", "index"}) {
      const rtd::testing::CommandResult result = run(action);
      EXPECT_EQ(result.exit_code, 0) << name_of(compression) << ' ' << result.output;
      EXPECT_EQ(result.output, lines_of(messages)) << name_of(compression) << ' ' << action;
    }
  }
}

TEST_F(McapJs, sees_a_damaged_chunk) {
  Bytes bytes = file_of(sample_messages(20, 100));
  bytes[500] ^= std::byte{1};
  std::ofstream(file_, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  const rtd::testing::CommandResult result = run("stream");
  EXPECT_NE(result.exit_code, 0);
  EXPECT_NE(result.output.find("CRC"), std::string::npos) << result.output;
}

TEST_F(McapJs, writes_files_that_we_read_without_a_problem) {
  ASSERT_EQ(run("write").exit_code, 0);
  std::ifstream in(file_, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  const ReadBack streamed = stream(io::bytes_of(text));
  EXPECT_EQ(streamed.messages.size(), 50U);
  EXPECT_TRUE(streamed.problems.empty()) << texts(streamed.problems);
  const ReadBack indexed = by_index(io::bytes_of(text));
  EXPECT_EQ(indexed.messages, streamed.messages);
  EXPECT_TRUE(indexed.problems.empty()) << texts(indexed.problems);
}

}  // namespace
}  // namespace rtd::mcap
