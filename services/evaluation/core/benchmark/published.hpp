// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <span>
#include <string_view>
#include <vector>

#include "services/evaluation/core/benchmark/dataset.hpp"

namespace rtd::eval {

/// What a publication says of a method on a sequence. Unknown values are NaN.
struct PublishedFigure {
  const char* sequence;  ///< short name; kMeanName: the mean over the sequences of mean_sequences()
  double ate_m;          ///< RMSE
  double rpe_m = std::numeric_limits<double>::quiet_NaN();    ///< RMSE per second
  double rpe_deg = std::numeric_limits<double>::quiet_NaN();  ///< RMSE per second
};

/// How an estimate was aligned with the ground truth. Sim(3) also fits the scale, which an RGB-D camera knows: errors
/// get smaller, never larger.
enum class PublishedAlignment { kSe3, kSim3, kNotStated };
enum class PublishedHardware { kCpu, kGpu, kNotStated };

struct PublishedMethod {
  Dataset dataset;
  const char* method;
  const char* source;  ///< in words
  PublishedAlignment alignment;
  PublishedHardware hardware;
  std::span<const PublishedFigure> figures;
  int number = 0;  ///< among those of the dataset, from 1: how tables refer to its source
};

inline constexpr const char* kMeanName = "mean";

/// The methods that a dataset is compared with; one whose figures are not at hand has none.
std::vector<PublishedMethod> published_methods(Dataset dataset);

/// The figure of a method on a sequence; null when none is known.
const PublishedFigure* find_figure(const PublishedMethod& method, std::string_view sequence);

/// The sequences over which publications give the mean; none: there is no such mean.
std::span<const char* const> mean_sequences(Dataset dataset);

/// "SE(3)", "Sim(3)", "-".
const char* to_string(PublishedAlignment alignment);
/// "CPU", "GPU", "-".
const char* to_string(PublishedHardware hardware);

}  // namespace rtd::eval
