// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace rtd::launcher {

enum class Verdict { kOk, kWarn, kFail };

/// One line of the doctor; a problem names its cure.
struct Finding {
  Verdict verdict;
  std::string text;
};
using Findings = std::vector<Finding>;

}  // namespace rtd::launcher
