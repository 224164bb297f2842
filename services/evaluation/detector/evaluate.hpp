// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>

#include "services/evaluation/detector/evaluation_results.hpp"

namespace rtd::launcher {

/// Runs all models on all images. Throws EvalDetectorError when the input cannot be used at all.
LabelledResults evaluate_labels(const EvalDetectorOptions& options, std::ostream& err);

/// Recall on masks, on images turned by each roll. Throws EvalDetectorError when the input cannot be used at all.
MaskResults evaluate_masks(const EvalDetectorOptions& options, std::ostream& err);

}  // namespace rtd::launcher
