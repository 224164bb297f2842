// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <stdexcept>
#include <string>

#include "common/io/atomic_file.hpp"
#include "common/io/byte_source.hpp"
#include "common/io/input_file.hpp"
#include "common/io/named_files.hpp"
#include "common/io/text.hpp"
#include "common/process/out_folder.hpp"
#include "tests/support/temporary_folder.hpp"

namespace rtd::io {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

class AtomicFileTest : public ::testing::Test {
 protected:
  fs::path at(const std::string& name) const { return folder_.path() / name; }
  void put(const std::string& name, const std::string& content) const { std::ofstream(at(name)) << content; }
  std::string text(const std::string& name) const { return try_read_file(at(name), kResults).value_or("nothing"); }
  std::size_t files() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_.path()), fs::directory_iterator()));
  }
  unsigned mode(const std::string& name) const {
    struct stat status {};
    ::stat(at(name).c_str(), &status);
    return status.st_mode & 0777U;
  }

  const rtd::test::TemporaryFolder folder_;
};

TEST_F(AtomicFileTest, appears_whole_and_only_when_committed) {
  put("a", "before");
  {
    AtomicFile file(at("a"));
    file.append({bytes_of("after"), bytes_of("wards")});
    EXPECT_EQ(text("a"), "before");
    file.commit();
    EXPECT_EQ(file.position(), 10U);
  }
  EXPECT_EQ(text("a"), "afterwards");
  EXPECT_EQ(files(), 1U);
}

TEST_F(AtomicFileTest, leaves_nothing_of_what_failed) {
  put("a", "before");
  EXPECT_THROW(write_file(at("a"),
                          [](std::ostream& out) {
                            out << std::string(200'000, 'x');
                            throw std::runtime_error("no more");
                          }),
               std::runtime_error);
  EXPECT_EQ(text("a"), "before");
  EXPECT_EQ(files(), 1U);
}

TEST_F(AtomicFileTest, a_stream_that_the_disk_has_no_room_for_throws_and_keeps_the_file) {
  put("a", "before");
  rlimit old{};
  ::getrlimit(RLIMIT_FSIZE, &old);
  const sighandler_t handler = ::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{100'000, old.rlim_max};
  ::setrlimit(RLIMIT_FSIZE, &small);
  EXPECT_THAT([&] { write_file(at("a"), [](std::ostream& out) { out << std::string(300'000, 'x'); }); },
              ThrowsMessage<IoError>(AllOf(HasSubstr(at("a").string()), HasSubstr("larger"))));
  ::setrlimit(RLIMIT_FSIZE, &old);
  ::signal(SIGXFSZ, handler);
  EXPECT_EQ(text("a"), "before");
  EXPECT_EQ(files(), 1U);
}

TEST_F(AtomicFileTest, writes_a_long_stream_in_order) {
  std::string expected;
  for (int i = 0; i < 50'000; ++i) expected += std::to_string(i) + '\n';
  write_file(at("a"), [&](std::ostream& out) {
    for (int i = 0; i < 50'000; ++i) out << i << '\n';
  });
  EXPECT_EQ(text("a"), expected);
}

TEST_F(AtomicFileTest, is_not_led_elsewhere_by_a_link_at_its_name) {
  put("startup", "export PATH");
  fs::create_symlink("startup", at("a"));
  EXPECT_THAT([&] { write_file(at("a"), "attack"); },
              ThrowsMessage<IoError>(AllOf(HasSubstr(at("a").string()), HasSubstr("symbolic link"))));
  fs::create_symlink("nowhere", at("dangling"));
  EXPECT_THROW(write_file(at("dangling"), "attack"), IoError);
  EXPECT_EQ(text("startup"), "export PATH");
  EXPECT_FALSE(fs::exists(at("nowhere")));
}

TEST_F(AtomicFileTest, is_not_led_elsewhere_by_links_prepared_at_guessable_temporary_names) {
  put("startup", "export PATH");
  for (const char* name : {"a.tmp", "a.new", "a.part", "a.partial", ".a.tmp"}) fs::create_symlink("startup", at(name));
  write_file(at("a"), "content");
  EXPECT_EQ(text("startup"), "export PATH");
  EXPECT_EQ(text("a"), "content");
  EXPECT_TRUE(fs::is_regular_file(fs::symlink_status(at("a"))));
}

TEST_F(AtomicFileTest, follows_the_links_that_the_operator_named) {
  fs::create_directory(at("disk"));
  put("disk/map", "before");
  fs::create_symlink("disk/map", at("first"));
  fs::create_symlink("first", at("second"));
  write_file(at("second"), "after", {.named_by = NamedBy::kOperator});
  EXPECT_EQ(text("disk/map"), "after");
  EXPECT_TRUE(fs::is_symlink(at("second")));
  EXPECT_TRUE(fs::is_symlink(at("first")));
}

TEST_F(AtomicFileTest, a_pipe_is_written_for_the_operator_and_refused_otherwise) {
  ASSERT_EQ(::mkfifo(at("pipe").c_str(), 0600), 0);
  EXPECT_THAT([&] { write_file(at("pipe"), "text"); }, ThrowsMessage<IoError>(HasSubstr("not a file")));
  const int reader = ::open(at("pipe").c_str(), O_RDONLY | O_NONBLOCK);
  write_file(at("pipe"), "text", {.named_by = NamedBy::kOperator});
  std::array<char, 8> got{};
  EXPECT_EQ(::read(reader, got.data(), got.size()), 4);
  ::close(reader);
  EXPECT_TRUE(fs::is_fifo(at("pipe")));
}

TEST_F(AtomicFileTest, keeps_the_permissions_of_a_replaced_file) {
  const mode_t mask = ::umask(022);
  write_file(at("new"), "x");
  EXPECT_EQ(mode("new"), 0644U);
  fs::permissions(at("new"), fs::perms::owner_read | fs::perms::owner_write);
  write_file(at("new"), "y");
  EXPECT_EQ(mode("new"), 0600U);
  write_file(at("new"), "key", {.mode = 0640, .keep_mode = false});
  EXPECT_EQ(mode("new"), 0640U);
  ::umask(077);
  write_file(at("masked"), "x");
  EXPECT_EQ(mode("masked"), 0600U);
  ::umask(mask);
}

TEST_F(AtomicFileTest, does_not_replace_what_must_not_be_replaced) {
  put("a", "before");
  EXPECT_THAT([&] { AtomicFile(at("a"), {.if_exists = IfExists::kFail}); },
              ThrowsMessage<IoError>(HasSubstr("exists already")));
  AtomicFile late(at("b"), {.if_exists = IfExists::kFail});
  put("b", "came meanwhile");
  EXPECT_THAT([&] { late.commit(); }, ThrowsMessage<IoError>(HasSubstr("exists already")));
  EXPECT_EQ(text("b"), "came meanwhile");
  EXPECT_THAT([&] { AtomicFile(folder_.path()); }, ThrowsMessage<IoError>(HasSubstr("this is a folder")));
  EXPECT_THAT([&] { AtomicFile(at("none/a")); }, ThrowsMessage<IoError>(HasSubstr("no such folder")));
}

TEST_F(AtomicFileTest, what_a_killed_process_left_is_removed_and_nothing_else) {
  const pid_t child = ::fork();
  if (child == 0) {
    AtomicFile unfinished(at("a"));
    ::kill(::getpid(), SIGKILL);
  }
  ::waitpid(child, nullptr, 0);
  put(".rtd-notes.tmp", "mine");
  put(".rtd-0123456789abcdef.tmp.bak", "mine");
  fs::create_symlink(".rtd-notes.tmp", at(".rtd-0123456789abcdef.tmp"));
  AtomicFile in_use(at("b"));
  ASSERT_EQ(files(), 5U);
  remove_unfinished(folder_.path());
  EXPECT_EQ(files(), 4U);
  in_use.commit();
  EXPECT_TRUE(fs::exists(at("b")));
}

TEST_F(AtomicFileTest, a_growing_file_is_not_written_through_a_link) {
  put("startup", "export PATH");
  fs::create_symlink("startup", at("run.mcap"));
  EXPECT_THAT([&] { FileSink(at("run.mcap"), IfExists::kReplace); },
              ThrowsMessage<IoError>(HasSubstr("symbolic link")));
  EXPECT_THROW(FileSink(at("run.mcap"), IfExists::kFail), IoError);
  EXPECT_EQ(text("startup"), "export PATH");
  EXPECT_THROW(FileSource(at("run.mcap"), Links::kRefuse), IoError);
  EXPECT_EQ(FileSource(at("run.mcap")).size(), 11U);
}

TEST_F(AtomicFileTest, a_folder_belongs_to_one_process_at_a_time) {
  {
    const process::FolderLock first(folder_.path());
    EXPECT_THAT(
        [&] { process::FolderLock(folder_.path()); },
        ThrowsMessage<IoError>(AllOf(HasSubstr(folder_.path().string()),
                                     HasSubstr("process " + std::to_string(::getpid())), HasSubstr("another folder"))));
  }
  EXPECT_NO_THROW(process::FolderLock(folder_.path()));
  put("startup", "export PATH");
  fs::remove(at(".rtd.lock"));
  fs::create_symlink("startup", at(".rtd.lock"));
  EXPECT_THROW(process::FolderLock(folder_.path()), IoError);
  EXPECT_EQ(text("startup"), "export PATH");
}

namespace fs = std::filesystem;

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

  const rtd::test::TemporaryFolder folder_;
  const NamedFiles maps_{folder_.path(), kMaps};
};

TEST_F(NamedFilesTest, a_plain_name_is_a_file_of_the_folder_and_gets_its_extension) {
  EXPECT_EQ(maps_.path("room"), at("room.rtdmap"));
  EXPECT_EQ(maps_.path("room.rtdmap"), at("room.rtdmap"));
  EXPECT_EQ(maps_.path("Floor_2-b.v1"), at("Floor_2-b.v1.rtdmap"));
}

TEST_F(NamedFilesTest, anything_else_is_refused_in_the_same_words) {
  const std::vector<std::string> hostile = {"/etc/passwd",
                                            "../up",
                                            "a/b",
                                            ".bashrc",
                                            "..",
                                            ".",
                                            "-rf",
                                            "a b",
                                            "a\nb",
                                            "a\\b",
                                            "$HOME",
                                            "~",
                                            std::string("a\0b", 3),
                                            "\xc3\xa4",
                                            "\x1b[2J",
                                            std::string(94, 'a'),
                                            "/root/none.rtdmap"};
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
