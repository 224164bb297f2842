// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

namespace rtd::camera::synthetic {

/// Which exposures of a camera are lost on the way: of every 100, a share at random places. A pure function of the
/// seed: any frame is found without counting from the first. Immutable.
class FrameDrops {
 public:
  /// `share`: of the exposures, [0, 0.9], rounded to hundredths.
  FrameDrops(double share, std::uint64_t seed);

  /// Number of the exposure that arrives as the `frame`-th, both from 0.
  std::uint64_t exposure_of(std::uint64_t frame) const;
  /// How many of the exposures before this one arrive.
  std::uint64_t arrived_before(std::uint64_t exposure) const;

 private:
  std::vector<std::uint64_t> arriving_in(std::uint64_t block) const;

  std::uint64_t lost_, seed_;  ///< of a block
};

}  // namespace rtd::camera::synthetic
