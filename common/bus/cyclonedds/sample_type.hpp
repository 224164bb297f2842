// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "common/bus/byte_block.hpp"
#include "common/bus/raw_bus.hpp"

struct ddsi_sertype;

namespace rtd::bus::cyclonedds {

/// A type as Cyclone gets to know it: a name and bytes. It never looks into the samples.
struct SampleType {
  std::string name;  ///< "nav_msgs::msg::dds_::Odometry_"
  bool keyed = false;
  std::uint32_t plain_bytes = 0;    ///< > 0: every sample has so many behind its header, as in memory
  bool any_representation = false;  ///< also XCDR2
  bool operator==(const SampleType&) const = default;
};

/// Which of whose samples one is: writers count theirs from 1.
struct SampleOrigin {
  WriterId writer{};
  std::int64_t sequence = 0;
};

/// For dds_create_topic_sertype(), which takes it over.
ddsi_sertype* create_sertype(const SampleType& type);
/// For one without an owner.
void destroy_sertype(ddsi_sertype* type);

}  // namespace rtd::bus::cyclonedds
