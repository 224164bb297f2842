// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>

#include "services/filter/core/config/filter_config.hpp"

namespace rtd::filter {

class ModeJudge;

/// How a mode of common/msg/filter_modes.hpp works: a composition of techniques and the rule that decides.
struct ModeEntry {
  FilterMode mode;
  Techniques techniques;
  std::unique_ptr<ModeJudge> (*make_judge)(const FilterConfig& config);
};

/// All modes, from nothing to everything.
std::span<const ModeEntry> all_modes();
const ModeEntry& entry_of(FilterMode mode);

/// The configuration that the algorithms work with: the techniques that belong to the mode and are not switched off,
/// and what that means for the numbers.
FilterConfig effective_config(FilterConfig config);

}  // namespace rtd::filter
