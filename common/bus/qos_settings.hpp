// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/bus/qos.hpp"

namespace rtd::bus {

/// What a profile means, in DDS terms but without a vendor. All profiles are reliable and keep-last.
struct QosSettings {
  int depth;                ///< history depth of writers and readers
  bool transient_local;     ///< late readers get the last `depth` samples of living writers
  bool data_sharing;        ///< samples stay in the writer's shared memory; this host only, plain types only
  int liveliness_lease_ms;  ///< automatic liveliness; 0 = infinite
  int deadline_ms;          ///< a writer promises a sample at least this often; 0 = no promise
};

/// The one table of QoS profiles; every backend maps QosSettings to its vendor.
QosSettings qos_settings(QosProfile profile);

/// Policies in which a reader asks for more than a writer offers, by their DDS names, e.g. "DURABILITY"; empty when
/// they match.
std::string incompatible_policy(const QosSettings& offered, const QosSettings& requested);

}  // namespace rtd::bus
