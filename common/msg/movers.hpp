// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "common/msg/fields.hpp"

namespace rtd::msg {

/// An object that moves or may move, in the world frame (`map`). The box is aligned with its axes.
struct Mover {
  std::uint32_t id = 0;    ///< the same while the object is followed
  std::string class_name;  ///< of the detector; empty: found by its motion alone
  std::array<double, 3> center_m{}, size_m{}, velocity_mps{};
  float static_probability = 0;         ///< [0, 1] of what the camera sees of it; 0 = certainly moves
  float unseen_s = 0;                   ///< since it was last seen; more than 0: predicted
  std::array<double, 36> covariance{};  ///< of (center, velocity), row-major, m and m/s, axes of the world frame
};
RTD_FIELDS(rtd_msgs, Mover, id, class_name, center_m, size_m, velocity_mps, static_probability, unseen_s, covariance)

/// The objects of one frame: topic `rtd/movers`, from the filter to whoever reads it.
struct Movers {
  std::uint64_t seq = 0;      ///< of the RgbdFrame
  std::int64_t stamp_ns = 0;  ///< of the RgbdFrame
  std::vector<Mover> movers;
};
RTD_FIELDS(rtd_msgs, Movers, seq, stamp_ns, movers)

}  // namespace rtd::msg
