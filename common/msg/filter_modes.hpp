// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace rtd::msg {

/// Which parts of the filter are at work; the other modes serve for comparison.
enum class FilterMode {
  kOff,       ///< features only: ORB-SLAM2's front end
  kSemantic,  ///< every object of a high motion level is removed, nothing else
  kGeometry,  ///< multi-view geometry only, boxes are ignored
  kEpipolar,  ///< DS-SLAM's rule: people with moving points on them are removed
  kRtdPaper,  ///< the RTD-SLAM paper's own rules and thresholds
  kRtd,       ///< objects and geometry
};

/// What a mode does with detections.
enum class BoxUse {
  kNone,       ///< ignores them
  kHelpful,    ///< uses them, and has geometry without a detector
  kEssential,  ///< removes nothing without a detector
};

struct NamedFilterMode {
  FilterMode mode;
  const char* name;  ///< `filter.mode`, `--filter`, the metric `mode.NAME` of the filter's heartbeat
  BoxUse boxes;
};

/// The modes, from no removal to all techniques (docs/theory/dynamic_points.md "Modes").
inline constexpr std::array<NamedFilterMode, 6> kFilterModes{{
    {FilterMode::kOff, "off", BoxUse::kNone},
    {FilterMode::kSemantic, "semantic", BoxUse::kEssential},
    {FilterMode::kGeometry, "geometry", BoxUse::kNone},
    {FilterMode::kEpipolar, "epipolar", BoxUse::kEssential},
    {FilterMode::kRtdPaper, "rtd-paper", BoxUse::kEssential},
    {FilterMode::kRtd, "rtd", BoxUse::kHelpful},
}};

inline constexpr const char* kDefaultFilterMode = "rtd";

inline const NamedFilterMode& named(FilterMode mode) {
  return *std::ranges::find(kFilterModes, mode, &NamedFilterMode::mode);
}
inline std::string name_of(FilterMode mode) {
  return named(mode).name;
}
inline bool looks_at_boxes(FilterMode mode) {
  return named(mode).boxes != BoxUse::kNone;
}

/// Null for an unknown name.
inline const NamedFilterMode* find_filter_mode(std::string_view name) {
  const auto found = std::ranges::find(kFilterModes, name, &NamedFilterMode::name);
  return found == kFilterModes.end() ? nullptr : &*found;
}

inline std::vector<std::string> filter_mode_names() {
  std::vector<std::string> names;
  for (const NamedFilterMode& entry : kFilterModes) names.emplace_back(entry.name);
  return names;
}

}  // namespace rtd::msg
