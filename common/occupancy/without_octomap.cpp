// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/occupancy/octomap_file.hpp"

namespace rtd::occupancy {

void write_octomap(std::ostream& /*out*/, const Volume& /*volume*/) {
  throw OctomapError("this build writes no OctoMap files; install liboctomap-dev, then configure and build again");
}

}  // namespace rtd::occupancy
