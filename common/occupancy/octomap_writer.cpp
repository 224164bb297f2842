// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <octomap/OcTree.h>

#include <ostream>

#include "common/occupancy/octomap_file.hpp"

namespace rtd::occupancy {

std::string octomap_left_out() {
  return {};
}

void write_octomap(std::ostream& out, const Volume& volume) {
  octomap::OcTree tree(volume.cell_m);
  volume.cells.for_each([&](const Eigen::Vector3i& cell, Space space) {
    const Eigen::Array3i key = cell.array() + kOctomapCenter;
    if ((key < 0).any() || (key >= 2 * kOctomapCenter).any()) return;
    tree.setNodeValue(
        octomap::OcTreeKey(static_cast<octomap::key_type>(key.x()), static_cast<octomap::key_type>(key.y()),
                           static_cast<octomap::key_type>(key.z())),
        space == Space::kOccupied ? tree.getClampingThresMaxLog() : tree.getClampingThresMinLog(), true);
  });
  tree.updateInnerOccupancy();
  tree.toMaxLikelihood();
  tree.prune();
  out << kOctomapFirstLine << "\nid " << tree.getTreeType() << "\nsize " << tree.size() << "\nres " << volume.cell_m
      << "\ndata\n";
  tree.writeBinaryData(out);  // writeBinary() would also print to the console
}

}  // namespace rtd::occupancy
