// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/io/input_file.hpp"

#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>

#include "common/io/atomic_file.hpp"
#include "common/io/folder_walk.hpp"
#include "common/io/text.hpp"
#include "tests/support/temporary_folder.hpp"

namespace rtd::io {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

/// A folder of another person with a file "in/there.txt", and beside it a file "secret.txt".
class StrangersFolder : public ::testing::Test {
 protected:
  StrangersFolder() {
    fs::create_directories(folder_ / "in");
    write_file(folder_ / "in/there.txt", "content");
    write_file(root_ / "secret.txt", "secret");
  }

  static std::string problem(const fs::path& file, const fs::path& below = {}) {
    try {
      read_file(file, kSettings, below);
    } catch (const IoError& error) {
      return error.what();
    }
    return "";
  }

  const rtd::test::TemporaryFolder root_;
  const fs::path folder_ = root_ / "folder";
};

TEST_F(StrangersFolder, what_is_no_regular_file_is_refused_without_waiting) {
  ASSERT_EQ(mkfifo((folder_ / "pipe").c_str(), 0600), 0);
  fs::create_symlink("/dev/zero", folder_ / "zero");
  EXPECT_THAT(problem(folder_ / "pipe"),
              AllOf(HasSubstr("folder/pipe: is a pipe, not a regular file"), HasSubstr("put the file itself there")));
  EXPECT_THAT(problem(folder_ / "zero"), HasSubstr("folder/zero: is a device, not a regular file"));
  EXPECT_THAT(problem(folder_ / "in"), HasSubstr("folder/in: this is a folder: name a file in it"));
  EXPECT_THAT(problem(folder_ / "none"), HasSubstr("folder/none cannot be read: No such file"));
  EXPECT_EQ(try_open(folder_ / "pipe"), nullptr);
  EXPECT_EQ(read_file(folder_ / "in/there.txt", kSettings), "content");
}

TEST_F(StrangersFolder, more_than_a_kind_of_file_has_is_not_read) {
  write_file(folder_ / "sparse", "");
  fs::resize_file(folder_ / "sparse", 30'000 * kMegabyte);
  EXPECT_THAT(problem(folder_ / "sparse"),
              AllOf(HasSubstr("sparse: has 30 GB, at most 4 MB are read as settings"), HasSubstr("the right file")));
  fs::resize_file(folder_ / "sparse", kSettings.most_bytes);
  EXPECT_EQ(read_file(folder_ / "sparse", kSettings).size(), kSettings.most_bytes);
  fs::resize_file(folder_ / "sparse", kSettings.most_bytes + 1);
  EXPECT_THAT(problem(folder_ / "sparse"), HasSubstr("at most 4 MB"));
  EXPECT_THAT(read_file("/proc/self/status", kKernelText), HasSubstr("Name:")) << "has 0 bytes, the kernel says";
}

TEST_F(StrangersFolder, a_pipe_that_the_user_has_handed_over_is_read_to_its_end) {
  std::array<int, 2> ends{};
  ASSERT_EQ(pipe(ends.data()), 0);
  ASSERT_EQ(write(ends[1], "poses", 5), 5);
  close(ends[1]);
  EXPECT_EQ(read_file("/dev/fd/" + std::to_string(ends[0]), kPoses), "poses");
  fs::create_symlink("/dev/fd/" + std::to_string(ends[0]), folder_ / "link");
  EXPECT_THAT(problem(folder_ / "link"), HasSubstr("is a pipe")) << "named by the folder, not by the user";
  close(ends[0]);
}

TEST_F(StrangersFolder, links_that_stay_in_the_folder_are_followed) {
  fs::create_symlink("in/there.txt", folder_ / "relative");
  fs::create_symlink(folder_ / "in", folder_ / "absolute");
  fs::create_symlink("../in", folder_ / "in/again");
  for (const char* name :
       {"in/there.txt", "relative", "absolute/there.txt", "in/again/again/there.txt", "in/../relative"})
    EXPECT_EQ(read_file(folder_ / name, kSettings, folder_), "content") << name;
}

TEST_F(StrangersFolder, what_leads_out_is_refused_in_the_same_words_whether_or_not_it_is_there) {
  fs::create_symlink("../secret.txt", folder_ / "link");
  fs::create_symlink("..", folder_ / "up");
  fs::create_symlink("../nothing", folder_ / "dangling");
  fs::create_symlink(root_ / "secret.txt", folder_ / "absolute");
  for (const fs::path name : {"../secret.txt", "../nothing", "link", "dangling", "absolute", "up/secret.txt",
                              "up/nothing", "in/../../secret.txt", "/etc/passwd", "/nothing/at/all"}) {
    const fs::path file = folder_ / name;
    EXPECT_EQ(problem(file, folder_), file.string() + ": leads out of the folder " + folder_.string() +
                                          ", below which the files of others must lie");
  }
  EXPECT_EQ(read_file(folder_ / "link", kSettings), "secret") << "where the user allows it";
  fs::create_symlink("circle", folder_ / "circle");
  EXPECT_THAT(problem(folder_ / "circle", folder_), HasSubstr("cannot be read: Too many levels"));
}

TEST_F(StrangersFolder, a_walk_reads_a_folder_once_whatever_names_it_has) {
  fs::create_directories(folder_ / "maze");
  for (int i = 0; i < 64; ++i) fs::create_symlink(".", folder_ / "maze" / ("d" + std::to_string(i)));
  FolderWalk walk(folder_);
  EXPECT_TRUE(walk.enter(folder_ / "maze"));
  for (const FolderEntry& entry : walk.entries(folder_ / "maze")) {
    EXPECT_TRUE(entry.is_folder);
    EXPECT_FALSE(walk.enter(folder_ / "maze" / entry.name));
    EXPECT_EQ(walk.entries(folder_ / "maze" / entry.name).size(), 64U);
  }
  EXPECT_EQ(walk.seen(), 64U);
}

TEST_F(StrangersFolder, a_walk_gives_up_beyond_its_bound_and_names_the_folder) {
  for (int i = 0; i < 5; ++i) write_file(folder_ / "in" / std::to_string(i), "");
  FolderWalk walk(folder_, 5);
  try {
    walk.entries(folder_ / "in");
    FAIL();
  } catch (const IoError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("folder/in: more than 5 files"), HasSubstr("name the folder")));
  }
}

TEST_F(StrangersFolder, a_walk_does_not_leave_its_folder) {
  fs::create_symlink("..", folder_ / "up");
  FolderWalk walk(folder_);
  EXPECT_THAT(walk.paths(folder_), ElementsAre(folder_ / "in", folder_ / "up"));
  EXPECT_FALSE(walk.entries(folder_)[1].is_folder);
  EXPECT_TRUE(walk.entries(folder_ / "up").empty());
  EXPECT_EQ(walk.led_out(), folder_ / "up");
  EXPECT_TRUE(FolderWalk().entries(folder_)[1].is_folder);
}

TEST_F(StrangersFolder, a_line_has_an_end) {
  write_file(root_ / "lines", "one\n\ntwo");
  InputStream lines(root_ / "lines");
  std::string line;
  EXPECT_TRUE(get_line(lines, line) && line == "one");
  EXPECT_TRUE(get_line(lines, line) && line.empty());
  EXPECT_TRUE(get_line(lines, line) && line == "two");
  EXPECT_FALSE(get_line(lines, line));
  fs::resize_file(root_ / "lines", 30'000 * kMegabyte);
  InputStream zeros(root_ / "lines");
  EXPECT_TRUE(get_line(zeros, line) && get_line(zeros, line));
  EXPECT_FALSE(get_line(zeros, line));
}

}  // namespace
}  // namespace rtd::io
