// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <unistd.h>

#include "services/viewer/core/outbox.hpp"
#include "services/viewer/web/site.hpp"
#include "tests/support/temporary_folder.hpp"

namespace rtd::viewer {
namespace {

Frame data(std::size_t bytes, int mark) {
  return binary_frame(Bytes(1, std::byte(mark)), std::make_shared<const Bytes>(bytes - 1));
}

int mark(const Frame& frame) {
  return std::to_integer<int>(frame.head.front());
}

TEST(Outbox, control_goes_before_data) {
  Outbox outbox;
  outbox.push_data(data(10, 1));
  EXPECT_TRUE(outbox.push_control(text_frame("hello")));
  EXPECT_TRUE(outbox.pop()->text);
  EXPECT_EQ(mark(*outbox.pop()), 1);
  EXPECT_FALSE(outbox.pop().has_value());
  EXPECT_EQ(outbox.bytes(), 0U);
}

TEST(Outbox, drops_the_oldest_data_and_counts) {
  Outbox outbox({.data_messages = 3, .data_bytes = 1000});
  for (int i = 1; i <= 5; ++i) outbox.push_data(data(10, i));
  EXPECT_EQ(outbox.dropped(), 2U);
  EXPECT_EQ(mark(*outbox.pop()), 3);
  outbox.push_data(data(995, 9));
  EXPECT_EQ(outbox.dropped(), 4U) << "no room beside it";
  EXPECT_EQ(mark(*outbox.pop()), 9);
}

TEST(Outbox, a_message_beyond_the_limit_waits_alone) {
  Outbox outbox({.data_bytes = 100});
  outbox.push_data(data(10, 1));
  outbox.push_data(data(5000, 2));
  EXPECT_EQ(outbox.bytes(), 5000U);
  EXPECT_EQ(mark(*outbox.pop()), 2);
}

TEST(Outbox, a_client_that_takes_no_control_messages_is_given_up) {
  Outbox outbox({.control_messages = 2});
  EXPECT_TRUE(outbox.push_control(text_frame("a")));
  EXPECT_TRUE(outbox.push_control(text_frame("b")));
  EXPECT_FALSE(outbox.push_control(text_frame("c")));
  EXPECT_TRUE(outbox.overflowed());
  Outbox small({.control_bytes = 10});
  EXPECT_FALSE(small.push_control(text_frame("longer than ten")));
}

namespace fs = std::filesystem;

/// three/ as Debian has it, beside a script that is not part of it.
class SiteTest : public testing::Test {
 protected:
  SiteTest() {
    fs::create_directories(three_ / "build");
    folder_.write("three/three.module.js", "module");
    folder_.write("three/examples/jsm/Controls.js", "controls");
    folder_.write("three/readme.txt", "text");
    folder_.write("secret.js", "secret");
    fs::create_symlink("../three.module.js", three_ / "build" / "three.module.js");
    fs::create_symlink("../secret.js", three_ / "out.js");
    fs::create_directory_symlink("..", three_ / "up");
  }
  std::string content(const std::string& path) const {
    const auto file = Site(three_).file(path);
    return file ? file->content : "";
  }

  const rtd::test::TemporaryFolder folder_;
  const fs::path three_ = folder_ / "three";
};

TEST_F(SiteTest, serves_the_page_and_the_scripts_of_three) {
  EXPECT_NE(content("/").find("<html"), std::string::npos);
  EXPECT_EQ(content("/three/three.module.js"), "module");
  EXPECT_EQ(content("/three/build/three.module.js"), "module");
  EXPECT_EQ(content("/three/examples/jsm/Controls.js"), "controls");
  EXPECT_TRUE(Site(three_).has_three());
  EXPECT_FALSE(Site(folder_ / "nowhere").has_three());
}

TEST_F(SiteTest, serves_no_file_outside_the_folder_whatever_is_asked_for) {
  const std::string absolute = (folder_ / "secret.js").string();
  for (const std::string& path :
       {"/three/" + absolute, "/three/build/" + absolute, "/three//" + absolute, std::string("/three/../secret.js"),
        std::string("/three/out.js"), std::string("/three/up/secret.js"), std::string("/three/build/../../secret.js"),
        std::string("/three/readme.txt"), std::string("/three/./three.module.js"), std::string("/three/"),
        std::string("//three/three.module.js"), std::string("/three/three.module.js\0x", 24)})
    EXPECT_EQ(content(path), "") << path;
}

}  // namespace
}  // namespace rtd::viewer
