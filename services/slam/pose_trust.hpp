// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "common/msg/tracking.hpp"

namespace rtd::slam {

/// What is in view, as far as it matters for the pose: docs/integrity.md, "Crowded or lost".
enum class View { kClear, kCrowded, kContradicted, kBlind, kUnknown };
/// For diagnostics: "crowded".
const char* to_string(View view);

/// How far a pose can be trusted, and why not further.
struct PoseTrust {
  View view = View::kUnknown;
  double agreement = 0;     ///< share of the recognised landmarks that agree closely with the pose; 0 without one
  double view_removed = 0;  ///< share of the features that the filter removed as moving, over half a second
  double since_ok_s = 0;    ///< since the last frame in state ok, else since the first frame
  double position_sigma_m = 1000, rotation_sigma_deg = 180;  ///< along the worst axis; these values: unknown
};

/// Follows the results of slam, frame by frame. Not thread-safe.
class TrustMonitor {
 public:
  PoseTrust add(const msg::TrackingResult& result, double agreement);

 private:
  double follow_view(const msg::TrackingResult& result);

  std::optional<std::int64_t> last_ok_ns_, last_ns_;
  double view_removed_ = 0;
};

}  // namespace rtd::slam
