// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>
#include <stdexcept>
#include <string>

#include "common/occupancy/volume.hpp"

namespace rtd::occupancy {

/// A file that is no OctoMap of occupied and free cells (.bt), or a damaged one; what() says why.
class OctomapError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

inline constexpr int kOctomapCenter = 1 << 15;  ///< key of the cell at the origin
inline constexpr char kOctomapFirstLine[] = "# Octomap OcTree binary file";

/// Empty, or why this build writes no OctoMap files and what to do.
std::string octomap_left_out();

/// Binary OctoMap (.bt), written by liboctomap; z is up. The stream's state shows errors. Throws OctomapError where the
/// build is without it (octomap_left_out()).
void write_octomap(std::ostream& out, const Volume& volume);

/// Reads a .bt file of any origin. Large cells come as many small ones, 200 million at most. liboctomap's own reader
/// trusts a file: a damaged one would make it recurse without end. Throws OctomapError.
Volume read_octomap(std::istream& in);

}  // namespace rtd::occupancy
