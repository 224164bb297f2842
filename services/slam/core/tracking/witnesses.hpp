// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "services/slam/core/tracking/tracking_steps.hpp"

namespace rtd::slam {

/// How much of a frame speaks for its pose: tiles of the image, 8 x 6.
struct WitnessView {
  int with_features = 0;  ///< static ones
  int agreeing = 0;       ///< with landmarks that agree with the pose
  int expected = 0;       ///< where witnesses should be seen
  int found = 0;          ///< where one of them agrees with the pose
  int witnesses = 0;      ///< that agree; landmarks, not tiles
};
WitnessView look_for_witnesses(const Frame& frame, const LocalMap& map, const LocalMapTracking& tracking);

/// Who carries a pose. docs/theory/tracking.md, "Witnesses".
struct WitnessVerdict {
  bool witnessed = false;       ///< witnesses do
  bool carried = true;          ///< they do, or much of a view in which there are hardly any: what rests may be learnt
  bool mostly_unknown = false;  ///< little of the view is in the map: it needs a keyframe
  bool contradicted = false;    ///< they should be seen and are not where the pose shows them
  bool doubtful = false;        ///< they contradict, or did a moment ago and have not carried a pose since
};

/// Judges one pose after the other. Where witnesses leave the view while they contradict, as when a camera turns away
/// with a person, what else agrees proves nothing: the pose stays doubtful until witnesses carry one again, but for no
/// longer than WitnessConfig::settle_s.
class WitnessJudge {
 public:
  explicit WitnessJudge(const WitnessConfig& config) : config_(config) {}

  WitnessVerdict judge(const WitnessView& view, std::int64_t stamp_ns);
  /// Another map, or a loss.
  void forget() { contradicted_ns_.reset(); }

 private:
  WitnessConfig config_;
  std::optional<std::int64_t> contradicted_ns_;  ///< stamp of the last contradiction that no witnesses have answered
};

}  // namespace rtd::slam
