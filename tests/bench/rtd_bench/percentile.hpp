// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace rtd::bench {

/// Value below which `percent` of the samples lie; 0 without samples.
double percentile(std::vector<double> samples, double percent);

}  // namespace rtd::bench
