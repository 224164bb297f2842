// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/occupancy/octomap_file.hpp"

#include <gmock/gmock.h>
#include <octomap/OcTree.h>

#include <random>
#include <sstream>

namespace rtd::occupancy {
namespace {

using ::testing::HasSubstr;

/// A wall before a large free room, which a tree stores as few large cells, and single cells far out.
Volume sample() {
  Volume volume;
  for (int i = 0; i < 64 * 64 * 64; ++i) volume.cells.set({i % 64, i / 64 % 64, i / 4096}, Space::kFree);
  for (int i = 0; i < 64 * 64; ++i) volume.cells.set({64, i % 64, i / 64}, Space::kOccupied);
  for (const auto& cell : {Eigen::Vector3i(-1, -1, -1), Eigen::Vector3i(-20'000, 300, 7)}) {
    volume.cells.set(cell, Space::kOccupied);
  }
  volume.cells.set({-5, 17, -900}, Space::kFree);
  return volume;
}

std::string written(const Volume& volume) {
  std::ostringstream out;
  write_octomap(out, volume);
  EXPECT_TRUE(out);
  return out.str();
}

std::string defect(const std::string& bytes) {
  std::istringstream in(bytes);
  try {
    read_octomap(in);
  } catch (const OctomapError& error) {
    return error.what();
  }
  return {};
}

std::string with_nodes(const std::string& nodes) {
  return "# Octomap OcTree binary file\nid OcTree\nsize 9\nres 0.05\ndata\n" + nodes;
}

TEST(OctomapFile, is_read_by_octomap_itself) {
  const Volume volume = sample();
  std::istringstream in(written(volume));
  octomap::OcTree tree(1);
  ASSERT_TRUE(tree.readBinary(in));
  EXPECT_DOUBLE_EQ(tree.getResolution(), 0.05);
  std::size_t cells = 0;
  volume.cells.for_each([&](const Eigen::Vector3i& cell, Space space) {
    const Eigen::Vector3d p = 0.05 * (cell.cast<double>().array() + 0.5);
    const octomap::OcTreeNode* node = tree.search(p.x(), p.y(), p.z());
    ASSERT_NE(node, nullptr) << cell.transpose();
    ASSERT_EQ(tree.isNodeOccupied(node), space == Space::kOccupied) << cell.transpose();
    ++cells;
  });
  EXPECT_EQ(cells, 64U * 64 * 64 + 64 * 64 + 3);
  EXPECT_EQ(tree.search(-1.0, 2.0, 0.5), nullptr) << "unknown stays unknown";
}

TEST(OctomapFile, is_read_back_cell_by_cell) {
  const Volume volume = sample();
  std::istringstream in(written(volume));
  const Volume back = read_octomap(in);
  EXPECT_DOUBLE_EQ(back.cell_m, volume.cell_m);
  std::size_t cells = 0, same = 0;
  back.cells.for_each([&](const Eigen::Vector3i& cell, Space space) {
    ++cells;
    same += volume.cells.value(cell) == space ? 1 : 0;
  });
  EXPECT_EQ(cells, 64U * 64 * 64 + 64 * 64 + 3);
  EXPECT_EQ(same, cells);
  std::istringstream empty(written({}));
  EXPECT_EQ(read_octomap(empty).cells.blocks(), 0U);
}

TEST(OctomapFile, names_what_is_wrong_with_a_file) {
  EXPECT_THAT(defect(""), HasSubstr("not a binary OctoMap"));
  EXPECT_THAT(defect("P5\n1 1\n"), HasSubstr("not a binary OctoMap"));
  EXPECT_THAT(defect("# Octomap OcTree binary file\nid OcTree\n"), HasSubstr("header does not end"));
  EXPECT_THAT(defect("# Octomap OcTree binary file\nid ColorOcTree\nres 0.05\ndata\n"), HasSubstr("ColorOcTree"));
  EXPECT_THAT(defect("# Octomap OcTree binary file\nid OcTree\nres -1\ndata\n"), HasSubstr("resolution"));
  EXPECT_THAT(defect(with_nodes("")), HasSubstr("ends in the middle"));
  EXPECT_THAT(defect(with_nodes(std::string(1000, '\xFF'))), HasSubstr("deeper than 16"));
  EXPECT_THAT(defect(with_nodes("\x55\x55")), HasSubstr("200 million")) << "all of the world is free";
}

TEST(OctomapFile, survives_files_that_were_cut_or_damaged) {
  Volume small;
  for (int i = 0; i < 500; ++i) small.cells.set({i % 7, i % 31, i % 5}, i % 3 == 0 ? Space::kOccupied : Space::kFree);
  const std::string whole = written(small);
  for (std::size_t length = 0; length < whole.size(); ++length) EXPECT_NE(defect(whole.substr(0, length)), "");
  std::mt19937 random(3);
  for (int i = 0; i < 2000; ++i) {  // read or refused, but never a crash
    std::string damaged = whole;
    damaged[damaged.size() - 1 - random() % 100] = static_cast<char>(random());
    defect(damaged);
  }
}

}  // namespace
}  // namespace rtd::occupancy
