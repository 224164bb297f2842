// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/launcher/run/run_command.hpp"

#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>

namespace rtd::launcher {
namespace {

namespace fs = std::filesystem;

class TraceFileTest : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(parts_); }
  void TearDown() override { fs::remove_all(folder_); }
  void part(const std::string& name, const std::string& text) { std::ofstream(parts_ / name) << text; }
  std::string joined() {
    std::stringstream text;
    text << std::ifstream(folder_ / "trace.json").rdbuf();
    return text.str();
  }

  const fs::path folder_ = fs::temp_directory_path() / ("rtd_trace_" + std::to_string(getpid()));
  const fs::path parts_ = folder_ / "parts";
};

TEST_F(TraceFileTest, joins_the_parts_and_removes_them) {
  part("slam.2.jsonl", "{\"name\":\"b\",\"args\":{}}\n");
  part("filter.1.jsonl", "{\"name\":\"a\",\"args\":{}}\n");
  EXPECT_EQ(join_trace(parts_, folder_ / "trace.json"), "");
  EXPECT_EQ(joined(),
            "{\"displayTimeUnit\":\"ms\",\"traceEvents\":[\n{\"name\":\"a\",\"args\":{}},\n{\"name\":\"b\",\"args\":{}}"
            "\n]}\n");
  EXPECT_FALSE(fs::exists(parts_));
}

TEST_F(TraceFileTest, leaves_out_what_a_killed_process_did_not_finish) {
  part("slam.2.jsonl", "{\"name\":\"b\",\"args\":{}}\n{\"name\":\"c\",\"ar");
  EXPECT_EQ(join_trace(parts_, folder_ / "trace.json"), "");
  EXPECT_THAT(joined(), testing::Not(testing::HasSubstr("\"c\"")));
}

TEST_F(TraceFileTest, says_what_it_cannot_do) {
  EXPECT_THAT(join_trace(folder_ / "none", folder_ / "trace.json"), testing::HasSubstr("No such file"));
  EXPECT_THAT(join_trace(parts_, folder_ / "none/trace.json"),
              testing::HasSubstr("none/trace.json: there is no such folder"));
}

}  // namespace
}  // namespace rtd::launcher
