// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/recorder/core/output_files.hpp"

#include <gmock/gmock.h>

#include <fstream>

namespace rtd::recorder {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

class OutputFolder : public ::testing::Test {
 protected:
  OutputFolder() : folder_(fs::temp_directory_path() / "rtd_output_files_test") {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~OutputFolder() override { fs::remove_all(folder_); }
  void put(const std::string& name, const std::string& text = "x") const { std::ofstream(folder_ / name) << text; }
  std::string in(const std::string& name) const { return folder_ / name; }

  const fs::path folder_;
};

TEST(OutputFiles, are_one_file_numbered_files_or_a_folder) {
  EXPECT_EQ(OutputFiles("a/run.mcap", false).file(0), "a/run.mcap");
  EXPECT_EQ(OutputFiles("a/run.mcap", true).file(2), "a/run_2.mcap");
  EXPECT_EQ(OutputFiles("a/run", false).file(0), "a/run/run_0.mcap");
  EXPECT_EQ(OutputFiles("a/run/", false).file(0), "a/run/run_0.mcap");
  EXPECT_EQ(OutputFiles("run.mcap", false).metadata(), "") << "the folder is the user's";
  EXPECT_EQ(OutputFiles("run.mcap", true).metadata(), "./metadata.yaml");
  EXPECT_EQ(OutputFiles("run", false).metadata(), "run/metadata.yaml");
}

TEST_F(OutputFolder, finds_earlier_files_of_this_name_only) {
  for (const char* name : {"run.mcap", "run_0.mcap", "run_12.mcap", "run_x.mcap", "run_.mcap", "other_0.mcap"})
    put(name);
  EXPECT_THAT(OutputFiles(in("run.mcap"), false).existing(), ElementsAre(folder_ / "run.mcap"));
  EXPECT_THAT(OutputFiles(in("run.mcap"), true).existing(),
              ElementsAre(folder_ / "run_0.mcap", folder_ / "run_12.mcap"));
  EXPECT_THAT(OutputFiles(in("new.mcap"), true).existing(), IsEmpty());
  EXPECT_THAT(OutputFiles(in("no/such/folder"), true).existing(), IsEmpty());
}

TEST_F(OutputFolder, finds_a_free_name_beside) {
  EXPECT_EQ(OutputFiles::free_beside(in("run.mcap"), false).file(0), folder_ / "run.mcap");
  put("run.mcap");
  put("run.1.mcap");
  EXPECT_EQ(OutputFiles::free_beside(in("run.mcap"), false).file(0), folder_ / "run.2.mcap");
  fs::create_directories(folder_ / "bag");
  put("bag/bag_0.mcap");
  EXPECT_EQ(OutputFiles::free_beside(in("bag"), true).file(0), folder_ / "bag.1" / "bag.1_0.mcap");
}

TEST_F(OutputFolder, leaves_the_metadata_of_others_alone) {
  const OutputFiles files(in("run.mcap"), true);
  EXPECT_TRUE(files.owns_metadata());
  put("metadata.yaml", "rosbag2_bagfile_information:\n  relative_file_paths:\n    - run_0.mcap\n");
  EXPECT_TRUE(files.owns_metadata());
  put("metadata.yaml", "rosbag2_bagfile_information:\n  relative_file_paths:\n    - other_0.mcap\n");
  EXPECT_FALSE(files.owns_metadata());
  for (const char* unrelated : {"name: my site\n", "", "rosbag2_bagfile_information:\n  storage_identifier: mcap\n"}) {
    put("metadata.yaml", unrelated);
    EXPECT_FALSE(files.owns_metadata()) << unrelated;
  }
  fs::remove(folder_ / "metadata.yaml");
  fs::create_symlink("nowhere", folder_ / "metadata.yaml");
  EXPECT_FALSE(files.owns_metadata());
}

}  // namespace
}  // namespace rtd::recorder
