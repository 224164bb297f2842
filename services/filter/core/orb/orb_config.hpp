// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace rtd::filter {

/// How ORB features are extracted; docs/theory/orb.md. Defaults as in ORB-SLAM2.
struct OrbConfig {
  int feature_count = 1000;    ///< wanted features per frame
  int levels = 8;              ///< pyramid levels
  double scale_factor = 1.2;   ///< between two levels
  int fast_threshold = 20;     ///< grey values, first try
  int fast_threshold_low = 7;  ///< grey values, in cells where the first try finds nothing
  int cell_px = 30;            ///< side of a FAST cell
  double min_depth_m = 0.3;    ///< nearer readings count as not measured
  double max_depth_m = 10.0;   ///< farther readings count as not measured
};

}  // namespace rtd::filter
