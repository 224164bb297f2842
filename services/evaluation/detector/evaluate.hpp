// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <iosfwd>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "services/detector/core/detector.hpp"
#include "services/evaluation/core/detection/average_precision.hpp"
#include "services/evaluation/core/detection/mask_recall.hpp"
#include "services/evaluation/detector/model_under_test.hpp"

namespace rtd::eval {

/// The input and its problems.
struct InputReport {
  std::size_t images = 0;             ///< evaluated
  std::size_t without_partner = 0;    ///< labels: taken as empty; masks: left out
  std::size_t not_decoded = 0;        ///< files that are not images, left out
  std::vector<std::string> problems;  ///< one line each, with file, line and value
};

/// A model against labels.
struct LabelledResult {
  ModelFacts model;
  AccuracyReport accuracy;
  /// Boxes of the usual confidence against those of the same model on the CPU, where that is compared too.
  std::optional<detector::AgreementCount> agreement = {};
};
struct LabelledResults {
  InputReport input;
  std::string format;
  double wanted_recall = 0;
  std::vector<LabelledResult> models;
};

/// A model against masks: by roll in degrees, then by confidence threshold.
using RecallByRoll = std::map<double, std::map<double, MaskRecall>>;
struct MaskResult {
  ModelFacts model;
  RecallByRoll as_seen;
  std::map<double, MaskOverlap> overlap;  ///< by roll: boxes as seen, lowest confidence; empty without --mask-model
};
struct MaskResults {
  InputReport input;
  std::vector<MaskResult> models;
};

/// Runs all models on all images. Throws service::ConfigError when the input cannot be used at all.
LabelledResults evaluate_labels(const EvalDetectorOptions& options, std::ostream& err);

/// Recall on masks, on images turned by each roll. Throws service::ConfigError when the input cannot be used at all.
MaskResults evaluate_masks(const EvalDetectorOptions& options, std::ostream& err);

}  // namespace rtd::eval
