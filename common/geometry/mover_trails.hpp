// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <vector>

#include "common/msg/movers.hpp"

namespace rtd::geometry {

/// Whether objects move, by their velocities and by their last moments: the middle of one that comes into view moves
/// too, while it rests. For people who watch; velocities of messages stay as they are. Not thread-safe.
class MoverTrails {
 public:
  /// The objects of the next frame: whether each of them may rest. True when its velocity is within what its covariance
  /// makes likely for an object at rest, and as long as both its sides have not gone half of the way that the velocity
  /// promises in 0.75 to 1.5 s.
  std::vector<bool> rest(const msg::Movers& frame);

 private:
  struct Place {
    std::int64_t stamp_ns = 0;
    std::array<double, 3> center_m{}, size_m{};
  };
  using Trail = std::deque<Place>;  ///< of the last 1.5 s, oldest first

  std::map<std::uint32_t, Trail> trails_;  ///< by object
};

}  // namespace rtd::geometry
