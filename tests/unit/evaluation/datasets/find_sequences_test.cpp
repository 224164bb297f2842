// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "common/service/config.hpp"
#include "services/evaluation/core/datasets/dataset.hpp"
#include "tests/unit/evaluation/datasets/dataset_folder.hpp"

namespace rtd::eval {
namespace {

namespace fs = std::filesystem;
using namespace ::testing;
using testing_support::DatasetFolder;

auto is_left_out(const std::string& folder, const std::string& reason) {
  return AllOf(Field(&LeftOut::folder, HasSubstr(folder)), Field(&LeftOut::reason, HasSubstr(reason)));
}

TEST(SequenceName, is_short_and_empty_for_other_folders) {
  EXPECT_EQ(sequence_name(Dataset::kTum, "rgbd_dataset_freiburg3_walking_xyz"), "fr3_walking_xyz");
  EXPECT_EQ(sequence_name(Dataset::kTum, "rgbd_dataset_freiburg4_walking_xyz"), "");
  EXPECT_EQ(sequence_name(Dataset::kBonn, "rgbd_bonn_moving_nonobstructing_box2"), "moving_nonobstructing_box2");
  EXPECT_EQ(sequence_name(Dataset::kOpenloris, "cafe1-2"), "cafe1-2");
  EXPECT_EQ(sequence_name(Dataset::kOpenloris, "kitchen1-2"), "");
}

TEST(FindSequences, finds_them_by_name_at_any_depth_also_through_links) {
  const DatasetFolder data;
  data.add_tum("a/b/rgbd_dataset_freiburg3_walking_xyz");
  data.add_tum("elsewhere/clip");
  fs::create_directory_symlink(data.path() / "elsewhere/clip", data.path() / "a/rgbd_dataset_freiburg1_xyz");
  const FoundSequences found = find_sequences(Dataset::kTum, {data.file("a")});
  ASSERT_EQ(found.sequences.size(), 2U);
  EXPECT_EQ(found.sequences[0].name, "fr1_xyz");
  EXPECT_EQ(found.sequences[1].name, "fr3_walking_xyz");
  EXPECT_EQ(found.sequences[1].frames, 2U);
  EXPECT_THAT(found.left_out, IsEmpty());
}

TEST(FindSequences, looks_at_a_folder_once_whatever_links_lead_to_it) {
  const DatasetFolder data;
  data.add_tum("a/rgbd_bonn_crowd");
  for (int i = 0; i < 64; ++i) fs::create_directory_symlink(".", data.path() / "a" / ("d" + std::to_string(i)));
  const FoundSequences found = find_sequences(Dataset::kBonn, {data.path().string()});
  EXPECT_EQ(found.sequences.size(), 1U);
  EXPECT_THAT(found.left_out, IsEmpty());
}

TEST(FindSequences, images_elsewhere_are_not_there) {
  const DatasetFolder data;
  data.add_tum("rgbd_bonn_crowd");
  data.add_tum("rgbd_bonn_balloon");
  data.write("rgbd_bonn_crowd/rgb.txt", "1.0 ../rgbd_bonn_balloon/rgb/1.png\n2.0 rgb/2.png\n");
  const FoundSequences found = find_sequences(Dataset::kBonn, {data.path().string()});
  EXPECT_EQ(found.sequences.size(), 1U);
  EXPECT_THAT(found.left_out, ElementsAre(is_left_out("rgbd_bonn_crowd", "1 of 2 images of rgb.txt are missing")));
}

TEST(FindSequences, takes_a_sequence_that_is_named_itself) {
  const DatasetFolder data;
  data.add_tum("rgbd_bonn_crowd");
  EXPECT_EQ(find_sequences(Dataset::kBonn, {data.file("rgbd_bonn_crowd/")}).sequences.size(), 1U);
}

TEST(FindSequences, searches_a_folder_that_is_only_named_like_a_sequence) {
  const DatasetFolder data;
  data.add_tum("rgbd_bonn_dataset/rgbd_bonn_crowd");
  const FoundSequences found = find_sequences(Dataset::kBonn, {data.path().string()});
  EXPECT_EQ(found.sequences.size(), 1U);
  EXPECT_THAT(found.left_out, IsEmpty());
}

TEST(FindSequences, names_cause_and_fix_of_each_that_is_left_out_and_continues) {
  const DatasetFolder data;
  for (const char* name : {"balloon", "crowd", "crowd2", "synchronous"}) data.add_tum(std::string("rgbd_bonn_") + name);
  fs::remove(data.path() / "rgbd_bonn_balloon/rgb/2.png");
  fs::remove(data.path() / "rgbd_bonn_crowd/groundtruth.txt");
  data.write("rgbd_bonn_crowd2/depth.txt", "# nothing\n");
  data.write("rgbd_bonn_kidnapping/readme", "");
  data.add_tum("my_room");
  data.add_tum("rgbd_dataset_freiburg1_xyz");
  data.write("rgbd_bonn_static.zip", "");
  data.write("rgbd_bonn_synchronous.zip", "");  // unpacked beside it
  const FoundSequences found = find_sequences(Dataset::kBonn, {data.path().string()});
  ASSERT_EQ(found.sequences.size(), 1U);
  EXPECT_EQ(found.sequences[0].name, "synchronous");
  EXPECT_THAT(found.left_out,
              ElementsAre(is_left_out("my_room", "not one of Bonn RGB-D Dynamic (rgbd_bonn_NAME): rename it"),
                          is_left_out("balloon", "1 of 2 images of rgb.txt are missing (the first is rgb/2.png)"),
                          is_left_out("crowd", "no groundtruth.txt"), is_left_out("crowd2", "depth.txt names no image"),
                          is_left_out("kidnapping", "no rgb.txt and depth.txt: the download is incomplete"),
                          is_left_out("freiburg1_xyz", "a sequence of TUM RGB-D: use 'rtd benchmark tum'"),
                          is_left_out("static.zip", "still packed")));
}

TEST(FindSequences, leaves_out_the_second_of_two_with_the_same_name) {
  const DatasetFolder data;
  data.add_tum("a/rgbd_bonn_crowd");
  data.add_tum("b/rgbd_bonn_crowd");
  const FoundSequences found = find_sequences(Dataset::kBonn, {data.file("a"), data.file("b")});
  EXPECT_EQ(found.sequences.size(), 1U);
  EXPECT_THAT(found.left_out, ElementsAre(is_left_out("b/rgbd_bonn_crowd", "there twice")));
}

TEST(FindSequences, needs_the_calibration_files_of_openloris) {
  const DatasetFolder data;
  data.add_openloris("cafe1-1");
  data.add_openloris("cafe1-2");
  fs::remove(data.path() / "cafe1-2/trans_matrix.yaml");
  const FoundSequences found = find_sequences(Dataset::kOpenloris, {data.path().string()});
  ASSERT_EQ(found.sequences.size(), 1U);
  EXPECT_EQ(found.sequences[0].name, "cafe1-1");
  EXPECT_THAT(found.left_out, ElementsAre(is_left_out("cafe1-2", "no trans_matrix.yaml")));
}

TEST(FindSequences, refuses_a_folder_that_does_not_exist) {
  EXPECT_THAT([] { find_sequences(Dataset::kTum, {"/nowhere/at/all"}); },
              testing::ThrowsMessage<service::ConfigError>(HasSubstr("/nowhere/at/all is not a folder")));
}

}  // namespace
}  // namespace rtd::eval
