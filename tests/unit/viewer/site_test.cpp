// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/viewer/web/site.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

namespace rtd::viewer {
namespace {

namespace fs = std::filesystem;

/// three/ as Debian has it, beside a script that is not part of it.
class SiteTest : public testing::Test {
 protected:
  SiteTest() {
    fs::create_directories(three_ / "examples" / "jsm");
    fs::create_directories(three_ / "build");
    write("three/three.module.js", "module");
    write("three/examples/jsm/Controls.js", "controls");
    write("three/readme.txt", "text");
    write("secret.js", "secret");
    fs::create_symlink("../three.module.js", three_ / "build" / "three.module.js");
    fs::create_symlink("../secret.js", three_ / "out.js");
    fs::create_directory_symlink("..", three_ / "up");
  }
  ~SiteTest() override { fs::remove_all(folder_); }

  void write(const std::string& name, const std::string& text) { std::ofstream(folder_ / name) << text; }
  std::string content(const std::string& path) const {
    const auto file = Site(three_).file(path);
    return file ? file->content : "";
  }

  const fs::path folder_ = fs::path(testing::TempDir()) / ("rtd_site_" + std::to_string(getpid()));
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
