// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

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

}  // namespace rtd::filter
