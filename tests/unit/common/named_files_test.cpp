// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/io/named_files.hpp"

#include <gmock/gmock.h>
#include <sys/stat.h>

#include <fstream>
#include <string>

#include "tests/unit/evaluation/temporary_folder.hpp"

namespace rtd::io {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr FileKind kMaps{"map", ".rtdmap", "RTDMAP", "--maps-dir"};

class NamedFilesTest : public ::testing::Test {
 protected:
  fs::path at(const std::string& name) const { return folder_.path() / name; }
  void put(const std::string& name, const std::string& content) const { std::ofstream(at(name)) << content; }
  std::string problem_to_read(const std::string& name) const {
    try {
      return maps_.to_read(name).string();
    } catch (const NameError& error) {
      return error.what();
    }
  }

  const eval::testing_support::TemporaryFolder folder_;
  const NamedFiles maps_{folder_.path(), kMaps};
};

TEST_F(NamedFilesTest, a_plain_name_is_a_file_of_the_folder_and_gets_its_extension) {
  EXPECT_EQ(maps_.path("room"), at("room.rtdmap"));
  EXPECT_EQ(maps_.path("room.rtdmap"), at("room.rtdmap"));
  EXPECT_EQ(maps_.path("Floor_2-b.v1"), at("Floor_2-b.v1.rtdmap"));
}

TEST_F(NamedFilesTest, anything_else_is_refused_in_the_same_words) {
  const std::vector<std::string> hostile = {"/etc/passwd", "../up", "a/b", ".bashrc", "..", ".", "-rf", "a b", "a\nb",
                                            "a\\b", "$HOME", "~", std::string("a\0b", 3), "\xc3\xa4", "\x1b[2J",
                                            std::string(94, 'a'), "/root/none.rtdmap"};
  std::string first;
  for (const std::string& name : hostile) {
    try {
      ADD_FAILURE() << name << " became " << maps_.path(name);
    } catch (const NameError& error) {
      if (first.empty()) first = error.what();
      EXPECT_EQ(error.what(), first) << name;
    }
  }
  EXPECT_THAT(first, HasSubstr("--maps-dir"));
  EXPECT_NO_THROW(maps_.path(std::string(93, 'a')));
}

TEST_F(NamedFilesTest, without_a_folder_no_name_is_taken) {
  EXPECT_THAT([] { NamedFiles("", kMaps).path("room"); }, ThrowsMessage<NameError>(HasSubstr("--maps-dir FOLDER")));
}

TEST_F(NamedFilesTest, replaces_only_files_of_its_kind) {
  put("map.rtdmap", "RTDMAP and so on");
  put("empty.rtdmap", "");
  put("text.rtdmap", "export PATH");
  put("startup", "RTDMAP even so");
  fs::create_symlink("startup", at("link.rtdmap"));
  fs::create_symlink("nowhere", at("dangling.rtdmap"));
  fs::create_directory(at("folder.rtdmap"));
  ASSERT_EQ(::mkfifo(at("pipe.rtdmap").c_str(), 0600), 0);
  for (const char* name : {"map", "empty", "new"}) EXPECT_NO_THROW(maps_.to_write(name)) << name;
  for (const char* name : {"text", "link", "dangling", "folder", "pipe"})
    EXPECT_THAT([&] { maps_.to_write(name); }, ThrowsMessage<NameError>(HasSubstr("not replaced"))) << name;
}

TEST_F(NamedFilesTest, does_not_reveal_why_a_file_cannot_be_read) {
  put("map.rtdmap", "RTDMAP and so on");
  put("text.rtdmap", "export PATH");
  fs::create_symlink("map.rtdmap", at("link.rtdmap"));
  fs::create_symlink("/etc/passwd", at("away.rtdmap"));
  fs::create_directory(at("folder.rtdmap"));
  EXPECT_EQ(problem_to_read("map"), at("map.rtdmap").string());
  for (const std::string name : {"none", "text", "link", "away", "folder"})
    EXPECT_EQ(problem_to_read(name), "there is no readable map " + name + ".rtdmap in the folder of --maps-dir");
}

}  // namespace
}  // namespace rtd::io
