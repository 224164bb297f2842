// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>

#include "services/filter/core/filter_config.hpp"

namespace rtd::filter {

/// A technique by name: key `filter.techniques.<name>`.
struct NamedTechnique {
  const char* name;
  bool Techniques::*on;
  const char* without;  ///< what is done instead
};

/// All techniques, in the order of their rules.
std::span<const NamedTechnique> all_techniques();

/// Only those that are on in both.
Techniques in_common(const Techniques& a, const Techniques& b);

/// What switches that are off mean in numbers: a technique that only weighs evidence needs no branch in the algorithm,
/// its numbers are such that it never speaks. `config.techniques` is kept for those that do need one.
FilterConfig with_techniques_applied(FilterConfig config);

class ModeJudge;

/// A mode: a composition of techniques and the rule that decides.
struct ModeEntry {
  FilterMode mode;
  const char* name;  ///< `filter.mode`
  Techniques techniques;
  std::unique_ptr<ModeJudge> (*make_judge)(const FilterConfig& config);
};

/// All modes, from nothing to everything.
std::span<const ModeEntry> all_modes();
const ModeEntry& entry_of(FilterMode mode);

/// Detections change what the mode says.
bool looks_at_boxes(FilterMode mode);

/// The configuration that the algorithms work with: the techniques that belong to the mode and are not switched off,
/// and what that means for the numbers.
FilterConfig effective_config(FilterConfig config);

}  // namespace rtd::filter
