// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <fstream>
#include <regex>

#include "tests/dataset/mcap/conformance_case.hpp"
#include "tests/support/run_command.hpp"

namespace rtd::mcap {
namespace {

constexpr std::size_t kCases = 416;

std::string read_text(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// SHA-256 that a Git LFS pointer names; empty when the file is the real one.
std::string sha256_of_pointer(const std::string& content) {
  static const std::regex kPointer("version https://git-lfs.*\noid sha256:([0-9a-f]{64})\nsize ([0-9]+)\n");
  std::smatch match;
  return std::regex_match(content, match, kPointer) ? match[1].str() : "";
}

class Conformance : public ::testing::Test {
 protected:
  void SetUp() override {
    if (cases().empty()) GTEST_SKIP() << "RTD_DATA_DIR has no mcap_conformance";
    ASSERT_EQ(cases().size(), kCases);
  }
  static const std::vector<ConformanceCase>& cases() {
    static const std::vector<ConformanceCase> kAll = conformance_cases();
    return kAll;
  }
};

TEST_F(Conformance, writes_every_file_byte_by_byte) {
  const std::filesystem::path folder = std::filesystem::path(::testing::TempDir()) / "mcap_conformance";
  std::filesystem::create_directories(folder);
  std::ofstream sums(folder / "sums");
  std::size_t by_sum = 0;
  for (const ConformanceCase& test : cases()) {
    const Bytes ours = write_case(test);
    const std::string theirs = read_text(test.mcap);
    const std::string sum = sha256_of_pointer(theirs);
    if (sum.empty()) {
      EXPECT_TRUE(std::ranges::equal(ours, io::bytes_of(theirs))) << test.name;
      continue;
    }
    const std::filesystem::path file = folder / (test.name + ".mcap");
    std::ofstream(file, std::ios::binary)
        .write(reinterpret_cast<const char*>(ours.data()), static_cast<std::streamsize>(ours.size()));
    sums << sum << "  " << file.string() << '\n';
    ++by_sum;
  }
  sums.close();
  if (by_sum > 0) {
    const rtd::testing::CommandResult check =
        rtd::testing::run_command("sha256sum --strict --quiet -c '" + (folder / "sums").string() + "'");
    EXPECT_EQ(check.exit_code, 0) << check.output;
  }
  std::filesystem::remove_all(folder);
}

// The files are those that the test above has shown to be the set's, byte by byte.
TEST_F(Conformance, reads_every_file_as_the_set_says) {
  for (const ConformanceCase& test : cases()) {
    const Bytes file = write_case(test);
    std::string problems;
    EXPECT_EQ(read_case(file, problems), test.records) << test.name;
    EXPECT_EQ(problems, "") << test.name;
  }
}

TEST_F(Conformance, finds_the_messages_of_every_file_by_time) {
  for (const ConformanceCase& test : cases()) {
    std::string problems;
    EXPECT_EQ(read_case_by_index(write_case(test), problems), messages_by_time(test)) << test.name;
    EXPECT_EQ(problems, "") << test.name;
  }
}

}  // namespace
}  // namespace rtd::mcap
