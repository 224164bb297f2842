// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/launcher/demo/demo_command.hpp"

#include <gmock/gmock.h>

#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "common/service/config.hpp"

namespace rtd::launcher {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

TEST(tum_dataset, builds_address_and_folder_from_the_name) {
  const TumDataset dataset = tum_dataset("fr3_walking_xyz", "http://mirror");
  EXPECT_EQ(dataset.folder, "rgbd_dataset_freiburg3_walking_xyz");
  EXPECT_EQ(dataset.url, "http://mirror/freiburg3/rgbd_dataset_freiburg3_walking_xyz.tgz");
  EXPECT_EQ(tum_dataset("freiburg1_desk", "x").url, "x/freiburg1/rgbd_dataset_freiburg1_desk.tgz");
  EXPECT_EQ(tum_dataset("rgbd_dataset_freiburg2_xyz", "x").folder, "rgbd_dataset_freiburg2_xyz");
}

TEST(tum_dataset, refuses_what_is_no_sequence) {
  for (const char* name : {"", "fr4_desk", "walking", "fr1_", "fr1_../../etc", "fr1_desk; rm"}) {
    EXPECT_THROW(tum_dataset(name, "x"), service::ConfigError) << name;
  }
}

/// curl reads file: addresses too, so that a folder stands in for the server.
class FetchTest : public testing::Test {
 protected:
  FetchTest() {
    fs::remove_all(root_);
    fs::create_directories(root_ / "server/freiburg3/rgbd_dataset_freiburg3_tiny");
    setenv("XDG_CACHE_HOME", (root_ / "cache").c_str(), 1);
    setenv("RTD_TUM_URL", ("file://" + (root_ / "server").string()).c_str(), 1);
  }
  ~FetchTest() override { fs::remove_all(root_); }
  void pack() const {
    std::ofstream(root_ / "server/freiburg3/rgbd_dataset_freiburg3_tiny/rgb.txt") << "# color\n";
    const std::string folder = (root_ / "server/freiburg3").string();
    ASSERT_EQ(
        std::system(
            ("cd " + folder + " && tar -czf rgbd_dataset_freiburg3_tiny.tgz rgbd_dataset_freiburg3_tiny").c_str()),
        0);
  }
  std::string error_of(const std::string& name) const {
    try {
      fetch_tum_dataset(name);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "no error";
  }
  fs::path root_ = fs::path(testing::TempDir()) / ("rtd_fetch_" + std::to_string(getpid()));
};

TEST_F(FetchTest, downloads_unpacks_and_keeps) {
  pack();
  const fs::path folder = fetch_tum_dataset("fr3_tiny");
  EXPECT_EQ(folder, root_ / "cache/rtd-slam/datasets/rgbd_dataset_freiburg3_tiny");
  EXPECT_TRUE(fs::exists(folder / "rgb.txt"));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.parent_path()), {}), 1) << "nothing else is left in the cache";
  fs::remove_all(root_ / "server");
  EXPECT_EQ(fetch_tum_dataset("fr3_tiny"), folder) << "the second time needs no network";
}

TEST_F(FetchTest, without_the_server_it_names_address_and_ways_out) {
  fs::remove_all(root_ / "server");
  EXPECT_THAT(error_of("fr3_tiny"), AllOf(HasSubstr("cannot download file://"), HasSubstr("tum:FOLDER")));
}

TEST_F(FetchTest, a_broken_archive_leaves_no_folder) {
  std::ofstream(root_ / "server/freiburg3/rgbd_dataset_freiburg3_tiny.tgz") << "no archive";
  EXPECT_THAT(error_of("fr3_tiny"), HasSubstr("is not a complete archive"));
  EXPECT_FALSE(fs::exists(root_ / "cache/rtd-slam/datasets/rgbd_dataset_freiburg3_tiny"));
}

}  // namespace
}  // namespace rtd::launcher
