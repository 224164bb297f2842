// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/occupancy/octomap_file.hpp"

namespace rtd::occupancy {

std::string octomap_left_out() {
  return "this build writes no OctoMap files; install liboctomap-dev, then configure and build again";
}

void write_octomap(std::ostream& /*out*/, const Volume& /*volume*/) {
  throw OctomapError(octomap_left_out());
}

}  // namespace rtd::occupancy
